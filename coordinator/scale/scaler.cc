#include "coordinator/scale/scaler.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include "schema/text.h"

namespace cairn::coordinator {
namespace {

constexpr std::uint64_t kMostNumber = 1'000'000'000'000;

std::string Workers(int count) { return std::to_string(count) + (count == 1 ? " worker" : " workers"); }

}  // namespace

std::uint64_t Scaler::NumberOf(const std::string& name) const {
  std::uint64_t number = 0;
  if (!name.starts_with(options_.prefix)) return 0;
  const char* end = name.data() + name.size();
  const auto read = std::from_chars(name.data() + options_.prefix.size(), end, number);
  const bool is_number = read.ec == std::errc() && read.ptr == end && number <= kMostNumber;
  return is_number && name == options_.prefix + std::to_string(number) ? number : 0;
}

void Scaler::Say(const std::string& topic, Severity severity, const std::string& line) {
  if (std::exchange(said_[topic], line) != line) log_(severity, line);
}

void Scaler::Try(const Status& status) {
  if (!status.ok()) Say("act", Severity::kWarning, status.message());
}

template <class T>
bool Scaler::Know(const char* whom, Result<T> answer, T& told) {
  if (!answer.ok()) {
    Say(whom, Severity::kWarning,
        std::string(whom) + " cannot be asked, nothing is done meanwhile: " + answer.status().message());
    return false;
  }
  if (said_.erase(whom) > 0) log_(Severity::kInfo, std::string(whom) + " answers again");
  told = std::move(answer).value();
  return true;
}

bool Scaler::Look(Seen& seen) {
  return Know("the coordinator", service_.Ask(), seen.facts) &&
         Know("the engine", engine_.List(), seen.listed) &&
         Know("the list of keys", keys_.Names(), seen.keys);
}

void Scaler::Turn(double now_s) {
  over_ = false;
  Seen seen;
  if (!Look(seen)) return spells_.clear();  // nobody knows who has been idle meanwhile
  ours_.clear();
  names_.clear();
  NoteKeys(seen.keys, now_s);
  CountConnected(seen.facts, now_s);
  CountListed(seen.listed, now_s);
  CountMissing(now_s);
  const bool has_work = !seen.facts.demand.empty();
  over_ = ours_.empty() && (options_.leave || (options_.until_done && !has_work));
  DropKeys(now_s);
  if (over_) return;
  const PolicyOptions policy = PolicyNow(has_work);
  const Decision decision = Decide(policy, seen.facts.demand, others_, ours_, now_s - started_s_);
  if (decision.start > 0 && now_s >= not_before_s_) Start(decision.start, now_s);
  Release(decision.leave);
}

PolicyOptions Scaler::PolicyNow(bool has_work) const {
  if (!options_.leave && (has_work || !options_.until_done)) return options_.policy;
  return {.least = 0, .most = 0, .work_s = options_.policy.work_s, .idle_s = 0, .cool_down_s = 0};
}

void Scaler::Add(const std::string& name, std::uint64_t number, State state, double for_s) {
  ours_.push_back({state, for_s});
  names_.push_back({name, number});
}

bool Scaler::IsConnected(const std::string& name, double now_s) const {
  const auto life = lives_.find(name);
  return life != lives_.end() && life->second.connected_s == now_s;
}

// Of those that a Scaler before this one started, too.
void Scaler::NoteKeys(const std::vector<std::string>& keys, double now_s) {
  for (const std::string& name : keys) {
    if (NumberOf(name) == 0) continue;
    last_number_ = std::max(last_number_, NumberOf(name));
    lives_.try_emplace(name, Life{.seen_s = now_s, .asked_s = now_s});
  }
}

void Scaler::CountConnected(const ScaleFacts& facts, double now_s) {
  others_ = 0;
  std::map<std::uint64_t, Spell> spells;
  for (const wire::WorkerInfo& worker : facts.workers) {
    const bool leaves = worker.state() == "draining";
    if (!IsOurs(worker.name())) {
      if (!leaves) ++others_;
      continue;
    }
    last_number_ = std::max(last_number_, NumberOf(worker.name()));
    Life& life = lives_.try_emplace(worker.name(), Life{.asked_s = now_s}).first->second;
    if (life.connected_s < 0) failures_ = 0;
    life.connected_s = life.seen_s = now_s;
    const State state = leaves ? State::kLeaving : worker.assigned() == 0 ? State::kIdle : State::kBusy;
    const auto before = spells_.find(worker.number());
    const bool goes_on = before != spells_.end() && before->second.state == state;
    const Spell spell = goes_on ? before->second : Spell{state, now_s};
    spells[worker.number()] = spell;
    Add(worker.name(), worker.number(), state, now_s - spell.since_s);
  }
  spells_ = std::move(spells);
}

void Scaler::CountListed(const std::vector<EngineWorker>& listed, double now_s) {
  std::vector<std::string> ended;
  for (const EngineWorker& worker : listed) {
    if (worker.state == EngineWorker::State::kEnded) {
      if (NumberOf(worker.name) != 0 && TakeEnded(worker, now_s)) ended.push_back(worker.name);
      continue;
    }
    if (!IsOurs(worker.name)) {
      if (NumberOf(worker.name) != 0) StopStray(worker.name, now_s);
      continue;
    }
    last_number_ = std::max(last_number_, NumberOf(worker.name));
    Life& life = lives_.try_emplace(worker.name, Life{.asked_s = now_s}).first->second;
    life.seen_s = now_s;
    const bool waits = worker.state == EngineWorker::State::kWaiting;
    if (waits)
      life.runs_s = -1;
    else if (life.runs_s < 0)
      life.runs_s = now_s;
    if (life.connected_s == now_s) continue;
    if (waits)
      Add(worker.name, 0, life.drained ? State::kLeaving : State::kWaiting, now_s - life.asked_s);
    else
      CountRunning(worker.name, life, now_s);
  }
  if (!ended.empty()) engine_.Forget(ended);
}

// One that was given up, and has lost its key: the service takes nothing of it, and it ends by itself, unless
// it hangs.
void Scaler::StopStray(const std::string& name, double now_s) {
  constexpr std::size_t kMost = 10'000;  // a host may list what it likes
  if (strays_.size() >= kMost) strays_.clear();
  double& since_s = strays_.try_emplace(name, now_s).first->second;
  if (now_s - since_s < options_.connect_s) return;
  Try(engine_.Stop({name}));
  strays_.erase(name);
}

// One that runs and is not connected.
void Scaler::CountRunning(const std::string& name, Life& life, double now_s) {
  const double until_s =
      life.connected_s < 0 ? life.runs_s + options_.connect_s : life.connected_s + options_.back_s;
  if (now_s < until_s)
    return Add(name, 0, life.drained ? State::kLeaving : State::kStarting, now_s - life.runs_s);
  if (life.stopped_s < 0 && life.connected_s < 0)
    NoteFailure(
        name + " runs, but has not connected for " + std::to_string(std::lround(options_.connect_s)) + " s",
        now_s);
  // Told once in a while: an engine may forget what it was told.
  if (life.stopped_s < 0 || now_s - life.stopped_s >= options_.gone_s) {
    life.stopped_s = now_s;
    Try(engine_.Stop({name}));
  }
  if (now_s < until_s + options_.connect_s) Add(name, 0, State::kLeaving, now_s - until_s);
}

// One that neither engine nor service knows now may be on its way to be listed, or back.
void Scaler::CountMissing(double now_s) {
  for (const auto& [name, life] : lives_) {
    const double grace_s = life.connected_s < 0 ? options_.gone_s : options_.back_s;
    if (life.started && life.seen_s < now_s && now_s - life.seen_s < grace_s && !life.drained)
      Add(name, 0, State::kStarting, now_s - life.seen_s);
  }
}

bool Scaler::TakeEnded(const EngineWorker& ended, double now_s) {
  if (IsConnected(ended.name, now_s)) return false;  // the engine is mistaken
  const auto life = lives_.find(ended.name);
  if (life == lives_.end()) return true;  // of one that was given up before
  const bool expected = life->second.drained || life->second.stopped_s >= 0;
  const std::string where = ended.where.empty() ? "" : " on " + ended.where;
  const std::string why = ended.why.empty() && !expected ? "it was told to, but not from here" : ended.why;
  const std::string line = ended.name + where + " has ended" + (why.empty() ? "" : ": " + why);
  if (!expected && life->second.connected_s < 0)
    NoteFailure(line, now_s);
  else
    log_(expected ? Severity::kInfo : Severity::kWarning, line);
  Try(keys_.Revoke(ended.name));
  lives_.erase(life);
  return true;
}

// Of those that are gone: neither engine nor service knows them.
void Scaler::DropKeys(double now_s) {
  std::erase_if(lives_, [&](const auto& entry) {
    const auto& [seen_s, drained] = std::pair(entry.second.seen_s, entry.second.drained);
    const bool gone = over_ || (drained && seen_s < now_s) || now_s - seen_s >= options_.gone_s;
    if (!gone) return false;
    if (!drained) log_(Severity::kInfo, entry.first + " is gone");
    Try(keys_.Revoke(entry.first));
    return true;
  });
}

void Scaler::NoteFailure(const std::string& why, double now_s) {
  if (now_s < not_before_s_) return Say("start", Severity::kWarning, why);
  const double wait_s =
      std::min(options_.most_patience_s, options_.patience_s * std::exp2(std::min(failures_, 30)));
  ++failures_;
  not_before_s_ = now_s + wait_s;
  Say("start", Severity::kWarning,
      why + "; none is started for " + std::to_string(std::lround(wait_s)) + " s");
}

void Scaler::Start(int count, double now_s) {
  std::vector<std::string> names;
  for (int i = 0; i < count; ++i) {
    const std::string name = options_.prefix + std::to_string(++last_number_);
    if (const Status made = keys_.Make(name); !made.ok()) {
      NoteFailure("no key can be made: " + made.message(), now_s);
      break;
    }
    names.push_back(name);
  }
  if (names.empty()) return;
  const Engine::Started started = engine_.Start(names);
  const std::set<std::string> begun(started.names.begin(), started.names.end());
  for (const std::string& name : names) {
    if (begun.contains(name))
      lives_[name] = {.seen_s = now_s, .asked_s = now_s, .started = true};
    else
      Try(keys_.Revoke(name));
  }
  if (!begun.empty()) {
    started_s_ = now_s;
    log_(Severity::kInfo,
         "starts " + Workers(static_cast<int>(begun.size())) + ": " + NameList(started.names));
  }
  if (started.status.ok()) return;
  if (begun.empty())
    NoteFailure(started.status.message(), now_s);
  else
    Say("start", Severity::kWarning, started.status.message());
}

void Scaler::Release(const std::vector<std::size_t>& leave) {
  for (const std::size_t i : leave) {
    const auto& [name, number] = names_[i];
    log_(Severity::kInfo, name + (number == 0 ? " is not waited for any more" : " leaves"));
    lives_[name].drained = true;
    Try(number == 0 ? engine_.Stop({name}) : service_.Drain(number));
  }
}

}  // namespace cairn::coordinator
