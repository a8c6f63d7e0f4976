#include "schema/store/guarded.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <mutex>
#include <new>
#include <optional>

#include "schema/array_form.h"
#include "schema/store/atomic_file.h"
#include "schema/store/hdf5_handle.h"

namespace cairn::store {
namespace {

struct CloseStream {
  void operator()(FILE* file) const { std::fclose(file); }
};
using Stream = std::unique_ptr<FILE, CloseStream>;

bool is_child = false;

// ---- the child's side: numbers as eight bytes, texts and arrays after their length ----
void Put(FILE* out, std::uint64_t value) { std::fwrite(&value, sizeof value, 1, out); }
void Put(FILE* out, const std::string& text) {
  Put(out, text.size());
  std::fwrite(text.data(), 1, text.size(), out);
}

void PutContents(FILE* out, const FileContents& contents) {
  Put(out, contents.kind);
  Put(out, static_cast<std::uint64_t>(contents.format));
  Put(out, contents.changed ? 1 : 0);
  Put(out, contents.hash);
  Put(out, contents.remarks.size());
  for (const std::string& remark : contents.remarks) Put(out, remark);
  Put(out, contents.datasets.size());
  for (const DatasetInfo& info : contents.datasets) {
    Put(out, info.name);
    Put(out, static_cast<std::uint64_t>(info.type));
    Put(out, info.item_bytes);
    Put(out, info.shape.size());
    for (const std::int64_t n : info.shape) Put(out, static_cast<std::uint64_t>(n));
    Put(out, info.unit);
    Put(out, info.stored_bytes);
    const auto found = contents.blob.fields().find(info.name);
    Put(out, found != contents.blob.fields().end() ? 1 : 0);
    if (found == contents.blob.fields().end()) continue;
    Put(out, found->second.bytes().size());
    std::fwrite(found->second.bytes().data(), 1, found->second.bytes().size(), out);
  }
}

// Of what is the process's alone and no file's. False where there is no such limit.
bool LimitMemory([[maybe_unused]] std::uint64_t more_bytes) {
#ifdef CAIRN_SANITIZED
  return false;  // the sanitizers take what they take
#else
  if (more_bytes == 0) return false;
  std::uint64_t pages = 0;
  std::ifstream sizes("/proc/self/statm");
  constexpr int kDataColumn = 6;
  for (int i = 0; i < kDataColumn; ++i) sizes >> pages;
  rlimit limit{};
  if (!sizes || ::getrlimit(RLIMIT_DATA, &limit) != 0) return false;
  limit.rlim_cur =
      std::min<rlim_t>(limit.rlim_cur, pages * static_cast<std::uint64_t>(::getpagesize()) + more_bytes);
  return ::setrlimit(RLIMIT_DATA, &limit) == 0;
#endif
}

Result<FileContents> ReadInMemory(const std::filesystem::path& path, const ChildReader& reader,
                                  const std::function<Result<FileContents>()>& read) {
  const bool is_limited = LimitMemory(reader.memory_bytes);
  try {
    return read();
  } catch (const std::bad_alloc&) {
    if (is_limited)
      return Status(Code::kRefused, path.string() + ": not read: it takes more than the " +
                                        std::to_string(reader.memory_bytes >> 20) +
                                        " MB of memory that reading it may take: it is damaged, made so, or "
                                        "unpacks to very much" +
                                        reader.more_memory);
    return Status(Code::kIo, path.string() + ": there is not the memory to read it");
  }
}

// Ends with its parent, whenever that dies: the signal tells it from prctl() on, getppid() whether it was too
// late for that, and a parent's pipe that nobody reads ends who writes to it. So of the parent's descriptors,
// among them the pipe's other end and locks, the child keeps none but its own end.
int KeepOnly(int pipe) {
  constexpr int kFirst = STDERR_FILENO + 1;
  if (pipe != kFirst && ::dup2(pipe, kFirst) < 0) return -1;
  return ::close_range(kFirst + 1, ~0U, 0) == 0 ? kFirst : -1;
}

std::uint64_t FileBytes(const std::filesystem::path& path) {
  std::error_code unknown;
  const std::uintmax_t size = std::filesystem::file_size(path, unknown);
  return unknown ? 0 : size;
}

// Of the processor's time.
rlim_t MostSeconds(std::uint64_t file_bytes) { return 10 + file_bytes / 4'000'000; }

[[noreturn]] void BeChild(int pipe, pid_t parent, std::uint64_t file_bytes,
                          const std::function<bool(FILE*)>& write) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);
  ::signal(SIGPIPE, SIG_DFL);
  pipe = KeepOnly(pipe);
  is_child = true;
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  const rlim_t seconds = MostSeconds(file_bytes);
  const rlimit cpu{seconds, seconds + 5};
  ::setrlimit(RLIMIT_CPU, &cpu);
  // What the C library says of a heap that HDF5 has damaged is for nobody.
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) {
    ::dup2(nowhere, STDERR_FILENO);
    ::close(nowhere);
  }
  FILE* out = ::fdopen(pipe, "wb");
  if (out == nullptr) ::_exit(1);
  const bool whole = write(out);
  ::_exit(std::fclose(out) == 0 && whole ? 0 : 1);
}

