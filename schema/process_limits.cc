#include "schema/process_limits.h"

#include <fcntl.h>
#include <google/protobuf/stubs/logging.h>
#include <pthread.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace cairn {
namespace {

// But for the three that every process has.
std::uint64_t OpenFiles() {
  std::error_code error;
  const std::filesystem::directory_iterator listed("/proc/self/fd", error);
  constexpr std::uint64_t kOwn = 4;  // and the listing's own
  const auto open = static_cast<std::uint64_t>(std::distance(begin(listed), end(listed)));
  return open > kOwn ? open - kOwn : 0;
}

std::string Text(std::uint64_t bytes) {
  constexpr std::uint64_t kMiB = 1 << 20;
  return bytes < kMiB ? std::to_string(bytes >> 10) + " KiB" : std::to_string(bytes >> 20) + " MiB";
}

Status CheckFiles(std::uint64_t needed) {
  rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) != 0) return Status::Ok();
  needed += OpenFiles();
  if (files.rlim_cur >= needed) return Status::Ok();
  const rlimit raised{std::min<rlim_t>(needed, files.rlim_max), files.rlim_max};
  if (raised.rlim_cur == needed && ::setrlimit(RLIMIT_NOFILE, &raised) == 0) return Status::Ok();
  return {Code::kRefused, "the system lets this process open " + std::to_string(files.rlim_cur) +
                              " files at a time, and it needs " + std::to_string(needed) +
                              ": raise the limit (ulimit -n 1024)"};
}

Status CheckSize(decltype(RLIMIT_FSIZE) resource, std::uint64_t needed, const std::string& what,
                 const std::string& remedy) {
  rlimit limit{};
  if (::getrlimit(resource, &limit) != 0 || limit.rlim_cur >= needed) return Status::Ok();
  return {Code::kRefused, what + " " + Text(limit.rlim_cur) + " here, and it needs " + Text(needed) +
                              " at the least: raise the limit (" + remedy + ")"};
}

// As many threads as could be begun and stand at a time, of `wanted`: the system counts those of all
// processes of a user, and says nothing of their number.
std::uint64_t ThreadsToHave(std::uint64_t wanted) {
  std::vector<pthread_t> threads;
  pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
  pthread_attr_t attributes;
  ::pthread_attr_init(&attributes);
  ::pthread_attr_setstacksize(&attributes, std::size_t{256} << 10);
  ::pthread_mutex_lock(&gate);
  while (threads.size() < wanted) {
    pthread_t thread{};
    const auto wait = [](void* at) -> void* {
      auto* mutex = static_cast<pthread_mutex_t*>(at);
      ::pthread_mutex_lock(mutex);
      ::pthread_mutex_unlock(mutex);
      return nullptr;
    };
    if (::pthread_create(&thread, &attributes, wait, &gate) != 0) break;
    threads.push_back(thread);
  }
  ::pthread_mutex_unlock(&gate);
  for (const pthread_t thread : threads) ::pthread_join(thread, nullptr);
  ::pthread_attr_destroy(&attributes);
  return threads.size();
}

// ZeroMQ ends the process over a thread that it cannot have.
Status CheckThreads(std::uint64_t needed) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NPROC, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return Status::Ok();
  const std::uint64_t has = ThreadsToHave(needed);
  if (has >= needed) return Status::Ok();
  return {Code::kRefused, "the system lets this user have " + std::to_string(limit.rlim_cur) +
                              " processes and threads at a time, of which " + std::to_string(has) +
                              " are left for this one, and it needs " + std::to_string(needed) +
                              ": raise the limit (ulimit -u 4096), or end others"};
}

// Where one is closed, a file that is opened later would get its number, and all that is meant for it. What
// stands there instead fails like a closed one: it cannot be read, or not written.
void FillStandardStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

}  // namespace

Status PrepareProcess(const ProcessNeeds& needs) {
  FillStandardStreams();
  ::signal(SIGXFSZ, SIG_IGN);
  google::protobuf::SetLogHandler(nullptr);
  if (Status status = CheckFiles(needs.files); !status.ok()) return status;
  if (Status status = CheckSize(RLIMIT_FSIZE, needs.file_bytes,
                                "the system lets a file of this process grow to", "ulimit -f unlimited");
      !status.ok())
    return status;
  if (Status status =
          CheckSize(RLIMIT_STACK, needs.stack_bytes,
                    "the system lets the stack of this process's threads grow to", "ulimit -s 8192");
      !status.ok())
    return status;
  if (Status status = CheckSize(RLIMIT_AS, needs.memory_bytes, "the system gives this process memory up to",
                                "ulimit -v unlimited");
      !status.ok())
    return status;
  return CheckThreads(needs.threads);
}

std::uint64_t MemoryToHave(const std::filesystem::path& group_of_process,
                           const std::filesystem::path& groups) {
  auto least = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
               static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  rlimit addresses{};
  if (::getrlimit(RLIMIT_AS, &addresses) == 0) least = std::min<std::uint64_t>(least, addresses.rlim_cur);
  std::ifstream lines(group_of_process);
  for (std::string line; std::getline(lines, line);) {  // 0::/GROUP, or of version 1 4:memory:/GROUP
    const bool is_second = line.starts_with("0::/"), is_first = line.find(":memory:/") != std::string::npos;
    if (!is_first && !is_second) continue;
    for (std::filesystem::path group = line.substr(line.find(":/") + 1);; group = group.parent_path()) {
      std::ifstream limit(is_second ? groups / group.relative_path() / "memory.max"
                                    : groups / "memory" / group.relative_path() / "memory.limit_in_bytes");
      std::uint64_t bytes = 0;
      if (limit >> bytes) least = std::min(least, bytes);  // or "max"
      if (!group.has_relative_path()) break;
    }
  }
  return least;
}

}  // namespace cairn
