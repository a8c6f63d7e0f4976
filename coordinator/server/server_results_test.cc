// Results on their way to those who ask for them: read once, in memory once, and no more than a bound.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "coordinator/server/testing/rights_fixture.h"

namespace cairn::coordinator {
namespace {

using wire::RefusalKind;

class ServerResults : public RightsFixture {
 protected:
  // A job that is done.
  void Run(const std::string& id = "a", std::uint64_t seed = 0) {
    proto::Job job = fixture_.MakeJob();
    job.set_seed(seed);
    fixture_.server->Submit(id, job, {TextBlob("the log")});
    if (fixture_.server->core().fleet().size() == 0) Join("w", worker_, 1);
    fixture_.Until([&] { return fixture_.State(id) == "done" && !fixture_.server->core().HasUnsaved(); });
    fixture_.transport.sent.clear();
  }
  void Come(const std::string& peer, const std::string& job = "a") {
    fixture_.transport.Come(peer, Query("results", job), viewer_);
  }
  // The message that `peer` was sent last; none.
  std::optional<wire::Message> SentTo(const std::string& peer) const {
    for (auto it = fixture_.transport.sent.rbegin(); it != fixture_.transport.sent.rend(); ++it)
      if (it->first == peer) return it->second;
    return std::nullopt;
  }
  std::filesystem::path FileOf(const std::string& job) const {
    return fixture_.temp.path() / "results" / job / "stage0.h5";
  }
};

TEST_F(ServerResults, AreInMemoryOnceHoweverManyTheyAreOnTheirWayTo) {
  Run();
  for (const char* peer : {"one", "two", "three"}) Come(peer);
  fixture_.Until([&] { return SentTo("one").has_value(); });
  const auto bytes_of = [](const wire::Message& message) {
    return message.blobs.at(0).blob->at("text").bytes().data();
  };
  ASSERT_TRUE(SentTo("two") && SentTo("three")) << "in one turn, for they are read once";
  EXPECT_EQ(bytes_of(*SentTo("one")), bytes_of(*SentTo("two")));
  EXPECT_EQ(bytes_of(*SentTo("one")), bytes_of(*SentTo("three")));
  const Array kept = SentTo("one")->blobs.at(0).blob->at("text");  // as a frame keeps it
  fixture_.transport.sent.clear();
  Come("one");
  fixture_.server->Step(0);
  ASSERT_TRUE(SentTo("one")) << "at once: nothing is to be read";
  EXPECT_EQ(bytes_of(*SentTo("one")), kept.bytes().data());
  EXPECT_EQ(SentTo("one")->blobs.at(0).hash, SentTo("one")->blobs.at(0).blob->ContentHash());
}

// The writing thread has not even begun to read them.
TEST_F(ServerResults, WhileTheyAreReadOthersAreServedAndTheFleetIsHeard) {
  Run();
  std::unique_lock stopped(fixture_.transport.wake);
  fixture_.transport.Come("who stops it", Query("logs"), viewer_);
  fixture_.server->Step(0);
  for (const char* peer : {"one", "two", "one"}) Come(peer);
  fixture_.transport.Come("other", Query("status"), viewer_);
  Join("another", other_, 2);
  for (int turn = 0; turn < 100; ++turn) fixture_.server->Step(0);
  EXPECT_TRUE(SentTo("other"));
  EXPECT_TRUE(Connected("another"));
  EXPECT_FALSE(SentTo("one") || SentTo("two"));
  stopped.unlock();
  fixture_.Until([&] { return SentTo("one") && SentTo("two"); });
  EXPECT_EQ(SentTo("one")->blobs.size(), 1U);
  EXPECT_EQ(SentTo("two")->blobs.size(), 1U);
  const auto answers = [&](const std::string& peer) {
    return std::ranges::count(fixture_.transport.sent, peer, &std::pair<std::string, wire::Message>::first);
  };
  EXPECT_EQ(answers("one"), 1) << "asked twice, answered once";
}

TEST_F(ServerResults, OfSeveralJobsAreAllAnsweredEachWithItsOwn) {
  const std::vector<std::string> jobs = {"a", "b", "c"};
  for (std::size_t i = 0; i < jobs.size(); ++i) Run(jobs[i], i);
  for (const std::string& job : jobs) Come("peer of " + job, job);
  for (const std::string& job : jobs) {
    const std::string peer = "peer of " + job;
    fixture_.Until([&] { return SentTo(peer).has_value(); });
    ASSERT_EQ(SentTo(peer)->blobs.size(), 1U);
    EXPECT_EQ(SentTo(peer)->envelope.reply().jobs(0).id(), job);
  }
}

TEST_F(ServerResults, OfAllTogetherNoMoreIsOnItsWayThanABoundAndOfOneKeyAQuarterOfIt) {
  const std::string admin = wire::GenerateKeyPair().public_key;
  Allow(worker_ + " worker\n" + submitter_ + " submitter\n" + viewer_ + " viewer\n" + admin + " admin\n");
  Run();
  Run("b", 1);
  Run("c", 2);
  constexpr std::size_t kAll = std::size_t{256} << 20;
  const auto ask = [&](const std::string& user, const std::string& peer, const std::string& job) {
    const std::uint64_t before = Count(RefusalKind::kQuota);
    fixture_.transport.sent.clear();
    fixture_.transport.Come(peer, Query("results", job), user);
    fixture_.Until([&] { return SentTo(peer).has_value(); });
    const wire::Reply reply = SentTo(peer)->envelope.reply();
    EXPECT_EQ(reply.ok(), SentTo(peer)->blobs.size() == 1);
    EXPECT_EQ(reply.unable(), !reply.ok());
    EXPECT_EQ(Count(RefusalKind::kQuota), before + (reply.ok() ? 0 : 1));
    return reply.message();
  };
  fixture_.transport.deaf = {"first", "admin's"};
  ASSERT_EQ(ask(submitter_, "first", "a"), "");
  fixture_.transport.unsent["first"] = kAll / 4;
  EXPECT_NE(ask(submitter_, "second", "b").find("try again when they are there"), std::string::npos);
  EXPECT_EQ(ask(viewer_, "viewer's", "b"), "") << "another's";
  fixture_.transport.unsent["first"] = kAll;
  EXPECT_NE(ask(viewer_, "viewer's", "b").find("those who asked before; try again"), std::string::npos);
  EXPECT_EQ(ask(viewer_, "viewer's", "a"), "") << "of the same there is one copy";
  EXPECT_TRUE(Ask(viewer_, Query("status")).reply().ok());
  EXPECT_EQ(ask(admin, "admin's", "b"), "") << "whatever others leave unread";
  fixture_.transport.unsent["admin's"] = kAll;
  EXPECT_NE(ask(admin, "second of admin's", "c"), "") << "that has a bound, too";
  fixture_.transport.unsent.clear();
  EXPECT_EQ(ask(viewer_, "viewer's", "b"), "");
}

// Answers without blobs are made for each question, and are long where there are many jobs.
TEST_F(ServerResults, WhoAsksAndDoesNotReadTheAnswersIsGivenNoMoreOfThem) {
  Run();
  constexpr std::size_t kAll = std::size_t{256} << 20;
  auto& transport = fixture_.transport;
  const auto ask = [&](const std::string& user, const std::string& peer) -> std::optional<wire::Reply> {
    transport.sent.clear();
    transport.Come(peer, Query("status"), user);
    transport.Come("after it", Query("status"), submitter_);
    fixture_.Until([&] { return SentTo("after it").has_value(); });
    const auto answer = SentTo(peer);
    return answer ? std::optional(answer->envelope.reply()) : std::nullopt;
  };
  transport.deaf = {"one"};
  transport.unsent["one"] = 1000;
  EXPECT_TRUE(ask(viewer_, "one")->ok());
  EXPECT_TRUE(ask(viewer_, "one")->ok()) << "little is unread";
  transport.unsent["one"] = 1 << 20;
  EXPECT_FALSE(ask(viewer_, "one")) << "it asks again when it has read";
  EXPECT_TRUE(ask(viewer_, "two")->ok());
  transport.unsent["one"] = kAll / 8 + 1;
  const auto refused = ask(viewer_, "two");
  EXPECT_TRUE(refused->unable());
  EXPECT_NE(refused->message().find("are not read yet"), std::string::npos) << refused->message();
  EXPECT_TRUE(ask(submitter_, "another")->ok());
  transport.unsent.clear();
  EXPECT_TRUE(ask(viewer_, "one")->ok());
}

TEST_F(ServerResults, WhoReadsNothingOfThemLosesHisConnection) {
  fixture_.stalled_s = 0.05;
  fixture_.Start();
  Run();
  fixture_.transport.deaf = {"deaf"};
  Come("deaf");
  Come("other");
  fixture_.Until([&] { return fixture_.transport.dropped.contains("deaf"); });
  EXPECT_EQ(fixture_.transport.dropped, std::set<std::string>{"deaf"});
  EXPECT_EQ(Count(RefusalKind::kQuota), 1U);
}

TEST_F(ServerResults, AFileThatHasChangedMeanwhileIsReadAnew) {
  Run();
  Come("one");
  fixture_.Until([&] { return SentTo("one").has_value(); });
  std::filesystem::resize_file(FileOf("a"), 1000);
  const wire::Reply damaged = Ask(viewer_, Query("results")).reply();
  EXPECT_EQ(damaged.names_size(), 0);
  EXPECT_NE(damaged.message().find("the stage 'stage0'"), std::string::npos) << damaged.message();
  std::filesystem::remove(FileOf("a"));
  const wire::Reply gone = Ask(viewer_, Query("results")).reply();
  EXPECT_EQ(gone.names_size(), 0);
  EXPECT_NE(gone.message().find("is not there any more"), std::string::npos) << gone.message();
}

}  // namespace
}  // namespace cairn::coordinator
