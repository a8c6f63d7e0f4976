#include "coordinator/page/results.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <future>
#include <thread>

#include "coordinator/page/testing/script.h"

namespace cairn::page {
namespace {

namespace fs = std::filesystem;

class ResultsTest : public ::testing::Test {
 protected:
  // `does`: in the folder of the results, as $OUT.
  void Make(const std::string& does) {
    script_.Does("OUT=$3\n" + does);
    cache_ = std::make_unique<ResultsCache>(ResultsOptions{
        .program = script_.program(), .service = {"--connect=ipc:///x/y"}, .folder = base_ / "cache"});
  }
  FetchedResults Fetch(const std::string& job, std::uint32_t stages = 1, const std::string& mark = "") {
    std::promise<FetchedResults> promise;
    cache_->Fetch({job, mark, stages}, [&](const FetchedResults& fetched) { promise.set_value(fetched); });
    return promise.get_future().get();
  }
  std::string Words() const { return script_.Words(); }

  Script script_;
  const fs::path base_ = script_.base();
  std::unique_ptr<ResultsCache> cache_;
};

wire::JobInfo Running(const std::string& so_far, const std::string& mark = "") {
  wire::JobInfo job;
  job.set_id("1-a");
  job.set_mark(mark);
  job.set_stages(1);
  job.set_so_far(so_far);
  return job;
}

constexpr const char* kLeavesResults =
    "mkdir -p \"$OUT\" && cd \"$OUT\" && touch b.h5 a.h5 report.html picture.png";

TEST_F(ResultsTest, AreFetchedOnceAJobAndStage) {
  Make(kLeavesResults);
  EXPECT_EQ(cache_->Fetched({"1-a", "", 1}), nullptr);
  const FetchedResults fetched = Fetch("1-a");
  EXPECT_EQ(fetched.trouble, "");
  EXPECT_EQ(fetched.files.stages, (std::vector<std::string>{"a", "b"}));
  EXPECT_TRUE(fetched.files.has_report);
  EXPECT_EQ(fetched.picture, "picture.png");
  EXPECT_TRUE(fs::exists(fetched.folder / "report.html"));
  EXPECT_EQ(Fetch("1-a").folder, fetched.folder);
  ASSERT_NE(cache_->Fetched({"1-a", "", 1}), nullptr);
  EXPECT_NE(Fetch("1-a", 2).folder, fetched.folder) << "another stage is done";
  const std::string words = Words();
  EXPECT_EQ(std::count(words.begin(), words.end(), '\n'), 2) << words;
  EXPECT_TRUE(words.starts_with("results --out ")) << words;
  EXPECT_NE(words.find(" --connect=ipc:///x/y -- 1-a\n"), std::string::npos)
      << "an id is never taken for an option";
}

// After `cairn restore`, or in a new store, another job has the id of one whose results are here.
TEST_F(ResultsTest, OfAnotherJobWithTheSameIdAreFetchedAnew) {
  Make(kLeavesResults);
  const FetchedResults first = Fetch("1-a", 1, "one");
  EXPECT_EQ(cache_->Fetched({"1-a", "two", 1}), nullptr);
  const FetchedResults second = Fetch("1-a", 1, "two");
  EXPECT_NE(second.folder, first.folder);
  EXPECT_EQ(Fetch("1-a", 1, "one").folder, first.folder);
  const auto until_there_is = [this](const std::string& mark) {
    for (;; std::this_thread::yield())
      if (const auto map = cache_->SoFar(Running("so", mark))) return map->folder;
  };
  const fs::path map = until_there_is("one");
  EXPECT_EQ(cache_->SoFar(Running("so", "two")), nullptr);
  EXPECT_NE(until_there_is("two"), map);
}

TEST_F(ResultsTest, WhyThereAreNoneIsASentenceAndItIsTriedAgain) {
  Make("echo 'cairn: job 1-a has no results yet' >&2; exit 2");
  EXPECT_EQ(Fetch("1-a").trouble, "The results could not be fetched: job 1-a has no results yet");
  EXPECT_EQ(cache_->Fetched({"1-a", "", 1}), nullptr);
  Make(kLeavesResults);
  EXPECT_EQ(Fetch("1-a").trouble, "");
  fs::remove(base_ / "cairn");
  EXPECT_NE(Fetch("2-b").trouble, "");
}

TEST_F(ResultsTest, WhatCameThoughNotAllDidIsShownAndFetchedAnewInItsPlace) {
  Make(std::string(kLeavesResults) + "; exit 2");
  const FetchedResults first = Fetch("1-a");
  EXPECT_EQ(first.files.stages.size(), 2u);
  const FetchedResults second = Fetch("1-a");
  EXPECT_NE(second.folder, first.folder);
  EXPECT_FALSE(fs::exists(first.folder)) << "a look more must not take more of the disk";
  EXPECT_TRUE(fs::exists(second.folder));
}

// What is there stays until another is there, which takes its place; one that fails takes nobody's.
TEST_F(ResultsTest, OfAJobThatRunsTheLatestMapIsKept) {
  Make(kLeavesResults);
  const auto until = [&](const std::string& version, const fs::path& but) {
    for (;;) {
      const auto map = cache_->SoFar(Running(version));
      if (map && map->folder != but) return *map;
      std::this_thread::yield();
    }
  };
  EXPECT_EQ(cache_->SoFar(Running("one")), nullptr);
  const FetchedResults first = until("one", "");
  EXPECT_TRUE(first.files.has_report);
  EXPECT_NE(Words().find(" --so-far -- 1-a\n"), std::string::npos) << Words();
  const FetchedResults second = until("two", first.folder);
  EXPECT_FALSE(fs::exists(first.folder));
  EXPECT_TRUE(fs::exists(second.folder));
  script_.Forget();
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(cache_->SoFar(Running("two"))->folder, second.folder);
  EXPECT_EQ(Words(), "") << "it is here";
  script_.Does("exit 2");
  while (Words().empty()) EXPECT_EQ(cache_->SoFar(Running("three"))->folder, second.folder);
  EXPECT_EQ(cache_->SoFar(Running("three"))->folder, second.folder);
}

TEST_F(ResultsTest, OfManyJobsTheLatestAreKept) {
  Make(kLeavesResults);
  const FetchedResults first = Fetch("0-a");
  for (std::size_t i = 1; i <= ResultsCache::kMostKept; ++i) Fetch(std::to_string(i) + "-a");
  EXPECT_EQ(cache_->Fetched({"0-a", "", 1}), nullptr);
  EXPECT_FALSE(fs::exists(first.folder));
  EXPECT_NE(cache_->Fetched({"1-a", "", 1}), nullptr);
}

TEST_F(ResultsTest, TwoAreLaidBesideEachOtherUnderTheirJobsNames) {
  const auto compare = [this](const Compared& what) {
    std::promise<FetchedResults> promise;
    cache_->Compare(what, [&](const FetchedResults& made) { promise.set_value(made); });
    return promise.get_future().get();
  };
  Make(std::string("case $1 in report) test -e 1-a/a.h5 && test -e 2-b/a.h5 && echo page >comparison.html;; "
                   "*) ") +
       kLeavesResults + ";; esac");
  const FetchedResults made = compare({{"1-a", "", 1}, {"2-b", "", 2}, "/brought/3/log.h5"});
  EXPECT_EQ(made.trouble, "");
  EXPECT_TRUE(fs::exists(made.folder / kComparison));
  EXPECT_NE(Words().find("report --out=comparison.html --beside=2-b --log=/brought/3/log.h5 -- 1-a\n"),
            std::string::npos)
      << Words();
  EXPECT_EQ(compare({{"1-a", "", 1}, {"2-b", "", 2}, "/brought/3/log.h5"}).folder, made.folder);
  EXPECT_EQ(Fetch("1-a").folder, cache_->Fetched({"1-a", "", 1})->folder)
      << "each was fetched once, and is kept";
  const std::string words = Words();
  EXPECT_EQ(std::count(words.begin(), words.end(), '\n'), 3) << words;
  Make("case $1 in report) echo 'cairn: no result is of the kind' >&2; exit 2;; *) " +
       std::string(kLeavesResults) + ";; esac");
  EXPECT_EQ(compare({{"1-a", "", 1}, {"2-b", "", 1}}).trouble,
            "They cannot be compared: no result is of the kind");
  Make("echo 'cairn: there is no job' >&2; exit 2");
  EXPECT_EQ(compare({{"1-a", "", 1}, {"2-b", "", 1}}).trouble,
            "1-a: The results could not be fetched: there is no job");
}

TEST_F(ResultsTest, AComparisonThatTakesLongKeepsNobodyFromResultsAndIsEnded) {
  Make(std::string("for JOB; do :; done; if [ $1 = report ]; then "
                   "ulimit -v >\"$BASE/memory\"; until [ -e \"$BASE/fetched\" ]; do sleep 0.01; done; "
                   "echo page >comparison.html; [ ! -e \"$BASE/hangs\" ] || exec sleep 3600; else ") +
       "[ $JOB != 3-c ] || : >\"$BASE/fetched\"; " + kLeavesResults + "; fi");
  std::promise<FetchedResults> made;
  cache_->Compare({{"1-a", "", 1}, {"2-b", "", 1}},
                  [&](const FetchedResults& results) { made.set_value(results); });
  EXPECT_EQ(Fetch("3-c").trouble, "");  // else both would wait for each other
  EXPECT_EQ(made.get_future().get().trouble, "");
#ifndef CAIRN_SANITIZED
  EXPECT_EQ(script_.Said("memory"), "4194304\n");
#endif
  std::ofstream(base_ / "hangs") << "";
  cache_ = std::make_unique<ResultsCache>(ResultsOptions{
      .program = script_.program(), .service = {}, .folder = base_ / "cache", .comparing = {.time_s = 0.2}});
  std::promise<FetchedResults> ended;
  cache_->Compare({{"1-a", "", 1}, {"2-b", "", 1}},
                  [&](const FetchedResults& results) { ended.set_value(results); });
  EXPECT_EQ(ended.get_future().get().trouble, "They cannot be compared: it took too long, and was ended");
}

TEST_F(ResultsTest, AFetchThatHangsIsEnded) {
  script_.Does("exec sleep 3600");
  cache_ = std::make_unique<ResultsCache>(ResultsOptions{
      .program = script_.program(), .service = {}, .folder = base_ / "cache", .fetching = {.time_s = 0.2}});
  EXPECT_EQ(Fetch("1-a").trouble, "The results could not be fetched: it took too long, and was ended");
}

TEST_F(ResultsTest, TheFolderGoesWithItsProcessAndWithTheNextWhereItWasKilled) {
  Make(kLeavesResults);
  const fs::path old = base_ / "cache" / "killed";
  fs::create_directories(old / "1");
  const fs::path folder = Fetch("1-a").folder;
  auto second = std::make_unique<ResultsCache>(
      ResultsOptions{.program = (base_ / "cairn").string(), .service = {}, .folder = base_ / "cache"});
  EXPECT_FALSE(fs::exists(old));
  EXPECT_TRUE(fs::exists(folder)) << "of a process that lives it stays";
  second.reset();
  cache_.reset();
  EXPECT_TRUE(fs::is_empty(base_ / "cache"));
}

TEST_F(ResultsTest, EndsThoughAFetchHangs) {
  Make("exec sleep 3600");
  std::promise<void> ended;
  cache_->Fetch({"1-a", "", 1}, [&](const FetchedResults&) { ended.set_value(); });
  while (Words().empty()) std::this_thread::yield();
  cache_.reset();
  ended.get_future().get();
}

}  // namespace
}  // namespace cairn::page
