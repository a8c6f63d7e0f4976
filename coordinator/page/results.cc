#include "coordinator/page/results.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "schema/error.h"
#include "schema/store/atomic_file.h"
#include "schema/store/regular_file.h"
#include "schema/text.h"

namespace cairn::page {
namespace {

namespace fs = std::filesystem;

std::string KeyOf(const std::string& job, std::uint32_t stages_done) {
  return job + "/" + std::to_string(stages_done);
}

// A descriptor that holds the lock; -1: another process does.
int LockFolder(const fs::path& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (fd >= 0 && ::flock(fd, LOCK_EX | LOCK_NB) == 0) return fd;
  if (fd >= 0) ::close(fd);
  return -1;
}

// Those of processes that are no more.
void RemoveOld(const fs::path& base) {
  std::error_code error;
  for (fs::directory_iterator it(base, error), end; !error && it != end; it.increment(error)) {
    const int lock = LockFolder(it->path());
    if (lock < 0) continue;
    std::error_code ignored;
    fs::remove_all(it->path(), ignored);
    ::close(lock);
  }
}

// The last line of what a program said, without its name.
std::string LastLine(const fs::path& said) {
  constexpr std::size_t kMostBytes = 1 << 16;
  std::string text = ReadSmallFile(said, kMostBytes).ok() ? ReadSmallFile(said, kMostBytes).value() : "";
  while (!text.empty() && text.back() == '\n') text.pop_back();
  text = text.substr(text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1);
  const std::string name = "cairn: ";
  return Printable(text.starts_with(name) ? text.substr(name.size()) : text, 400);
}

FetchedResults LookInto(const fs::path& folder) {
  FetchedResults fetched{.folder = folder};
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == ".h5") fetched.files.stages.push_back(it->path().stem().string());
  std::ranges::sort(fetched.files.stages);
  fetched.files.has_report = fs::exists(folder / "report.html", error);
  for (const char* picture : {"map.png", "picture.png"})
    if (fetched.picture.empty() && fs::exists(folder / picture, error)) fetched.picture = picture;
  return fetched;
}

}  // namespace

ResultsCache::ResultsCache(ResultsOptions options) : options_(std::move(options)) {
  std::error_code error;
  fs::create_directories(options_.folder, error);
  RemoveOld(options_.folder);
  std::string pattern = (options_.folder / "XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr)
    throw std::runtime_error(SystemFailure(options_.folder, "make a folder in it", errno).message());
  folder_ = pattern;
  lock_ = LockFolder(folder_);
}

ResultsCache::~ResultsCache() {
  ending_ = true;
  if (const pid_t pid = running_; pid > 0) ::kill(-pid, SIGKILL);
  errands_.Stop();
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
  if (lock_ >= 0) ::close(lock_);
}

void ResultsCache::Fetch(const std::string& job, std::uint32_t stages_done, Then then) {
  const std::string key = KeyOf(job, stages_done);
  std::shared_ptr<const FetchedResults> here;
  bool refused = false;
  {
    const std::lock_guard lock(mutex_);
    if (const auto kept = kept_.find(key); kept != kept_.end() && kept->second->whole) {
      here = kept->second;
    } else {
      std::vector<Then>& waiting = awaited_[key];
      waiting.push_back(then);
      refused = waiting.size() == 1 && !errands_.Add([this, key, job] { Do(key, job); });
      if (refused) awaited_.erase(key);
    }
  }
  if (here) then(*here);
  if (refused) then({.trouble = "Too many results are being fetched: try again soon."});
}

std::shared_ptr<const FetchedResults> ResultsCache::Fetched(const std::string& job,
                                                            std::uint32_t stages_done) {
  const std::lock_guard lock(mutex_);
  const auto kept = kept_.find(KeyOf(job, stages_done));
  return kept == kept_.end() ? nullptr : kept->second;
}

void ResultsCache::Do(const std::string& key, const std::string& job) {
  fs::path folder;
  {
    const std::lock_guard lock(mutex_);
    folder = folder_ / std::to_string(++folders_);
  }
  const std::string trouble = Run(job, folder);
  auto fetched = std::make_shared<FetchedResults>(LookInto(folder));
  // What came although not all did is shown.
  fetched->whole = trouble.empty();
  if (fetched->files.stages.empty()) fetched->trouble = trouble.empty() ? "There is no result yet." : trouble;
  std::vector<Then> waiting;
  {
    const std::lock_guard lock(mutex_);
    std::error_code ignored;
    if (fetched->whole || !fetched->files.stages.empty())
      Keep(key, fetched);
    else
      fs::remove_all(folder, ignored);
    waiting = std::move(awaited_[key]);
    awaited_.erase(key);
  }
  for (const Then& then : waiting) then(*fetched);
}

void ResultsCache::Keep(const std::string& key, const std::shared_ptr<const FetchedResults>& fetched) {
  std::error_code ignored;
  if (const auto before = kept_.find(key); before != kept_.end())
    fs::remove_all(before->second->folder, ignored);
  else
    order_.push_back(key);
  kept_[key] = fetched;
  while (order_.size() > kMostKept) {
    fs::remove_all(kept_[order_.front()]->folder, ignored);
    kept_.erase(order_.front());
    order_.pop_front();
  }
}

// Why it failed; empty: it did not.
std::string ResultsCache::Run(const std::string& job, const fs::path& folder) {
  const fs::path said = folder_ / "said";
  std::vector<std::string> words = {options_.program, "results", "--out", folder.string()};
  words.insert(words.end(), options_.service.begin(), options_.service.end());
  words.insert(words.end(), {"--", job});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, said.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setpgroup(&attributes, 0);  // Ctrl-C on the terminal is not for it
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t pid = 0;
  const int failed =
      ::posix_spawn(&pid, options_.program.c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (failed != 0) return options_.program + " cannot be run: " + std::strerror(failed);
  running_ = pid;
  if (ending_) ::kill(-pid, SIGKILL);
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  running_ = 0;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  const std::string line = LastLine(said);
  return line.empty() ? "The results could not be fetched." : "The results could not be fetched: " + line;
}

}  // namespace cairn::page