void PutResult(FILE* out, const Result<FileContents>& contents) {
  Put(out, static_cast<std::uint64_t>(contents.ok() ? Code::kOk : contents.status().code()));
  if (contents.ok())
    PutContents(out, contents.value());
  else
    Put(out, contents.status().message());
}

// ---- the parent's side: nothing where the child broke off ----
class Reader {
 public:
  explicit Reader(FILE* in) : in_(in) {}
  bool Get(std::uint64_t* value) { return std::fread(value, sizeof *value, 1, in_) == 1; }
  bool Get(std::string* text) {
    std::uint64_t size = 0;
    if (!Get(&size) || size > kMostText) return false;
    text->resize(size);
    return std::fread(text->data(), 1, size, in_) == size;
  }
  bool Get(std::byte* bytes, std::size_t size) { return std::fread(bytes, 1, size, in_) == size; }

 private:
  static constexpr std::uint64_t kMostText = 1 << 20;
  FILE* in_;
};

bool GetInfo(Reader& in, DatasetInfo* info) {
  std::uint64_t type = 0, item = 0, rank = 0, n = 0;
  if (!in.Get(&info->name) || !in.Get(&type) || !in.Get(&item) || !in.Get(&rank) || rank > 64) return false;
  info->type = static_cast<DType>(type);
  info->item_bytes = item;
  for (; rank > 0; --rank) {
    if (!in.Get(&n)) return false;
    info->shape.push_back(static_cast<std::int64_t>(n));
  }
  return in.Get(&info->unit) && in.Get(&info->stored_bytes);
}

bool GetArray(Reader& in, const DatasetInfo& info, Blob* blob) {
  std::uint64_t size = 0;
  if (!in.Get(&size)) return false;
  // The array's own: a log may be most of the memory.
  const std::shared_ptr<std::byte> bytes = AlignedBytes(size);
  if (!in.Get(bytes.get(), size)) return false;
  Result<Array> array = Array::Over(info.type, info.item_bytes, info.shape, {bytes.get(), size}, bytes);
  if (!array.ok()) return false;
  blob->Put(info.name, std::move(array).value());
  return true;
}

std::optional<Result<FileContents>> GetContents(Reader in) {
  std::uint64_t code = 0, format = 0, count = 0, has = 0;
  if (!in.Get(&code)) return std::nullopt;
  FileContents contents;
  if (static_cast<Code>(code) != Code::kOk) {
    std::string message;
    if (!in.Get(&message)) return std::nullopt;
    return Result<FileContents>(Status(static_cast<Code>(code), message));
  }
  if (!in.Get(&contents.kind) || !in.Get(&format) || !in.Get(&has) || !in.Get(&contents.hash) ||
      !in.Get(&count))
    return std::nullopt;
  for (; count > 0; --count)
    if (!in.Get(&contents.remarks.emplace_back())) return std::nullopt;
  if (!in.Get(&count)) return std::nullopt;
  contents.changed = has != 0;
  contents.format = static_cast<std::int64_t>(format);
  for (; count > 0; --count) {
    DatasetInfo& info = contents.datasets.emplace_back();
    if (!GetInfo(in, &info) || !in.Get(&has)) return std::nullopt;
    if (has != 0 && !GetArray(in, info, &contents.blob)) return std::nullopt;
  }
  return Result<FileContents>(std::move(contents));
}

bool IsCrash(int signal) {
  constexpr std::array kCrashes{SIGSEGV, SIGBUS, SIGABRT, SIGFPE,
                                SIGILL,  SIGSYS, SIGTRAP, SIGPIPE};  // of these it wrote what cannot be
  return std::ranges::find(kCrashes, signal) != kCrashes.end();
}

std::uint64_t BytesOf(const std::filesystem::path& path, const ChildReader& reader) {
  return reader.bytes > 0 ? reader.bytes : FileBytes(path);
}

Status BrokeOff(const std::filesystem::path& path, int wait_status, const ChildReader& reader = {}) {
  const int signal = WIFSIGNALED(wait_status) ? WTERMSIG(wait_status) : 0;
  if (signal == SIGXCPU)
    return {Code::kRefused,
            path.string() + ": not read: it takes more than the " +
                std::to_string(MostSeconds(BytesOf(path, reader))) +
                " s of the processor's time that a file of its size may take. It is damaged, or made so" +
                (reader.name == ChildReader().name
                     ? "; where this machine is only slow, `h5repack -f NONE` writes a copy that takes less"
                     : "")};
  if (signal == 0 || IsCrash(signal))
    return {Code::kCorrupt, path.string() + ": damaged; " + reader.name + " crashed while reading it"};
  std::string text =
      path.string() + ": not read: the process that reads it was ended by signal " + std::to_string(signal);
  if (signal == SIGKILL)
    text += " (SIGKILL), probably by the system, for want of memory; free some, or use a machine with more";
  return {Code::kIo, text};
}

