#include "schema/wire/system_calls.h"

#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

namespace cairn::wire {
namespace {

std::atomic<std::size_t> g_spare{0};
std::atomic<int> g_left_alone{-1};
constexpr unsigned kPause_us = 10'000;

// The system gives the lowest number that is free: one this high says that the others are taken.
bool IsSpare(int fd) {
  rlimit files{};
  if (g_spare == 0 || ::getrlimit(RLIMIT_NOFILE, &files) != 0) return false;
  const rlim_t spare = std::min<rlim_t>(g_spare, files.rlim_cur / 4);
  return static_cast<rlim_t>(fd) >= files.rlim_cur - spare;
}

// One direction of a connection, byte by byte (rfc.zeromq.org/spec/23: a greeting of 64 bytes, then frames of
// flags, length and body), until the command by which this side ends its handshake has gone by.
class HandshakeBytes {
 public:
  void Take(unsigned char byte) {
    ++count_;
    if (count_ <= kGreetingBytes) return;
    if (header_.size() < HeaderBytes()) {
      header_.push_back(static_cast<char>(byte));
      if (header_.size() == HeaderBytes()) left_ = Length();
    } else {
      if (name_.size() < kInitiate.size()) name_.push_back(static_cast<char>(byte));
      --left_;
    }
    if (header_.size() == HeaderBytes() && left_ == 0) EndFrame();
  }
  bool done() const { return done_; }
  bool TooMany() const { return count_ > kMostHandshakeBytes || left_ > kMostHandshakeBytes; }

 private:
  static constexpr std::size_t kGreetingBytes = 64;
  static constexpr unsigned char kLong = 2, kCommand = 4;
  // CURVE's client ends with the one, its server, and both sides of a connection without keys, with the
  // other.
  static constexpr std::string_view kInitiate = "\x08INITIATE", kReady = "\x05READY";

  bool Has(unsigned char flag) const {
    return !header_.empty() && (static_cast<unsigned char>(header_[0]) & flag) != 0;
  }
  std::size_t HeaderBytes() const { return Has(kLong) ? 9 : 2; }
  std::uint64_t Length() const {
    std::uint64_t length = 0;
    for (const char c : std::string_view(header_).substr(1))
      length = length << 8 | static_cast<unsigned char>(c);
    return length;
  }
  void EndFrame() {
    done_ = done_ || (Has(kCommand) && (name_.starts_with(kInitiate) || name_.starts_with(kReady)));
    header_.clear();
    name_.clear();
  }

  std::size_t count_ = 0;
  std::string header_, name_;
  std::uint64_t left_ = 0;  // of the frame's body
  bool done_ = false;
};

// A connection whose handshake is under way.
struct PendingHandshake {
  ino_t socket = 0;  // its number, for the descriptor may be another's by now
  HandshakeBytes came, went;
};

std::mutex g_mutex;
// By descriptor. Never destroyed: ZeroMQ's thread may outlive this file's objects.
auto& g_pending_handshakes = *new std::unordered_map<int, PendingHandshake>;
std::atomic<std::size_t> g_pending_count{0};  // so that others need not wait for the mutex

auto& g_read_to_the_end = *new std::unordered_set<int>;

// A connection that this process made.
struct Made {
  std::uint64_t most_unread = 0, unread = 0, came = 0;
};
auto& g_made = *new std::unordered_map<int, Made>;  // by descriptor
std::atomic<std::uint64_t> g_most_unread{0};        // 0: any number
std::atomic<std::size_t> g_made_count{0};

ino_t SocketNumber(int fd) {
  struct stat info{};
  return ::fstat(fd, &info) == 0 ? info.st_ino : 0;
}

void Watch(int fd) {
  const std::lock_guard lock(g_mutex);
  g_read_to_the_end.erase(fd);  // another's, which had the number before
  g_made.erase(fd);
  g_made_count = g_made.size();
  g_pending_handshakes[fd] = {.socket = SocketNumber(fd), .came = {}, .went = {}};
  g_pending_count = g_pending_handshakes.size();
}

void LimitMade(int fd) {
  const std::lock_guard lock(g_mutex);
  g_made.erase(fd);
  if (g_most_unread > 0) g_made[fd] = {.most_unread = g_most_unread};
  g_made_count = g_made.size();
}

bool IsFull(int fd) {
  if (g_made_count == 0) return false;
  const std::lock_guard lock(g_mutex);
  const auto it = g_made.find(fd);
  return it != g_made.end() && it->second.unread >= it->second.most_unread;
}

void NoteCame(int fd, std::uint64_t bytes) {
  if (g_made_count == 0) return;
  const std::lock_guard lock(g_mutex);
  const auto it = g_made.find(fd);
  if (it == g_made.end()) return;
  it->second.unread += bytes;
  it->second.came += bytes;
}

bool IsStream(int fd) {
  int type = 0;
  socklen_t size = sizeof type;
  return ::getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &size) == 0 && type == SOCK_STREAM;
}

bool IsWatched(int fd) {
  if (g_pending_count == 0) return false;
  const std::lock_guard lock(g_mutex);
  const auto it = g_pending_handshakes.find(fd);
  if (it == g_pending_handshakes.end()) return false;
  if (it->second.socket == SocketNumber(fd)) return true;
  g_pending_handshakes.erase(it);
  g_pending_count = g_pending_handshakes.size();
  return false;
}

void NoteEnd(int fd) {
  const std::lock_guard lock(g_mutex);
  g_read_to_the_end.insert(fd);
}

// False where more came than a handshake has.
bool Note(int fd, HandshakeBytes PendingHandshake::* direction, std::span<const unsigned char> bytes) {
  const std::lock_guard lock(g_mutex);
  const auto it = g_pending_handshakes.find(fd);
  if (it == g_pending_handshakes.end()) return true;
  PendingHandshake& pending = it->second;
  HandshakeBytes& side = pending.*direction;
  for (const unsigned char byte : bytes) {
    side.Take(byte);
    if (pending.came.TooMany()) return false;
    if (!pending.came.done() || !pending.went.done()) continue;
    g_pending_handshakes.erase(it);
    g_pending_count = g_pending_handshakes.size();
    return true;
  }
  return true;
}

}  // namespace

