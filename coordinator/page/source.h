// Where the pages have their facts from, and what they have done: the coordinator, asked once for all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "coordinator/page/facts.h"
#include "coordinator/page/views.h"

namespace cairn::page {

// Results of a job on this machine, or why there are none.
struct FetchedResults {
  std::filesystem::path folder = {};
  ResultFiles files = {};
  std::string picture = {};  // "map.png"; empty: there is none
  std::string trouble = {};  // a sentence; empty: they are here
  bool whole = true;         // all of them came: else they are fetched anew when somebody looks again
};

// A job's results, as they are with so many stages done.
struct ResultsOf {
  std::string job, mark;
  std::uint32_t stages_done = 0;
};
inline ResultsOf ResultsNow(const wire::JobInfo& job) { return {job.id(), job.mark(), StagesDone(job)}; }

// Two jobs whose results are shown beside each other; `log`: what they were made of, by whose truth they are
// scored; empty: they are not.
struct Compared {
  ResultsOf one, other;
  std::filesystem::path log = {};
};
inline constexpr const char* kComparison = "comparison.html";

// Whether a job did what it was told, and what to say of that.
struct CommandOutcome {
  bool ok = false;
  std::string text;
};

// All may be called from any thread, and wait for nobody; `then` is called on another thread, or this one.
class Source {
 public:
  virtual ~Source() = default;

  virtual FactsPtr Latest() = 0;
  virtual HistoryPtr HistoryOf(const wire::JobInfo& job) = 0;  // null: not known
  // Somebody looks on, at that job where one is named: for the next seconds it is kept up to date. `then`,
  // where there is one, is called once facts (and history) are no older than a second, or nobody answers.
  virtual void Look(const std::string& job, std::function<void()> then) = 0;
  virtual void Command(const std::string& job, const std::string& action, int priority,
                       std::function<void(const CommandOutcome&)> then) = 0;
  // Fetches them where they are not here yet.
  virtual void FetchResults(const ResultsOf& what, std::function<void(const FetchedResults&)> then) = 0;
  // Fetches both where they are not here yet.
  virtual void Compare(const Compared& what, std::function<void(const FetchedResults&)> then) = 0;
  // Those that are here; null: none.
  virtual std::shared_ptr<const FetchedResults> Fetched(const ResultsOf& what) = 0;
  // The map of the stage under way that came last, null: none yet; by and by the one that there is now.
  virtual std::shared_ptr<const FetchedResults> SoFar(const wire::JobInfo& job) = 0;
};

}  // namespace cairn::page
