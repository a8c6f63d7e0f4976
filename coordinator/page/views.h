// The pages as HTML, in parts: what changes is sent again part by part. Pure functions of what is known.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/page/facts.h"

namespace cairn::page {

// The id of an element and what is in it, in the order of the page.
using Parts = std::vector<std::pair<std::string, std::string>>;

// Which page, as its address says it.
struct View {
  enum class Kind { kJobs, kWorkers, kJob };
  Kind kind = Kind::kJobs;
  std::string job = {};     // of kJob
  std::string search = {};  // of kJobs: in ids and names
  std::string state = {};   // of kJobs: "", a state, or "active"
  std::uint64_t page = 1;   // of kJobs

  // "/?q=hall&page=2"
  std::string Address() const;
};

// What is known of the results of a job that were fetched.
struct ResultFiles {
  std::vector<std::string> stages;  // STAGE.h5 of each
  bool has_report = false;
};

struct ViewContext {
  Facts const& facts;
  HistoryPtr history = nullptr;          // of the job
  const ResultFiles* results = nullptr;  // null: not fetched yet
  std::string so_far = {};  // by which its map so far is told from earlier ones; empty: there is none
  bool may_command = true;
  bool may_start = false;                                         // jobs
  std::vector<std::pair<std::string, std::string>> brought = {};  // logs and samples: number and name
};

inline constexpr std::uint64_t kJobsOnAPage = 50;

Parts PartsOf(const View& view, const ViewContext& context);
// The form above the jobs, which is no part: what is being typed is not replaced.
std::string FilterForm(const View& view);
std::string TitleOf(const View& view, const Facts& facts);

// A whole page. `events`: where the script hears of changes; empty: it does not.
std::string Page(const std::string& title, const std::string& main, const std::string& notice,
                 const std::string& events, const std::string& foot);
// The parts as elements.
std::string PartsHtml(const Parts& parts);

}  // namespace cairn::page
