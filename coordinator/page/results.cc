#include "coordinator/page/results.h"

#include <algorithm>
#include <utility>

namespace cairn::page {
namespace {

namespace fs = std::filesystem;

// Another store gives the same ids.
std::string KeyOf(const ResultsOf& what) {
  return what.job + "/" + what.mark + "/" + std::to_string(what.stages_done);
}

std::string SoFarKey(const ResultsOf& what) { return what.job + "/" + what.mark + "/so far"; }

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
    : options_(std::move(options)),
      folder_(options_.folder),
      helper_(options_.program, folder_.path()),
      compares_(options_.program, folder_.path() / "compares") {
  fs::create_directory(folder_.path() / "compares");
}

ResultsCache::~ResultsCache() {
  helper_.End();
  compares_.End();
  errands_.Stop();
  comparing_.Stop();
}

// What is kept, or what `make` gives on the errands' thread: once for all who wait for it.
void ResultsCache::Await(Errands* errands, const std::string& key, const Make& make, const Then& then) {
  std::shared_ptr<const FetchedResults> here;
  bool refused = false;
  {
    const std::lock_guard lock(mutex_);
    if (const auto kept = kept_.find(key); kept != kept_.end() && kept->second->whole) {
      here = kept->second;
    } else {
      std::vector<Then>& waiting = awaited_[key];
      waiting.push_back(then);
      refused = waiting.size() == 1 && !errands->Add([this, key, make] { Do(key, make); });
      if (refused) awaited_.erase(key);
    }
  }
  if (here) then(*here);
  if (refused) then({.trouble = "Too many results are being fetched: try again soon."});
}

void ResultsCache::Fetch(const ResultsOf& what, Then then) {
  Await(
      &errands_, KeyOf(what), [this, job = what.job](const fs::path& folder) { return Bring(job, folder); },
      then);
}

// Both are fetched as all results are, and then laid beside each other where nobody waits who wants results.
void ResultsCache::Compare(const Compared& what, Then then) {
  const auto with = [then](const std::string& job, const std::function<void()>& next) {
    return [then, job, next](const FetchedResults& results) {
      if (results.trouble.empty()) return next();
      then({.folder = results.folder, .trouble = job + ": " + results.trouble});
    };
  };
  const auto compare = [this, what, then] {
    Await(
        &comparing_, "compare " + KeyOf(what.one) + " " + KeyOf(what.other) + " " + what.log.string(),
        [this, what](const fs::path& folder) { return MakeComparison(what, folder); }, then);
  };
  const auto fetch_other = [this, what, with, compare] { Fetch(what.other, with(what.other.job, compare)); };
  Fetch(what.one, with(what.one.job, fetch_other));
}

std::shared_ptr<const FetchedResults> ResultsCache::Fetched(const ResultsOf& what) {
  const std::lock_guard lock(mutex_);
  const auto kept = kept_.find(KeyOf(what));
  return kept == kept_.end() ? nullptr : kept->second;
}

std::shared_ptr<const FetchedResults> ResultsCache::SoFar(const wire::JobInfo& job) {
  const ResultsOf what = ResultsNow(job);
  const std::string key = SoFarKey(what);
  const std::string& version = job.so_far();
  const std::lock_guard lock(mutex_);
  if (running_.size() >= kMostKept && !running_.contains(key))
    std::erase_if(running_, [](const auto& of) { return !of.second.under_way; });
  OfRunning& of = running_[key];
  if (of.version != version && !of.under_way && std::chrono::steady_clock::now() >= of.not_before)
    of.under_way = errands_.Add([this, what, version] { BringSoFar(what, version); });
  const auto kept = kept_.find(key);
  return kept == kept_.end() ? nullptr : kept->second;
}

void ResultsCache::BringSoFar(const ResultsOf& what, const std::string& version) {
  constexpr int kShare = 4;
  const auto begin = std::chrono::steady_clock::now();
  fs::path folder;
  {
    const std::lock_guard lock(mutex_);
    folder = folder_.path() / std::to_string(++folders_);
  }
  const auto made = std::make_shared<const FetchedResults>(Bring(what.job, folder, {"--so-far"}));
  const std::lock_guard lock(mutex_);
  const auto end = std::chrono::steady_clock::now();
  OfRunning& of = running_[SoFarKey(what)];
  of = {.version = version, .under_way = false, .not_before = end + kShare * (end - begin)};
  std::error_code ignored;
  // What was there before stays where nothing came: the stage may just have ended.
  if (made->trouble.empty())
    Keep(SoFarKey(what), made);
  else
    fs::remove_all(folder, ignored);
}

void ResultsCache::Do(const std::string& key, const Make& make) {
  const std::shared_ptr<const FetchedResults> made = Made(key, make);
  std::vector<Then> waiting;
  {
    const std::lock_guard lock(mutex_);
    waiting = std::move(awaited_[key]);
    awaited_.erase(key);
  }
  for (const Then& then : waiting) then(*made);
}

std::shared_ptr<const FetchedResults> ResultsCache::Made(const std::string& key, const Make& make) {
  fs::path folder;
  {
    const std::lock_guard lock(mutex_);
    if (const auto kept = kept_.find(key); kept != kept_.end() && kept->second->whole) return kept->second;
    folder = folder_.path() / std::to_string(++folders_);
  }
  const auto made = std::make_shared<const FetchedResults>(make(folder));
  const std::lock_guard lock(mutex_);
  std::error_code ignored;
  if (made->trouble.empty())
    Keep(key, made);
  else
    fs::remove_all(folder, ignored);
  return made;
}

// What came although not all did is shown.
FetchedResults ResultsCache::Bring(const std::string& job, const fs::path& folder,
                                   const std::vector<std::string>& more) {
  std::vector<std::string> words = {"results", "--out", folder.string()};
  words.insert(words.end(), options_.service.begin(), options_.service.end());
  words.insert(words.end(), more.begin(), more.end());
  words.insert(words.end(), {"--", job});
  const std::string trouble = helper_.Run(words, options_.fetching).trouble;
  FetchedResults fetched = LookInto(folder);
  fetched.whole = trouble.empty();
  if (fetched.files.stages.empty())
    fetched.trouble =
        trouble.empty() ? "There is no result yet." : "The results could not be fetched: " + trouble;
  return fetched;
}

// As it stays whatever becomes of what is kept meanwhile. False: it is not kept any more.
bool ResultsCache::LayInto(const fs::path& folder, const ResultsOf& what) {
  const std::lock_guard lock(mutex_);
  const auto kept = kept_.find(KeyOf(what));
  if (kept == kept_.end()) return false;
  std::error_code error;
  fs::copy(kept->second->folder, folder / what.job,
           fs::copy_options::create_hard_links | fs::copy_options::recursive, error);
  return !error;
}

// The page calls them as their folders are called, which are therefore called as the jobs.
FetchedResults ResultsCache::MakeComparison(const Compared& what, const fs::path& folder) {
  std::error_code error;
  fs::create_directory(folder, error);
  const std::string &one = what.one.job, &other = what.other.job;
  if (!LayInto(folder, what.one) || (other != one && !LayInto(folder, what.other)))
    return {.folder = folder, .trouble = "These two cannot be laid beside each other here: try again."};
  std::vector<std::string> words = {"report", "--out=" + std::string(kComparison), "--beside=" + other};
  if (!what.log.empty()) words.push_back("--log=" + what.log.string());
  words.insert(words.end(), {"--", one});
  const std::string trouble = compares_.Run(words, options_.comparing, folder).trouble;
  for (const std::string& job : {one, other}) fs::remove_all(folder / job, error);
  return {.folder = folder, .trouble = trouble.empty() ? "" : "They cannot be compared: " + trouble};
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

}  // namespace cairn::page
