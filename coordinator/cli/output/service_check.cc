#include "coordinator/cli/output/service_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace cairn::cli {
namespace {

constexpr double kNearlyFull = 0.9;

template <class Infos>
std::size_t CountState(const Infos& infos, const char* state) {
  return static_cast<std::size_t>(
      std::ranges::count_if(infos, [state](const auto& info) { return info.state() == state; }));
}

std::string Some(std::size_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

// The worst of what was found, and all of it.
class Findings {
 public:
  void Add(int code, std::string text) {
    code_ = std::max(code_, code);
    text_ += (text_.empty() ? "" : "; ") + std::move(text);
  }
  // What follows a '|' is for machines: there is none in what is for people.
  ServiceVerdict Verdict(const std::string& facts, const std::string& numbers) const {
    constexpr const char* kNames[] = {"OK", "WARNING", "CRITICAL"};
    std::string line = fmt::format("CAIRN {}: {}", kNames[code_], text_);
    if (!facts.empty()) line += (text_.empty() ? "" : "; ") + facts;
    std::ranges::replace(line, '|', '/');
    return {code_, numbers.empty() ? line : line + " | " + numbers};
  }

 private:
  int code_ = 0;
  std::string text_;
};

}  // namespace

ServiceVerdict CheckService(const coordinator::JobList& list, const std::vector<wire::WorkerInfo>& workers) {
  const std::size_t running = CountState(list.jobs, "running"), queued = CountState(list.jobs, "queued");
  const std::size_t hung = CountState(workers, "hung");
  const std::size_t able = workers.size() - hung - CountState(workers, "draining");
  const auto unable = static_cast<std::size_t>(std::ranges::count_if(list.jobs, [](const wire::JobInfo& job) {
    return job.state() == "paused" && job.reason() != "paused by its owner";
  }));
  Findings found;
  if (!list.warning.empty()) found.Add(list.store_fails ? 2 : 1, list.warning);
  if (running + queued > 0 && able == 0) found.Add(2, "no worker can take what the jobs wait for");
  if (unable > 0) found.Add(1, Some(unable, "job") + " paused, not by the owner");
  if (hung > 0) found.Add(1, Some(hung, "worker") + " hung");
  const auto bytes = static_cast<double>(list.store.bytes),
             limit = static_cast<double>(list.store.limit_bytes);
  if (limit > 0 && bytes > kNearlyFull * limit)
    found.Add(1, fmt::format("the store is {:.0f}% full", 100 * bytes / limit));
  return found.Verdict(
      Some(running, "job") + " running, " + std::to_string(queued) + " queued, " +
          Some(workers.size(), "worker"),
      fmt::format("jobs_running={} jobs_queued={} jobs_paused={} jobs_failed={} workers={} store={}B;;;0;{}",
                  running, queued, CountState(list.jobs, "paused"), CountState(list.jobs, "failed"),
                  workers.size(), list.store.bytes,
                  list.store.limit_bytes == 0 ? "" : std::to_string(list.store.limit_bytes)));
}

ServiceVerdict Unanswered(const std::string& why) {
  Findings found;
  found.Add(2, why);
  return found.Verdict("", "");
}

}  // namespace cairn::cli
