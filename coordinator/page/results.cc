#include "coordinator/page/results.h"

#include <algorithm>
#include <utility>

namespace cairn::page {
namespace {

namespace fs = std::filesystem;

std::string KeyOf(const std::string& job, std::uint32_t stages_done) {
  return job + "/" + std::to_string(stages_done);
}

FetchedResults LookInto(const fs::path& folder) {
  FetchedResults fetched{.folder = folder};
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == ".h5") fetched.files.stages.push_back(it->path().stem().string());
  std::ranges::sort(fetched.files.stages);
  fetched.files.has_report = fs::exists(folder / "report.html", error);
  for (const char* picture : {"map.png", "picture.png"})
    if (fetched.picture.empty() && fs::exists(folder / picture, error)) fetched.picture = picture;
  return fetched;
}

}  // namespace

ResultsCache::ResultsCache(ResultsOptions options)
    : options_(std::move(options)), folder_(options_.folder), helper_(options_.program, folder_.path()) {}

ResultsCache::~ResultsCache() {
  helper_.End();
  errands_.Stop();
}

void ResultsCache::Fetch(const std::string& job, std::uint32_t stages_done, Then then) {
  const std::string key = KeyOf(job, stages_done);
  std::shared_ptr<const FetchedResults> here;
  bool refused = false;
  {
    const std::lock_guard lock(mutex_);
    if (const auto kept = kept_.find(key); kept != kept_.end() && kept->second->whole) {
      here = kept->second;
    } else {
      std::vector<Then>& waiting = awaited_[key];
      waiting.push_back(then);
      refused = waiting.size() == 1 && !errands_.Add([this, key, job] { Do(key, job); });
      if (refused) awaited_.erase(key);
    }
  }
  if (here) then(*here);
  if (refused) then({.trouble = "Too many results are being fetched: try again soon."});
}

std::shared_ptr<const FetchedResults> ResultsCache::Fetched(const std::string& job,
                                                            std::uint32_t stages_done) {
  const std::lock_guard lock(mutex_);
  const auto kept = kept_.find(KeyOf(job, stages_done));
  return kept == kept_.end() ? nullptr : kept->second;
}

void ResultsCache::Do(const std::string& key, const std::string& job) {
  fs::path folder;
  {
    const std::lock_guard lock(mutex_);
    folder = folder_.path() / std::to_string(++folders_);
  }
  const std::string trouble = Run(job, folder);
  auto fetched = std::make_shared<FetchedResults>(LookInto(folder));
  // What came although not all did is shown.
  fetched->whole = trouble.empty();
  if (fetched->files.stages.empty()) fetched->trouble = trouble.empty() ? "There is no result yet." : trouble;
  std::vector<Then> waiting;
  {
    const std::lock_guard lock(mutex_);
    std::error_code ignored;
    if (fetched->whole || !fetched->files.stages.empty())
      Keep(key, fetched);
    else
      fs::remove_all(folder, ignored);
    waiting = std::move(awaited_[key]);
    awaited_.erase(key);
  }
  for (const Then& then : waiting) then(*fetched);
}

void ResultsCache::Keep(const std::string& key, const std::shared_ptr<const FetchedResults>& fetched) {
  std::error_code ignored;
  if (const auto before = kept_.find(key); before != kept_.end())
    fs::remove_all(before->second->folder, ignored);
  else
    order_.push_back(key);
  kept_[key] = fetched;
  while (order_.size() > kMostKept) {
    fs::remove_all(kept_[order_.front()]->folder, ignored);
    kept_.erase(order_.front());
    order_.pop_front();
  }
}

// Why it failed; empty: it did not.
std::string ResultsCache::Run(const std::string& job, const fs::path& folder) {
  std::vector<std::string> words = {"results", "--out", folder.string()};
  words.insert(words.end(), options_.service.begin(), options_.service.end());
  words.insert(words.end(), {"--", job});
  const std::string trouble = helper_.Run(words).trouble;
  return trouble.empty() ? "" : "The results could not be fetched: " + trouble;
}

}  // namespace cairn::page
