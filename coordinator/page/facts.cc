#include "coordinator/page/facts.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <tuple>

#include "coordinator/page/html.h"

namespace cairn::page {
namespace {

constexpr std::size_t kMostSpans = 200;  // of a worker

// "3-museum" -> 3
std::uint64_t NumberOf(const std::string& id) {
  std::uint64_t number = 0;
  std::from_chars(id.data(), id.data() + id.size(), number);
  return number;
}

std::string NameOf(const wire::WorkerInfo& worker) {
  return worker.name().empty() ? worker.host() + ", process " + std::to_string(worker.pid()) : worker.name();
}

}  // namespace

void FleetTimes::Add(const std::vector<wire::WorkerInfo>& workers, double now_s) {
  now_s_ = now_s;
  std::set<std::uint64_t> here;
  for (const wire::WorkerInfo& worker : workers) {
    here.insert(worker.number());
    OfWorker& of = workers_[worker.number()];
    of.name = NameOf(worker);
    // A coordinator that is started again gives its workers the same numbers.
    if (worker.joined_s() > 0 && !of.spans.empty() && of.spans.front().end_s < now_s - worker.joined_s())
      std::erase_if(of.spans, [&](const TaskSpan& span) { return span.end_s < now_s - worker.joined_s(); });
    while (!of.spans.empty() && (of.spans.front().end_s < now_s - kKept_s || of.spans.size() > kMostSpans))
      of.spans.pop_front();
    if (worker.assigned() == 0 || worker.task().empty()) continue;
    const std::size_t colon = worker.task().find(": ");
    const double begin_s = now_s - std::max(0.0, worker.task_s());
    // The same task where it did not begin after it was seen last.
    TaskSpan* last = of.spans.empty() ? nullptr : &of.spans.back();
    const std::string task = colon == std::string::npos ? worker.task() : worker.task().substr(colon + 2);
    if (last != nullptr && last->task == task && begin_s <= last->end_s) {
      last->end_s = now_s;
      continue;
    }
    const double free_s = last == nullptr ? begin_s : std::max(begin_s, last->end_s);
    of.spans.push_back({worker.task().substr(0, std::min(colon, worker.task().size())), task, free_s, now_s});
  }
  std::erase_if(workers_, [&here](const auto& of) { return !here.contains(of.first); });
}

const wire::JobInfo* Facts::Find(const std::string& job) const {
  if (const auto since = newer.find(job); since != newer.end()) return &since->second;
  const auto found = std::ranges::find(list->jobs, job, [](const wire::JobInfo& info) { return info.id(); });
  return found == list->jobs.end() ? nullptr : &*found;
}

bool IsOver(const wire::JobInfo& job) {
  return job.state() == "done" || job.state() == "failed" || job.state() == "cancelled";
}

std::uint32_t StagesDone(const wire::JobInfo& job) {
  return job.state() == "done" ? job.stages() : std::min(job.stage(), job.stages());
}

double PartDone(const wire::JobInfo& job) {
  if (job.state() == "done") return 1;
  if (job.rounds_left() == 0) return -1;
  const double of_round = job.tasks() == 0 ? 0 : static_cast<double>(job.tasks_done()) / job.tasks();
  const double round = static_cast<double>(job.round());
  return std::min(1.0, (round + of_round) / (round + job.rounds_left()));
}

std::string LeftText(const wire::JobInfo& job) {
  constexpr double kSpan = 2;  // narrower ones are told as a figure
  if (job.eta_s() <= 0 || IsOver(job)) return "";
  const auto text = [](double seconds) { return Duration(std::max(1.0, seconds)); };
  if (job.eta_most_s() <= kSpan * job.eta_least_s()) return text(job.eta_s());
  const std::string least = text(job.eta_least_s()), most = text(job.eta_most_s());
  return least == most ? most : least + " to " + most;
}

void SortForPeople(std::vector<wire::JobInfo>* jobs) {
  std::vector<std::tuple<bool, std::uint64_t, std::size_t>> order;
  order.reserve(jobs->size());
  for (std::size_t i = 0; i < jobs->size(); ++i)
    order.emplace_back(IsOver((*jobs)[i]), ~NumberOf((*jobs)[i].id()), i);
  std::ranges::sort(order);
  std::vector<wire::JobInfo> sorted;
  sorted.reserve(jobs->size());
  for (const auto& [over, number, at] : order) sorted.push_back(std::move((*jobs)[at]));
  jobs->swap(sorted);
}

std::string AdviceOf(const wire::JobInfo& job, std::size_t workers) {
  if (job.state() == "failed" && job.input_error())
    return "Its input is at fault: mend what the reason names, and submit the job again.";
  if (job.state() == "failed")
    return "Retry goes on from the last checkpoint. The log below says which attempts failed, and why.";
  if (job.state() == "paused") return "Resume goes on from where it was.";
  if (job.state() == "cancelled") return "A job that was cancelled does not go on: submit it again.";
  if (job.state() == "done") return "";
  if (workers == 0)
    return "No worker is connected: start one with “cairn worker”, on this machine or others.";
  if (job.state() == "queued") return "It waits until workers are free, or its turn comes.";
  if (job.retries() > 0)
    return "Attempts that failed were tried again by themselves; three of one task end a job.";
  return "";
}

std::vector<std::string> ActionsFor(const wire::JobInfo& job) {
  if (job.state() == "failed") return {"retry", "delete"};
  if (IsOver(job)) return {"delete"};
  if (job.state() == "paused") return {"resume", "cancel", "priority"};
  return {"pause", "cancel", "priority"};
}

}  // namespace cairn::page
