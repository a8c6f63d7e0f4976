#include "coordinator/page/watcher.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <utility>

#include "schema/error.h"

namespace cairn::page {
namespace {

constexpr double kFresh_s = 1;
constexpr double kMostWait_s = 5;
constexpr std::size_t kMostJobs = 64;

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::chrono::duration<double> Seconds(double seconds) { return std::chrono::duration<double>(seconds); }

coordinator::Client ConnectOrThrow(const coordinator::ClientOptions& options) {
  Result<coordinator::Client> client = coordinator::Client::Connect(options);
  if (!client.ok()) throw InputError(client.status().message());
  return std::move(client).value();
}

std::string UtcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%H:%M:%S UTC", &parts);
  return text.data();
}

std::string OutcomeText(const std::string& action, const wire::JobInfo& job) {
  if (action == "priority") return job.id() + " has the priority " + std::to_string(job.priority()) + ".";
  return job.id() + " is " + job.state() + ".";
}

std::string AsSentence(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  if (!text.empty() && text.back() != '.') text += '.';
  return text;
}

}  // namespace

std::string TroubleText(const Status& status) {
  if (status.code() == Code::kRefused)
    return "The coordinator does not let this page's key in: " + status.message() + ".";
  return "The coordinator does not answer: " + status.message() + ". It is asked again by itself.";
}

Watcher::Watcher(WatcherOptions options, std::function<void()> changed)
    : options_(std::move(options)),
      changed_(std::move(changed)),
      asks_(ConnectOrThrow(options_.client)),
      results_(options_.results),
      thread_([this] { Run(); }) {}

Watcher::~Watcher() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  woken_.notify_one();
  thread_.join();
}

FactsPtr Watcher::Latest() {
  const std::lock_guard lock(mutex_);
  return facts_;
}

HistoryPtr Watcher::HistoryOf(const std::string& job) {
  const std::lock_guard lock(mutex_);
  const auto looked = jobs_.find(job);
  return looked == jobs_.end() ? nullptr : looked->second.history;
}

// Where nobody answers, nobody is waited for a second time.
bool Watcher::IsFresh(const std::string& job, double now_s) const {
  if (!facts_->trouble.empty()) return now_s - tried_s_ < options_.looked_at_s;
  if (now_s - answered_s_ > kFresh_s) return false;
  // One that is not known may have come a moment ago.
  return job.empty() || (facts_->Find(job) != nullptr && jobs_.at(job).history != nullptr);
}

void Watcher::Look(const std::string& job, std::function<void()> then) {
  const double now_s = Now();
  {
    std::unique_lock lock(mutex_);
    const bool was_idle = now_s - looked_s_ > options_.looked_at_s;
    looked_s_ = now_s;
    if (!job.empty()) {
      if (jobs_.size() >= kMostJobs && !jobs_.contains(job))
        jobs_.erase(std::ranges::min_element(jobs_, {}, [](const auto& of) { return of.second.at_s; }));
      jobs_[job].at_s = now_s;
    }
    const bool fresh = IsFresh(job, now_s);
    if (then && !fresh) waiting_.push_back(std::exchange(then, nullptr));
    if (!fresh || was_idle) {
      soon_ = soon_ || !waiting_.empty() || was_idle;
      woken_.notify_one();
    }
  }
  if (then) then();
}

void Watcher::Command(const std::string& job, const std::string& action, int priority,
                      std::function<void(const CommandOutcome&)> then) {
  const bool added = errands_.Add([this, job, action, priority, then] {
    // Not before there is something to say: who connects and says nothing is turned away.
    if (!commands_) commands_.emplace(ConnectOrThrow(options_.client));
    const Result<wire::JobInfo> told = commands_->Command(job, action, priority);
    then({told.ok(), told.ok() ? OutcomeText(action, told.value()) : AsSentence(told.status().message())});
    const std::lock_guard lock(mutex_);
    soon_ = true;
    woken_.notify_one();
  });
  if (!added) then({false, "Too many commands wait for the coordinator: try again soon."});
}

FactsPtr Watcher::Ask() {
  auto facts = std::make_shared<Facts>();
  Result<coordinator::JobList> list = asks_.List();
  Status status = list.status();
  if (status.ok()) {
    facts->list = std::move(list).value();
    SortForPeople(&facts->list.jobs);
    Result<coordinator::FleetFacts> fleet = asks_.Fleet();
    status = fleet.status();
    if (status.ok()) facts->workers = std::move(fleet).value().workers;
  }
  const FactsPtr before = Latest();
  if (!status.ok()) {
    *facts = *before;
    facts->trouble = TroubleText(status);
  } else {
    times_.Add(facts->workers, Now());
    facts->times = times_;
    facts->known = true;
    facts->utc = UtcNow();
  }
  facts->number = before->number + 1;
  return facts;
}

// Of jobs that somebody looks at, those lines that are new.
void Watcher::AskForLogs(const Facts& facts) {
  std::vector<std::pair<std::string, HistoryPtr>> jobs;
  {
    const std::lock_guard lock(mutex_);
    const double now_s = Now();
    std::erase_if(jobs_, [&](const auto& of) { return now_s - of.second.at_s > 20 * options_.looked_at_s; });
    for (const auto& [id, looked] : jobs_)
      if (now_s - looked.at_s < options_.looked_at_s && facts.Find(id) != nullptr)
        jobs.emplace_back(id, looked.history);
  }
  for (const auto& [id, history] : jobs) {
    const Result<coordinator::LogPart> part = asks_.Log(id, history ? history->last() : 0);
    if (!part.ok() || (history && part.value().lines.empty())) continue;
    auto longer = history ? std::make_shared<JobHistory>(*history) : std::make_shared<JobHistory>();
    longer->Add(part.value().lines);
    const std::lock_guard lock(mutex_);
    if (const auto looked = jobs_.find(id); looked != jobs_.end()) looked->second.history = longer;
  }
}

void Watcher::Run() {
  double wait_s = 0;
  for (std::unique_lock lock(mutex_); !ending_;) {
    const bool looked_at = Now() - looked_s_ < options_.looked_at_s;
    const auto due = [this] { return ending_ || soon_; };
    if (looked_at)
      woken_.wait_for(lock, Seconds(wait_s), due);
    else
      woken_.wait(lock, due);
    if (ending_) break;
    soon_ = false;
    std::vector<std::function<void()>> waiting;
    waiting.swap(waiting_);
    lock.unlock();

    const double begin_s = Now();
    const FactsPtr facts = Ask();
    const double took_s = Now() - begin_s;
    if (facts->trouble.empty()) AskForLogs(*facts);

    lock.lock();
    facts_ = facts;
    tried_s_ = Now();
    if (facts->trouble.empty()) answered_s_ = tried_s_;
    lock.unlock();
    for (const std::function<void()>& then : waiting) then();
    changed_();
    wait_s = facts->trouble.empty() ? std::clamp(options_.share * took_s, options_.least_s, kMostWait_s)
                                    : options_.least_s;
    lock.lock();
  }
}

}  // namespace cairn::page