#ifdef CAIRN_SANITIZED
// The allocators of GCC's sanitizers keep their locks across a fork: with other threads about, the child may
// hang.
bool MayFork() {
  const std::filesystem::directory_iterator threads("/proc/self/task");
  return std::distance(begin(threads), end(threads)) == 1;
}
#else
constexpr bool MayFork() { return true; }
#endif

// A child that writes into a pipe, and the other end of that.
struct Started {
  Stream in;
  pid_t child;
};

Result<Started> Start(const std::filesystem::path& path, const std::function<bool(FILE*)>& write,
                      const ChildReader& reader = {}) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return SystemFailure(path, "cannot make a pipe", errno);
  const std::uint64_t size = BytesOf(path, reader);
  const pid_t parent = ::getpid();
  pid_t child = 0;
  {
    const std::lock_guard lock(LibraryMutex());  // no other thread is inside HDF5 when the child begins
    child = ::fork();
    if (child == 0) {
      LibraryMutex().unlock();  // the child's copy, which this thread holds: it may write files too
      BeChild(ends[1], parent, size, write);
    }
  }
  ::close(ends[1]);
  Stream in(::fdopen(ends[0], "rb"));
  if (child < 0) return SystemFailure(path, "cannot start a process to read it", errno);
  return Started{std::move(in), child};
}

int WaitFor(pid_t child) {
  int wait_status = 0;
  while (::waitpid(child, &wait_status, 0) < 0 && errno == EINTR) {
  }
  return wait_status;
}

}  // namespace

MemoryLimit::MemoryLimit(std::uint64_t more_bytes) : more_bytes_(more_bytes) {
  rlimit limit{};
  if (!is_child || ::getrlimit(RLIMIT_DATA, &limit) != 0) return;
  before_ = limit.rlim_cur;
  is_set_ = LimitMemory(more_bytes);
}

bool MemoryLimit::Lift() {
  rlimit limit{};
  if (!std::exchange(is_set_, false) || ::getrlimit(RLIMIT_DATA, &limit) != 0) return false;
  limit.rlim_cur = before_;
  if (::setrlimit(RLIMIT_DATA, &limit) != 0) return false;
  // As HDF5 would get it; a compiler may leave out a `new` whose memory nobody uses, but no system call.
  void* const got = ::mmap(nullptr, more_bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  return got != MAP_FAILED && ::munmap(got, more_bytes_) == 0;
}

Result<FileContents> InChild(const std::filesystem::path& path,
                             const std::function<Result<FileContents>()>& read, const ChildReader& reader) {
  if (!MayFork()) return read();
  Result<Started> started = Start(
      path,
      [&](FILE* out) {
        PutResult(out, ReadInMemory(path, reader, read));
        return true;
      },
      reader);
  if (!started.ok()) return started.status();
  std::optional<Result<FileContents>> contents = GetContents(Reader(started.value().in.get()));
  started.value().in.reset();  // a child that still writes ends too
  const int wait_status = WaitFor(started.value().child);
  if (!contents || wait_status != 0) return BrokeOff(path, wait_status, reader);
  return std::move(*contents);
}

Result<ChildStream> ChildStream::Start(const std::filesystem::path& path,
                                       const std::function<bool(FILE*)>& write) {
  if (!MayFork()) {
    FILE* file = std::tmpfile();
    const bool whole = file != nullptr && write(file);
    if (file != nullptr) std::rewind(file);
    return whole ? ChildStream(path, file, -1) : Result<ChildStream>(BrokeOff(path, 0));
  }
  Result<Started> started = store::Start(path, write);
  if (!started.ok()) return started.status();
  return ChildStream(path, started.value().in.release(), started.value().child);
}

ChildStream::ChildStream(ChildStream&& other) noexcept
    : path_(std::move(other.path_)),
      in_(std::exchange(other.in_, nullptr)),
      child_(std::exchange(other.child_, -1)) {}

ChildStream::~ChildStream() {
  if (in_ != nullptr) std::fclose(in_);
  if (child_ > 0) WaitFor(child_);
}

Status ChildStream::Read(std::span<std::byte> bytes) {
  if (in_ != nullptr && std::fread(bytes.data(), 1, bytes.size(), in_) == bytes.size()) return Status::Ok();
  if (in_ != nullptr) std::fclose(std::exchange(in_, nullptr));
  return BrokeOff(path_, child_ > 0 ? WaitFor(std::exchange(child_, -1)) : 0);
}

}  // namespace cairn::store
