#include "coordinator/core/core.h"

#include <algorithm>
#include <cmath>

namespace cairn::coordinator {

std::vector<Action> Core::Handle(const Event& event, double now_s) {
  CAIRN_DEMAND(now_s >= now_s_, "time runs backwards");
  now_s_ = now_s;
  if (!behind_) caught_up_s_ = now_s;
  LeaveOutStandstill();
  std::visit([this](const auto& e) { On(e); }, event);
  Settle();
  return std::exchange(actions_, {});
}

void Core::Settle() {
  Dispatch();
  SaveWhatIsDue();
  if (all_touched_) LookAhead();
  touched_.clear();
  all_touched_ = workers_due_ = false;
  const std::vector<Hash> dropped = ledger_.TakeDropped();
  if (dropped.empty()) return;
  fleet_.Forget(dropped);
  actions_.push_back(DropBlobs{dropped});
}

namespace {

double ShareOf(const Job& job) { return std::exp2(job.spec.priority()); }

// In the order of tasks; of one that two workers have, how long the first has had it.
void KeepLongest(std::vector<std::pair<std::uint32_t, double>>& running_s) {
  std::ranges::sort(running_s, [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : a.second > b.second;
  });
  const auto same = std::ranges::unique(running_s, {}, &std::pair<std::uint32_t, double>::first);
  running_s.erase(same.begin(), same.end());
}

}  // namespace

void Core::LookAhead() {
  std::map<std::uint64_t, Effort> efforts;
  double shares = 0;
  for (const auto& [order, job] : jobs_) {
    if (!job.Running()) continue;
    shares += ShareOf(job);
    if (job.step && job.eta.IsDue(now_s_)) efforts[order];
  }
  if (efforts.empty()) return;
  for (const auto& [number, worker] : fleet_.workers()) {
    if (worker.assigned.empty()) continue;
    const wire::TaskKey& key = worker.assigned.front().key;
    const auto order = orders_.find(key.job());
    if (order == orders_.end() || !jobs_.at(order->second).IsUnderWay(key)) continue;
    if (const auto effort = efforts.find(order->second); effort != efforts.end())
      effort->second.running_s.emplace_back(key.task(), now_s_ - worker.head_s);
  }
  for (auto& [order, effort] : efforts) {
    KeepLongest(effort.running_s);
    Job& job = jobs_.at(order);
    effort.workers = static_cast<double>(fleet_.able()) * ShareOf(job) / shares;
    job.eta.Look(*job.step, job.tasks, effort, now_s_);
  }
}

namespace {

// How many workers are assigned tasks of each job.
std::map<std::string, std::uint32_t> CountWorkers(const Fleet& fleet) {
  std::map<std::string, std::uint32_t> counts;
  for (const auto& [number, worker] : fleet.workers()) {
    const auto same = [&worker](const AssignedTask& task) {
      return task.key.job() == worker.assigned.front().key.job();
    };
    if (!worker.assigned.empty() && std::all_of(worker.assigned.begin(), worker.assigned.end(), same)) {
      ++counts[worker.assigned.front().key.job()];  // nearly always
      continue;
    }
    std::set<std::string> jobs;
    for (const AssignedTask& task : worker.assigned) jobs.insert(task.key.job());
    for (const std::string& job : jobs) ++counts[job];
  }
  return counts;
}

// Of what nobody works at nobody can tell when it is done.
wire::JobInfo WithWorkers(wire::JobInfo info, std::uint32_t workers) {
  info.set_workers(workers);
  if (workers == 0) {
    info.clear_eta_s();
    info.clear_eta_least_s();
    info.clear_eta_most_s();
  }
  return info;
}

}  // namespace

std::vector<wire::JobInfo> Core::Jobs() const {
  std::map<std::string, std::uint32_t> workers = CountWorkers(fleet_);
  std::vector<wire::JobInfo> infos;
  infos.reserve(jobs_.size());
  for (const auto& [order, job] : jobs_) infos.push_back(WithWorkers(MakeInfo(job, now_s_), workers[job.id]));
  return infos;
}

std::optional<wire::JobInfo> Core::Find(const std::string& id) const {
  const Job* job = FindJob(id);
  if (job == nullptr) return std::nullopt;
  return WithWorkers(MakeInfo(*job, now_s_), CountWorkers(fleet_)[id]);
}

const Job* Core::FindJob(const std::string& id) const {
  const auto it = orders_.find(id);
  return it == orders_.end() ? nullptr : &jobs_.at(it->second);
}

std::vector<wire::WorkerInfo> Core::Workers() const {
  std::vector<wire::WorkerInfo> infos;
  for (const auto& [number, worker] : fleet_.workers()) {
    wire::WorkerInfo& info = infos.emplace_back(MakeInfo(worker, now_s_));
    if (worker.assigned.empty()) continue;
    const wire::TaskKey& key = worker.assigned.front().key;
    const Job* job = FindJob(key.job());
    info.set_task(
        key.job() + ": " +
        (job != nullptr && job->IsUnderWay(key) ? job->TaskName(key.task()) : "not wanted any more"));
  }
  return infos;
}

std::vector<wire::Demand> Core::Demand() const {
  std::vector<wire::Demand> demands;
  for (const auto& [order, job] : jobs_)
    if (job.Running() && !job.AllStagesDone()) demands.push_back(DemandOf(job));
  return demands;
}

bool Core::MayRead(const std::string& peer, const Hash& hash) const {
  const Worker* worker = fleet_.Find(peer);
  return worker != nullptr && worker->has.contains(hash);
}

bool Core::HasUnsaved() const {
  for (const auto& [order, job] : jobs_)
    if (job.leaving || job.saving.under_way || (job.saving.due && !job.SavingWaits())) return true;
  return false;
}

}  // namespace cairn::coordinator
