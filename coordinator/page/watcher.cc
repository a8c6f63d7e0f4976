#include "coordinator/page/watcher.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <utility>

#include "schema/error.h"
#include "schema/wire/endpoint.h"

namespace cairn::page {
namespace {

constexpr double kFresh_s = 1;
constexpr double kMostWait_s = 5;
constexpr std::size_t kMostJobs = 64;

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::chrono::duration<double> Seconds(double seconds) { return std::chrono::duration<double>(seconds); }

// Without a connection: one that is let go at once is counted, too.
WatcherOptions CheckedOrThrow(WatcherOptions options) {
  const Status status = wire::CheckEndpoint(options.client.endpoint, options.client.security.has_value());
  if (!status.ok()) throw InputError(status.message());
  return options;
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
    : options_(CheckedOrThrow(std::move(options))),
      changed_(std::move(changed)),
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

HistoryPtr Watcher::HistoryOf(const wire::JobInfo& job) {
  const std::lock_guard lock(mutex_);
  const auto looked = jobs_.find(job.id());
  return looked == jobs_.end() || looked->second.mark != job.mark() ? nullptr : looked->second.history;
}

// Where nobody answers, nobody is waited for a second time.
bool Watcher::IsFresh(const std::string& job, double now_s) const {
  if (!facts_->trouble.empty()) return now_s - tried_s_ < options_.looked_at_s;
  if (job.empty()) return now_s - answered_s_ < kFresh_s;
  const LookedAt& looked = jobs_.at(job);
  return facts_->Find(job) != nullptr && looked.history && now_s - looked.answered_s < kFresh_s;
}

void Watcher::Look(const std::string& job, std::function<void()> then) {
  const double now_s = Now();
  {
    std::unique_lock lock(mutex_);
    const bool was_idle = now_s - looked_s_ > options_.looked_at_s;
    looked_s_ = now_s;
    if (job.empty()) {
      soon_ = soon_ || now_s - list_looked_s_ > options_.looked_at_s;
      list_looked_s_ = now_s;
    } else {
      if (jobs_.size() >= kMostJobs && !jobs_.contains(job))
        jobs_.erase(std::ranges::min_element(jobs_, {}, [](const auto& of) { return of.second.at_s; }));
      jobs_[job].at_s = now_s;
    }
    const bool fresh = IsFresh(job, now_s);
    if (then && !fresh) {
      waiting_.push_back(std::exchange(then, nullptr));
      // One that is not known may have come a moment ago.
      (job.empty() || facts_->Find(job) == nullptr ? soon_ : soon_jobs_) = true;
    }
    soon_ = soon_ || was_idle;
    if (!fresh || was_idle) woken_.notify_one();
  }
  if (then) then();
}

void Watcher::Command(const std::string& job, const std::string& action, int priority,
                      std::function<void(const CommandOutcome&)> then) {
  const bool added = errands_.Add([this, job, action, priority, then] {
    // No longer than there is something to say: who connects and says nothing is turned away.
    Result<coordinator::Client> client = coordinator::Client::Connect(options_.client);
    const Result<wire::JobInfo> told =
        client.ok() ? client.value().Command(job, action, priority) : client.status();
    then({told.ok(), told.ok() ? OutcomeText(action, told.value()) : AsSentence(told.status().message())});
    const std::lock_guard lock(mutex_);
    soon_ = true;
    woken_.notify_one();
  });
  if (!added) then({false, "Too many commands wait for the coordinator: try again soon."});
}

// So that no more than a part of the coordinator's time goes here.
void Watcher::SetDue(Due* due, double begin_s, double least_s) const {
  const double now_s = Now();
  due->at_s = now_s + std::clamp(options_.share * (now_s - begin_s), least_s, std::max(least_s, kMostWait_s));
}

Status Watcher::AskForList(Facts* facts) {
  const double begin_s = Now();
  bool is_looked_at = false;
  {
    const std::lock_guard lock(mutex_);
    is_looked_at = begin_s - list_looked_s_ < options_.looked_at_s;
  }
  Result<coordinator::JobList> list = asks_->List();
  SetDue(&list_, begin_s, is_looked_at ? options_.least_s : std::max(options_.least_s, options_.unseen_s));
  if (!list.ok()) return list.status();
  facts->list = std::make_shared<coordinator::JobList>(std::move(list).value());
  facts->newer.clear();
  SortForPeople(&facts->list->jobs);
  const std::lock_guard lock(mutex_);
  answered_s_ = Now();
  return Status::Ok();
}

Status Watcher::AskForFleet(Facts* facts) {
  const double begin_s = Now();
  Result<coordinator::FleetFacts> fleet = asks_->Fleet();
  SetDue(&fleet_, begin_s, options_.least_s);
  if (!fleet.ok()) return fleet.status();
  facts->workers = std::move(fleet).value().workers;
  times_.Add(facts->workers, Now());
  facts->times = times_;
  return Status::Ok();
}

// The lines that are not known yet. Where another job has its id now nothing that was said before is kept.
Result<coordinator::LogPart> Watcher::AskForLog(const std::string& job, LookedAt* known) {
  Result<coordinator::LogPart> part = asks_->Log(job, known->history ? known->history->last() : 0);
  if (!part.ok() || !known->history || part.value().job.mark() == known->mark) return part;
  known->history = nullptr;
  return asks_->Log(job);
}

// Of each that somebody looks at how it stands, and those lines of its log that are new: that takes as long
// whatever other jobs there are. One that is gone is not on the next list.
Status Watcher::AskForJobs(Facts* facts) {
  const double begin_s = Now();
  std::vector<std::pair<std::string, LookedAt>> jobs;
  {
    const std::lock_guard lock(mutex_);
    std::erase_if(jobs_,
                  [&](const auto& of) { return begin_s - of.second.at_s > 20 * options_.looked_at_s; });
    for (const auto& [id, looked] : jobs_)
      if (begin_s - looked.at_s < options_.looked_at_s && facts->Find(id) != nullptr)
        jobs.emplace_back(id, looked);
  }
  for (auto& [id, known] : jobs) {
    const Result<coordinator::LogPart> part = AskForLog(id, &known);
    const HistoryPtr& history = known.history;
    if (!part.ok()) {
      const Code code = part.status().code();
      if (code != Code::kRefused && code != Code::kNoSpace) return part.status();
      list_.at_s = -1e9;
      continue;
    }
    facts->newer[id] = part.value().job;
    auto longer = history;
    if (!history || !part.value().lines.empty()) {
      const auto more = history ? std::make_shared<JobHistory>(*history) : std::make_shared<JobHistory>();
      more->Add(part.value().lines);
      longer = more;
    }
    const std::lock_guard lock(mutex_);
    if (const auto looked = jobs_.find(id); looked != jobs_.end()) {
      looked->second.history = longer;
      looked->second.mark = part.value().job.mark();
      looked->second.answered_s = Now();
    }
  }
  SetDue(&looked_, begin_s, options_.least_s);
  return Status::Ok();
}

Status Watcher::Reach() {
  if (asks_) return Status::Ok();
  Result<coordinator::Client> client = coordinator::Client::Connect(options_.client);
  if (!client.ok()) return client.status();
  asks_.emplace(std::move(client).value());
  return Status::Ok();
}

FactsPtr Watcher::Ask(bool all) {
  const FactsPtr before = Latest();
  auto facts = std::make_shared<Facts>(*before);
  Status status = Reach();
  if (status.ok() && (all || Now() >= list_.at_s)) status = AskForList(facts.get());
  if (status.ok() && (all || Now() >= fleet_.at_s)) status = AskForFleet(facts.get());
  if (status.ok()) status = AskForJobs(facts.get());
  if (status.ok()) {
    facts->known = true;
    facts->trouble.clear();
    facts->utc = UtcNow();
  } else {
    *facts = *before;
    const bool says_own = !options_.unanswered.empty() && status.code() != Code::kRefused;
    facts->trouble = says_own ? options_.unanswered : TroubleText(status);
    list_.at_s = -1e9;  // all may be another when it is back
  }
  facts->number = before->number + 1;
  return facts;
}

double Watcher::NextAt_s() const { return std::min({list_.at_s, fleet_.at_s, looked_.at_s}); }

void Watcher::Run() {
  double next_s = 0;
  for (std::unique_lock lock(mutex_); !ending_;) {
    const bool looked_at = Now() - looked_s_ < options_.looked_at_s;
    const auto due = [this] { return ending_ || soon_ || soon_jobs_; };
    if (looked_at) {
      woken_.wait_for(lock, Seconds(next_s - Now()), due);
    } else {
      asks_.reset();  // who is connected and says nothing is turned away, again and again
      woken_.wait(lock, due);
    }
    if (ending_) break;
    const bool all = std::exchange(soon_, false);
    soon_jobs_ = false;
    std::vector<std::function<void()>> waiting;
    waiting.swap(waiting_);
    lock.unlock();

    const FactsPtr facts = Ask(all);

    lock.lock();
    facts_ = facts;
    tried_s_ = Now();
    lock.unlock();
    for (const std::function<void()>& then : waiting) then();
    changed_();
    next_s = facts->trouble.empty() ? std::max(NextAt_s(), Now() + options_.least_s / 2)
                                    : Now() + options_.least_s;
    lock.lock();
  }
}

}  // namespace cairn::page
