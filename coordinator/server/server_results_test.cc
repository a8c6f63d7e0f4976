// Results on their way to those who ask for them: read once, in memory once, and no more than a bound.
#include <gtest/gtest.h>

#include <filesystem>
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
  fixture_.server->Step(0);
  const auto bytes_of = [](const wire::Message& message) {
    return message.blobs.at(0).blob->at("text").bytes().data();
  };
  ASSERT_TRUE(SentTo("one") && SentTo("two") && SentTo("three")) << "in one turn, for they are read once";
  EXPECT_EQ(bytes_of(*SentTo("one")), bytes_of(*SentTo("two")));
  EXPECT_EQ(bytes_of(*SentTo("one")), bytes_of(*SentTo("three")));
  const Array kept = SentTo("one")->blobs.at(0).blob->at("text");  // as a frame keeps it
  fixture_.transport.sent.clear();
  Come("one");
  fixture_.server->Step(0);
  EXPECT_EQ(bytes_of(*SentTo("one")), kept.bytes().data());
  EXPECT_EQ(SentTo("one")->blobs.at(0).hash, SentTo("one")->blobs.at(0).blob->ContentHash());
}

// Each is read whole in the loop that serves everybody.
TEST_F(ServerResults, OfSeveralJobsThoseOfOneAreReadInATurn) {
  const std::vector<std::string> jobs = {"a", "b", "c"};
  for (std::size_t i = 0; i < jobs.size(); ++i) Run(jobs[i], i);
  for (const std::string& job : jobs) Come("peer of " + job, job);
  Come("peer of c", "c");  // asked twice, answered once
  fixture_.transport.Come("other", Query("status", "a"), viewer_);
  fixture_.server->Step(0);
  EXPECT_TRUE(SentTo("peer of a"));
  EXPECT_FALSE(SentTo("peer of b") || SentTo("peer of c"));
  EXPECT_TRUE(SentTo("other")) << "waits for nobody's results";
  fixture_.server->Step(0);
  EXPECT_TRUE(SentTo("peer of b"));
  EXPECT_FALSE(SentTo("peer of c"));
  fixture_.server->Step(0);
  ASSERT_TRUE(SentTo("peer of c"));
  EXPECT_EQ(SentTo("peer of c")->blobs.size(), 1U);
  const std::size_t sent = fixture_.transport.sent.size();
  fixture_.server->Step(0);
  EXPECT_EQ(fixture_.transport.sent.size(), sent);
}

TEST_F(ServerResults, OfAllTogetherNoMoreIsOnItsWayThanABoundAndOfOneKeyAQuarterOfIt) {
  Run();
  const std::size_t gib = std::size_t{1} << 30;
  const auto expect_refused = [&](const std::string& user, const std::string& why) {
    const std::uint64_t before = Count(RefusalKind::kQuota);
    const wire::Reply refused = Ask(user, Query("results")).reply();
    EXPECT_FALSE(refused.ok());
    EXPECT_TRUE(refused.unable());
    EXPECT_NE(refused.message().find(why), std::string::npos) << refused.message();
    EXPECT_EQ(Count(RefusalKind::kQuota), before + 1);
  };
  const std::string mine = "peer of " + submitter_;
  ASSERT_TRUE(Ask(submitter_, Query("results")).reply().ok());
  fixture_.transport.unsent[mine] = 10;
  fixture_.transport.Come("second", Query("results"), submitter_);
  fixture_.Until([&] { return SentTo("second").has_value(); });
  fixture_.transport.unsent = {{mine, gib / 4}};
  EXPECT_TRUE(Ask(viewer_, Query("results")).reply().ok()) << "another's";
  fixture_.transport.Come("third", Query("results"), submitter_);
  fixture_.Until([&] { return SentTo("third").has_value(); });
  EXPECT_NE(SentTo("third")->envelope.reply().message().find("when they are there"), std::string::npos);
  fixture_.transport.unsent = {{mine, gib}};
  expect_refused(viewer_, "those who asked before; try again");
  EXPECT_TRUE(Ask(viewer_, Query("status")).reply().ok());
  fixture_.transport.unsent.clear();
  EXPECT_TRUE(Ask(viewer_, Query("results")).reply().ok());
}

TEST_F(ServerResults, AFileThatHasChangedMeanwhileIsReadAnew) {
  Run();
  Come("one");
  fixture_.server->Step(0);
  ASSERT_TRUE(SentTo("one"));
  std::filesystem::remove(FileOf("a"));
  const wire::Reply gone = Ask(viewer_, Query("results")).reply();
  EXPECT_EQ(gone.names_size(), 0);
  EXPECT_NE(gone.message().find("is not there any more"), std::string::npos) << gone.message();
}

}  // namespace
}  // namespace cairn::coordinator
