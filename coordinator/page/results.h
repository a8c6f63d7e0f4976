// Results of jobs, by their ids and marks, in a folder of the page's own: `cairn results` fetches them and
// makes the report and the pictures, in a process of its own, so that nothing of what a result holds is read
// in this one.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "coordinator/page/errands.h"
#include "coordinator/page/helper.h"
#include "coordinator/page/source.h"

namespace cairn::page {

struct ResultsOptions {
  std::string program;               // the path of `cairn`
  std::vector<std::string> service;  // its options that say which coordinator: --connect …
  std::filesystem::path
      folder;  // for the cache: a folder that nobody else may enter; what earlier processes left there goes
  Most fetching{.time_s = 600};
  Most comparing{.time_s = 60, .memory_bytes = std::uint64_t{4} << 30};
};

class ResultsCache {
 public:
  using Then = std::function<void(const FetchedResults&)>;
  static constexpr std::size_t kMostKept = 20;

  explicit ResultsCache(ResultsOptions options);
  ~ResultsCache();
  ResultsCache(const ResultsCache&) = delete;
  ResultsCache& operator=(const ResultsCache&) = delete;

  void Fetch(const ResultsOf& what, Then then);
  // `folder` holds the page, kComparison.
  void Compare(const Compared& what, Then then);
  std::shared_ptr<const FetchedResults> Fetched(const ResultsOf& what);
  // What came last of the map of the stage under way, null: nothing yet. Another version is fetched in its
  // place, but so that no more than a part of the time goes there.
  std::shared_ptr<const FetchedResults> SoFar(const wire::JobInfo& job);

 private:
  // In that folder, which goes again where there is trouble.
  using Make = std::function<FetchedResults(const std::filesystem::path& folder)>;

  void Await(Errands* errands, const std::string& key, const Make& make, const Then& then);
  void Do(const std::string& key, const Make& make);
  std::shared_ptr<const FetchedResults> Made(const std::string& key, const Make& make);
  FetchedResults Bring(const std::string& job, const std::filesystem::path& folder,
                       const std::vector<std::string>& more = {});
  void BringSoFar(const ResultsOf& what, const std::string& version);
  FetchedResults MakeComparison(const Compared& what, const std::filesystem::path& folder);
  bool LayInto(const std::filesystem::path& folder, const ResultsOf& what);
  void Keep(const std::string& key, const std::shared_ptr<const FetchedResults>& fetched);

  ResultsOptions options_;
  OwnFolder folder_;
  Helper helper_, compares_;

  std::mutex mutex_;  // of all below
  std::map<std::string, std::shared_ptr<const FetchedResults>> kept_;
  std::deque<std::string> order_;  // of those kept, the oldest first
  std::map<std::string, std::vector<Then>> awaited_;
  std::uint64_t folders_ = 0;
  struct OfRunning {
    std::string version;  // that was asked for last
    bool under_way = false;
    std::chrono::steady_clock::time_point not_before = {};
  };
  std::map<std::string, OfRunning> running_;  // by SoFarKey, jobs of which a map so far was asked for

  Errands errands_{32}, comparing_{32};  // the last to begin, the first to end
};

}  // namespace cairn::page
