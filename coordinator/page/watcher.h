// Asks the coordinator, while somebody looks on: once for all of them.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "coordinator/client.h"
#include "coordinator/page/errands.h"
#include "coordinator/page/results.h"
#include "coordinator/page/source.h"

namespace cairn::page {

struct WatcherOptions {
  coordinator::ClientOptions client;
  std::string unanswered = {};  // what is said where the coordinator does not answer; empty: that, and why
  double least_s = 0.25;        // between two questions
  double share = 20;  // of the time that an answer takes, at the least: so that no more than a part of the
                      // coordinator's goes here
  double looked_at_s = 3;  // after who looked on last
  double unseen_s = 10;    // between two questions for all jobs, while all who look on look at one of them
  ResultsOptions results;
};

class Watcher : public Source {
 public:
  // `changed`: called, on a thread of its own, whenever facts are new.
  // Throws InputError where there can be no such endpoint.
  Watcher(WatcherOptions options, std::function<void()> changed);
  ~Watcher() override;

  FactsPtr Latest() override;
  HistoryPtr HistoryOf(const wire::JobInfo& job) override;
  void Look(const std::string& job, std::function<void()> then) override;
  void Command(const std::string& job, const std::string& action, int priority,
               std::function<void(const CommandOutcome&)> then) override;
  void FetchResults(const ResultsOf& what, std::function<void(const FetchedResults&)> then) override {
    results_.Fetch(what, std::move(then));
  }
  void Compare(const Compared& what, std::function<void(const FetchedResults&)> then) override {
    results_.Compare(what, std::move(then));
  }
  std::shared_ptr<const FetchedResults> Fetched(const ResultsOf& what) override {
    return results_.Fetched(what);
  }
  std::shared_ptr<const FetchedResults> SoFar(const wire::JobInfo& job) override {
    return results_.SoFar(job);
  }

 private:
  struct LookedAt {
    double at_s = 0;
    double answered_s = -1e9;  // when it was asked for last
    HistoryPtr history = nullptr;
    std::string mark = {};  // of the job whose history that is
  };
  // When something is asked again: the longer it took, the later.
  struct Due {
    double at_s = -1e9;
  };

  void Run();
  double NextAt_s() const;
  Status Reach();
  FactsPtr Ask(bool all);
  Status AskForList(Facts* facts);
  Status AskForFleet(Facts* facts);
  Status AskForJobs(Facts* facts);
  Result<coordinator::LogPart> AskForLog(const std::string& job, LookedAt* known);
  void SetDue(Due* due, double begin_s, double least_s) const;
  bool IsFresh(const std::string& job, double now_s) const;

  WatcherOptions options_;
  std::function<void()> changed_;
  std::optional<coordinator::Client> asks_;  // while somebody looks on
  FleetTimes times_;
  Due list_, fleet_, looked_;  // of the thread that asks

  std::mutex mutex_;  // of all below
  std::condition_variable woken_;
  bool ending_ = false;
  bool soon_ = false, soon_jobs_ = false;  // all is asked for now; or the jobs that somebody looks at
  FactsPtr facts_ = std::make_shared<Facts>();
  double answered_s_ = -1e9, tried_s_ = -1e9, looked_s_ = -1e9, list_looked_s_ = -1e9;
  std::map<std::string, LookedAt> jobs_;  // that somebody looks at
  std::vector<std::function<void()>> waiting_;

  ResultsCache results_;
  Errands errands_{64};
  std::thread thread_;  // the last to begin
};

// What to say where the coordinator did not answer so.
std::string TroubleText(const Status& status);

}  // namespace cairn::page
