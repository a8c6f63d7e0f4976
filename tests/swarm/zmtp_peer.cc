#include "tests/swarm/zmtp_peer.h"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <sodium.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "schema/error.h"

namespace cairn::swarm {
namespace {

constexpr std::size_t kGreetingBytes = 64;
constexpr unsigned char kMore = 1, kLong = 2, kCommand = 4;
constexpr std::string_view kMetadata{"\x0bSocket-Type\0\0\0\6DEALER\x08Identity\0\0\0\0", 35};

const unsigned char* Bytes(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}
unsigned char* Bytes(std::string& text) { return reinterpret_cast<unsigned char*>(text.data()); }
std::string_view Text(const Key& key) { return {reinterpret_cast<const char*>(key.data()), key.size()}; }

std::string BigEndian(std::uint64_t value) {
  std::string bytes;
  for (int shift = 56; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
  return bytes;
}

std::string Box(std::string_view plain, std::string_view nonce, const Key& to, const Key& from) {
  std::string box(plain.size() + crypto_box_MACBYTES, '\0');
  CAIRN_DEMAND(
      crypto_box_easy(Bytes(box), Bytes(plain), plain.size(), Bytes(nonce), to.data(), from.data()) == 0,
      "no box");
  return box;
}

// A socket that begins to connect; -1: it could not. By the system calls themselves: the C library's are
// schema/wire's own here, and count.
int BeginTcp(const std::string& address, const std::string& from) {
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return -1;
  const int on = 1;
  ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  sockaddr_in here{}, there{};
  here.sin_family = there.sin_family = AF_INET;
  if (!from.empty()) {
    ::setsockopt(fd, IPPROTO_IP, IP_BIND_ADDRESS_NO_PORT, &on, sizeof on);
    ::inet_pton(AF_INET, from.c_str(), &here.sin_addr);
    ::bind(fd, reinterpret_cast<const sockaddr*>(&here), sizeof here);
  }
  const std::size_t colon = address.rfind(':');
  ::inet_pton(AF_INET, address.substr(0, colon).c_str(), &there.sin_addr);
  there.sin_port = htons(static_cast<std::uint16_t>(std::stoi(address.substr(colon + 1))));
  if (::syscall(SYS_connect, fd, &there, sizeof there) == 0 || errno == EINPROGRESS) return fd;
  ::close(fd);
  return -1;
}

int BeginIpc(const std::string& path) {
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return -1;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  if (::syscall(SYS_connect, fd, &address, sizeof address) == 0) return fd;
  ::close(fd);
  return -1;
}

}  // namespace

ZmtpPeer::ZmtpPeer(const std::string& endpoint, const std::string& from, const PeerKeys* keys) : keys_(keys) {
  constexpr std::size_t kScheme = 6;  // ipc:// and tcp://
  fd_ = endpoint.starts_with("ipc://") ? BeginIpc(endpoint.substr(kScheme))
                                       : BeginTcp(endpoint.substr(kScheme), from);
  Greet();
}

ZmtpPeer::~ZmtpPeer() {
  if (fd_ >= 0) ::close(fd_);
}

void ZmtpPeer::Greet() {
  std::string greeting("\xff\0\0\0\0\0\0\0\0\x7f\x03\x00", 12);
  greeting += keys_ != nullptr ? "CURVE" : "NULL";
  greeting.resize(kGreetingBytes, '\0');
  out_ = greeting;
}

bool ZmtpPeer::Turn(std::vector<std::vector<std::string>>* messages) {
  if (!Flush() || !Read()) return false;
  if (state_ == State::kGreeting && !TakeGreeting()) return false;
  unsigned char flags = 0;
  while (state_ != State::kGreeting) {
    std::optional<std::string> frame = NextFrame(&flags);
    if (!frame) break;
    if (!TakeFrame(flags, std::move(*frame), messages)) return false;
  }
  in_.erase(0, taken_);
  taken_ = 0;
  return Flush();
}

bool ZmtpPeer::Flush() {
  if (out_.empty()) return true;
  const ssize_t sent = ::syscall(SYS_sendto, fd_, out_.data(), out_.size(), MSG_NOSIGNAL, nullptr, 0);
  if (sent < 0) return errno == EAGAIN || errno == EINTR || errno == ENOTCONN;
  connecting_ = false;
  bytes_out_ += static_cast<std::uint64_t>(sent);
  out_.erase(0, static_cast<std::size_t>(sent));
  return true;
}

bool ZmtpPeer::Read() {
  std::array<char, 65'536> buffer;  // NOLINT: filled by what comes
  const ssize_t got = ::syscall(SYS_recvfrom, fd_, buffer.data(), buffer.size(), 0, nullptr, nullptr);
  if (got < 0) return errno == EAGAIN || errno == EINTR || errno == ENOTCONN;
  bytes_in_ += static_cast<std::uint64_t>(got);
  in_.append(buffer.data(), static_cast<std::size_t>(got));
  return got > 0;
}

bool ZmtpPeer::TakeGreeting() {
  if (in_.size() < kGreetingBytes) return true;
  taken_ = kGreetingBytes;
  if (keys_ != nullptr) {
    SayHello();
    state_ = State::kWelcome;
  } else {
    PutFrame(kCommand, "\x05READY" + std::string(kMetadata));
    state_ = State::kReadyCommand;
  }
  return true;
}

std::optional<std::string> ZmtpPeer::NextFrame(unsigned char* flags) {
  const std::string_view left = std::string_view(in_).substr(taken_);
  if (left.empty()) return std::nullopt;
  *flags = static_cast<unsigned char>(left[0]);
  const std::size_t header = (*flags & kLong) != 0 ? 9 : 2;
  if (left.size() < header) return std::nullopt;
  std::uint64_t size = 0;
  for (const char c : left.substr(1, header - 1)) size = size << 8 | static_cast<unsigned char>(c);
  if (left.size() - header < size) return std::nullopt;
  taken_ += header + size;
  return std::string(left.substr(header, size));
}

bool ZmtpPeer::TakeFrame(unsigned char flags, std::string frame,
                         std::vector<std::vector<std::string>>* messages) {
  if (state_ != State::kReady) return TakeHandshake(frame);
  if (keys_ != nullptr && !Open(&frame, &flags)) return false;
  if ((flags & kCommand) != 0) return true;  // an answer to a ping
  frames_.push_back(std::move(frame));
  if ((flags & kMore) == 0) messages->push_back(std::exchange(frames_, {}));
  return true;
}

bool ZmtpPeer::TakeHandshake(std::string_view frame) {
  if (state_ == State::kWelcome) return frame.starts_with("\x07WELCOME") && TakeWelcome(frame.substr(8));
  state_ = State::kReady;
  return frame.starts_with("\x05READY");
}

// What is short is a nonce of eight bytes, in the order in which they are used.
std::string ZmtpPeer::NextNonce(std::string_view prefix, std::string* short_nonce) {
  *short_nonce = BigEndian(++nonce_);
  return std::string(prefix) + *short_nonce;
}

void ZmtpPeer::SayHello() {
  crypto_box_keypair(ephemeral_public_.data(), ephemeral_secret_.data());
  std::string short_nonce;
  const std::string nonce = NextNonce("CurveZMQHELLO---", &short_nonce);
  std::string hello("\x05HELLO\x01\x00", 8);
  hello.resize(80, '\0');
  hello += std::string(Text(ephemeral_public_)) + short_nonce;
  hello += Box(std::string(64, '\0'), nonce, keys_->server_public, ephemeral_secret_);
  PutFrame(kCommand, hello);
}

bool ZmtpPeer::TakeWelcome(std::string_view body) {
  constexpr std::size_t kNonce = 16, kBox = 144, kCookie = 96;
  if (body.size() != kNonce + kBox) return false;
  std::string plain(kBox - crypto_box_MACBYTES, '\0');
  const std::string nonce = "WELCOME-" + std::string(body.substr(0, kNonce));
  if (crypto_box_open_easy(Bytes(plain), Bytes(body.substr(kNonce)), kBox, Bytes(nonce),
                           keys_->server_public.data(), ephemeral_secret_.data()) != 0)
    return false;
  Key server{};  // for this connection alone
  std::copy_n(plain.begin(), server.size(), server.begin());
  std::string vouch_nonce(kNonce, '\0');
  randombytes_buf(vouch_nonce.data(), kNonce);
  const std::string vouch =
      Box(std::string(Text(ephemeral_public_)) + std::string(Text(keys_->server_public)),
          "VOUCH---" + vouch_nonce, server, keys_->own_secret);
  std::string short_nonce;
  const std::string initiate_nonce = NextNonce("CurveZMQINITIATE", &short_nonce);
  const std::string said =
      std::string(Text(keys_->own_public)) + vouch_nonce + vouch + std::string(kMetadata);
  PutFrame(kCommand, "\x08INITIATE" + plain.substr(server.size(), kCookie) + short_nonce +
                         Box(said, initiate_nonce, server, ephemeral_secret_));
  state_ = State::kReadyCommand;
  return crypto_box_beforenm(shared_.data(), server.data(), ephemeral_secret_.data()) == 0;
}

bool ZmtpPeer::Open(std::string* frame, unsigned char* flags) {
  constexpr std::size_t kBefore = 16;  // the command's name and a short nonce
  if (frame->size() <= kBefore + crypto_box_MACBYTES || !frame->starts_with("\x07MESSAGE")) return false;
  const std::string nonce = "CurveZMQMESSAGES" + frame->substr(8, 8);
  std::string plain(frame->size() - kBefore - crypto_box_MACBYTES, '\0');
  if (crypto_box_open_easy_afternm(Bytes(plain), Bytes(std::string_view(*frame).substr(kBefore)),
                                   frame->size() - kBefore, Bytes(nonce), shared_.data()) != 0)
    return false;
  *flags = static_cast<unsigned char>((plain[0] & 1) != 0 ? kMore : 0) |
           static_cast<unsigned char>((plain[0] & 2) != 0 ? kCommand : 0);
  *frame = plain.substr(1);
  return true;
}

void ZmtpPeer::PutOpen(unsigned char flags, std::string_view body) {
  const bool large = body.size() > 255;
  out_ += static_cast<char>(flags | (large ? kLong : 0));
  out_ += large ? BigEndian(body.size()) : std::string(1, static_cast<char>(body.size()));
  out_ += body;
}

void ZmtpPeer::PutFrame(unsigned char flags, std::string_view body) {
  if (keys_ == nullptr || state_ != State::kReady) return PutOpen(flags, body);
  std::string short_nonce;
  const std::string nonce = NextNonce("CurveZMQMESSAGEC", &short_nonce);
  const int inner = (flags & kMore) != 0 ? 1 : (flags & kCommand) != 0 ? 2 : 0;
  const std::string plain = std::string(1, static_cast<char>(inner)) + std::string(body);
  std::string box(plain.size() + crypto_box_MACBYTES, '\0');
  crypto_box_easy_afternm(Bytes(box), Bytes(plain), plain.size(), Bytes(nonce), shared_.data());
  PutOpen(0, "\x07MESSAGE" + short_nonce + box);
}

void ZmtpPeer::Send(const std::vector<std::string_view>& frames) {
  for (std::size_t i = 0; i < frames.size(); ++i)
    PutFrame(i + 1 < frames.size() ? kMore : static_cast<unsigned char>(0), frames[i]);
}

// "Answer within 15 s", as a worker's socket says every 5 (schema/wire/dealer.cc).
void ZmtpPeer::Ping() { PutFrame(kCommand, std::string("\x04PING\0\x96", 7)); }

}  // namespace cairn::swarm