void SpareDescriptors(std::size_t spare) { g_spare = spare; }

void LeaveAlone(int listener) { g_left_alone = listener; }

void LimitUnread(std::uint64_t bytes) { g_most_unread = bytes; }

void NoteTaken(int fd, std::uint64_t bytes) {
  const std::lock_guard lock(g_mutex);
  if (const auto it = g_made.find(fd); it != g_made.end())
    it->second.unread -= std::min(it->second.unread, bytes);
}

std::uint64_t BytesCame(int fd) {
  const std::lock_guard lock(g_mutex);
  const auto it = g_made.find(fd);
  return it == g_made.end() ? 0 : it->second.came;
}

bool TakeEndOf(int fd) {
  const std::lock_guard lock(g_mutex);
  return g_read_to_the_end.erase(fd) > 0;
}

}  // namespace cairn::wire

// In the place of the C library's, for ZeroMQ calls them by these names. No other code of a process of ours
// connects a stream, or accepts one by accept4 at a socket that is not left alone. (ZeroMQ reports ENFILE as
// a connection that could not be accepted, and goes on, whatever the transport.)
extern "C" int accept4(int listener, sockaddr* address, socklen_t* length, int flags) {
  const int fd = static_cast<int>(::syscall(SYS_accept4, listener, address, length, flags));
  if (fd >= 0 && !cairn::wire::IsSpare(fd)) {
    if (listener != cairn::wire::g_left_alone) cairn::wire::Watch(fd);
    return fd;
  }
  if (fd >= 0) {
    ::close(fd);
    errno = ENFILE;
  } else if (errno == EMFILE) {
    ::usleep(cairn::wire::kPause_us);  // it knocks on
    errno = ENFILE;
  }
  return -1;
}

extern "C" int connect(int fd, const sockaddr* address, socklen_t length) {
  if (cairn::wire::IsStream(fd)) {
    cairn::wire::Watch(fd);
    cairn::wire::LimitMade(fd);
  }
  return static_cast<int>(::syscall(SYS_connect, fd, address, length));
}

extern "C" ssize_t recv(int fd, void* buffer, std::size_t size, int flags) {
  const bool watched = cairn::wire::IsWatched(fd) && (flags & MSG_PEEK) == 0;
  if (watched) size = std::min(size, cairn::wire::kMostHandshakeBytes);
  if (cairn::wire::IsFull(fd)) {
    ::usleep(
        cairn::wire::kPause_us);  // ZeroMQ's thread, which looks again at once, sends what there is to send
    errno = EAGAIN;
    return -1;
  }
  const ssize_t got = ::syscall(SYS_recvfrom, fd, buffer, size, flags, nullptr, nullptr);
  if ((got == 0 && size > 0) || (got < 0 && errno != EAGAIN && errno != EINTR)) {
    const int error = errno;
    cairn::wire::NoteEnd(fd);
    errno = error;
  }
  if (got > 0 && (flags & MSG_PEEK) == 0) cairn::wire::NoteCame(fd, static_cast<std::uint64_t>(got));
  if (!watched || got <= 0) return got;
  const std::span bytes(static_cast<const unsigned char*>(buffer), static_cast<std::size_t>(got));
  if (cairn::wire::Note(fd, &cairn::wire::PendingHandshake::came, bytes)) return got;
  errno = EMSGSIZE;
  return -1;
}

extern "C" ssize_t send(int fd, const void* buffer, std::size_t size, int flags) {
  const ssize_t sent = ::syscall(SYS_sendto, fd, buffer, size, flags, nullptr, 0);
  if (sent <= 0 || !cairn::wire::IsWatched(fd)) return sent;
  const std::span bytes(static_cast<const unsigned char*>(buffer), static_cast<std::size_t>(sent));
  static_cast<void>(cairn::wire::Note(fd, &cairn::wire::PendingHandshake::went, bytes));
  return sent;
}
