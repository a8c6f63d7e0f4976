// Keeps an engine's workers at what the policy says. Asks the service what it could use and who is connected,
// the engine what it has, and lets them start, drain and be forgotten; each worker by its name, which it says
// in its Hello. It keeps nothing that it could not find again: another Scaler goes on where this one ended.
//
// A worker that is connected counts, whatever the engine says of it. One that the engine says runs counts for
// as long as it may take to connect, or to come back; after that it is stopped. One that computes is never
// ended: it is drained once it has had nothing to do for a while. While service or engine cannot be asked
// nothing is done.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "coordinator/scale/engine.h"
#include "coordinator/scale/policy.h"
#include "coordinator/store/log.h"

namespace cairn::coordinator {

struct ScaleFacts {
  std::vector<wire::WorkerInfo> workers;
  std::vector<wire::Demand> demand;
};

// What a Scaler asks of the coordinator.
class ScaledService {
 public:
  ScaledService() = default;
  ScaledService(const ScaledService&) = delete;
  ScaledService& operator=(const ScaledService&) = delete;
  virtual ~ScaledService() = default;
  virtual Result<ScaleFacts> Ask() = 0;
  virtual Status Drain(std::uint64_t worker) = 0;
};

// A key for each worker, under its name; none is needed where nobody else can come in.
class WorkerKeys {
 public:
  WorkerKeys() = default;
  WorkerKeys(const WorkerKeys&) = delete;
  WorkerKeys& operator=(const WorkerKeys&) = delete;
  virtual ~WorkerKeys() = default;
  virtual bool Needed() const { return true; }           // false: names are all that there is
  virtual Result<std::vector<std::string>> Names() = 0;  // those that have one
  virtual Status Make(const std::string& name) = 0;
  virtual Status Revoke(const std::string& name) = 0;  // nothing where it has none
};

struct ScalerOptions {
  PolicyOptions policy = {};
  std::string prefix = {};       // of the names of its workers: "slurm-5e1f-"
  double connect_s = 120;        // a worker that runs says Hello within this long
  double back_s = 15;            // one that was connected is back within this long
  double gone_s = 30;            // a name that nobody knows for this long has no key any more
  double patience_s = 5;         // before the next start after one that failed; each failure doubles it …
  double most_patience_s = 300;  // … up to this
  bool until_done = false;       // where no job runs all go at once
  bool leave = false;            // all go that have nothing to do, and none is started
};

class Scaler {
 public:
  Scaler(ScalerOptions options, Engine& engine, ScaledService& service, WorkerKeys& keys, LogSink log)
      : options_(std::move(options)), engine_(engine), service_(service), keys_(keys), log_(std::move(log)) {}

  // Looks and acts once. Times never run backwards.
  void Turn(double now_s);
  // By the last turn: none is there or asked for, and none will be started.
  bool over() const { return over_; }
  std::size_t workers() const { return ours_.size(); }

 private:
  using State = ScaledWorker::State;
  struct Life {               // of a name
    double seen_s = 0;        // when engine or service last knew it
    double asked_s = 0;       // when it was first seen, or started
    double runs_s = -1;       // since when the engine says that it runs; -1: it waits
    double connected_s = -1;  // when it last was; -1: never
    double stopped_s = -1;    // when the engine was last told to end it; -1: never
    bool started = false;     // by this Scaler
    bool drained = false;     // it was told to go
  };
  struct Spell {
    State state = State::kIdle;
    double since_s = 0;
  };
  struct Ours {
    std::string name;
    std::uint64_t number = 0;  // 0: it is not connected
  };

  struct Seen {
    std::vector<EngineWorker> listed;
    ScaleFacts facts;
    std::vector<std::string> keys;
  };
  bool Look(Seen& seen);
  template <class T>
  bool Know(const char* whom, Result<T> answer, T& told);
  void NoteKeys(const std::vector<std::string>& keys, double now_s);
  void CountConnected(const ScaleFacts& facts, double now_s);
  void CountListed(const std::vector<EngineWorker>& listed, double now_s);
  void CountMissing(double now_s);
  void CountRunning(const std::string& name, Life& life, double now_s);
  void Add(const std::string& name, std::uint64_t number, State state, double for_s);
  bool IsConnected(const std::string& name, double now_s) const;
  void StopStray(const std::string& name, double now_s);
  bool TakeEnded(const EngineWorker& ended, double now_s);  // true: it may be forgotten
  void DropKeys(double now_s);
  PolicyOptions PolicyNow(bool has_work) const;
  void Start(int count, double now_s);
  void Release(const std::vector<std::size_t>& leave);
  void NoteFailure(const std::string& why, double now_s);
  void Say(const std::string& topic, Severity severity, const std::string& line);  // the same once
  void Try(const Status& status);
  std::uint64_t NumberOf(const std::string& name) const;  // 0: none that a worker of ours could have
  // With keys only what has one is ours, whatever a host or a worker says its name is.
  bool IsOurs(const std::string& name) const {
    return NumberOf(name) != 0 && (!keys_.Needed() || lives_.contains(name));
  }

  const ScalerOptions options_;
  Engine& engine_;
  ScaledService& service_;
  WorkerKeys& keys_;
  const LogSink log_;

  std::map<std::string, Life> lives_;
  std::map<std::string, double> strays_;   // since when the engine lists them without a key
  std::map<std::uint64_t, Spell> spells_;  // of those that are connected, by number
  std::vector<ScaledWorker> ours_;         // at the last look
  std::vector<Ours> names_;                // parallel to it
  int others_ = 0;
  bool over_ = false;
  std::uint64_t last_number_ = 0;
  double started_s_ = -1e18;
  int failures_ = 0;                         // in a row
  double not_before_s_ = -1e18;              // no start
  std::map<std::string, std::string> said_;  // by topic
};

}  // namespace cairn::coordinator
