// Blobs on their way to workers: whoever does not read them waits, and keeps nobody else waiting for long.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/server/testing/hub_fixture.h"
#include "schema/blob_part.h"

namespace cairn::coordinator {
namespace {

constexpr int kNumbers = 1 << 15;
constexpr std::size_t kLogBytes = kNumbers * sizeof(double);
constexpr std::size_t kAll = 100 * kLogBytes;  // that may be on its way

class ServerFetches : public ::testing::Test {
 protected:
  // Two workers that both have tasks which need the log.
  void Begin(std::size_t all_bytes = kAll) {
    fixture_.fetched_bytes = all_bytes;
    fixture_.Start();
    Blob blob;
    blob.PutVector("values", std::vector<double>(kNumbers, 0.5));
    log_ = wire::NameBlob(std::make_shared<const Blob>(std::move(blob)));
    fixture_.transport.swallow = [](const wire::Assign&) { return true; };
    for (const char* peer : {"deaf", "other"}) fixture_.transport.ComeWorker(peer, "", 1, peer[0]);
    for (const char* id : {"a", "b", "c", "d"}) {
      proto::Job job = fixture_.MakeJob();
      job.set_name(id);
      (*job.mutable_input_blobs())["log"] = log_.hash.Binary();
      fixture_.server->Submit(id, job, {log_});
    }
    fixture_.Until([&] { return fixture_.transport.assigned == 4; });
    fixture_.transport.sent.clear();
    fixture_.transport.deaf = {"deaf"};
  }
  void Ask(const std::string& peer, std::optional<int> first_row = {}) {
    wire::Message fetch;
    fetch.envelope.mutable_fetch()->set_hash(log_.hash.Binary());
    if (first_row)
      *fetch.envelope.mutable_fetch()->mutable_part() = RowsPart("values", *first_row, kNumbers / 2);
    fixture_.transport.Come(peer, std::move(fetch));
  }
  // Blobs that `peer` was sent, a few turns later.
  std::ptrdiff_t Answers(const std::string& peer) {
    for (int turn = 0; turn < 10; ++turn) fixture_.server->Step(0);
    return std::ranges::count_if(fixture_.transport.sent, [&](const auto& sent) {
      return sent.first == peer && sent.second.envelope.has_blob();
    });
  }

  wire::NamedBlob log_;
  ServerFixture fixture_;
};

TEST_F(ServerFetches, OfAWorkerThatHasNotReadItsShareWaitAndThoseOfOthersDoNot) {
  Begin();
  Ask("deaf");
  ASSERT_EQ(Answers("deaf"), 1);
  fixture_.transport.unsent["deaf"] = kAll / 2;
  for (const int row : {0, 1, 0}) Ask("deaf", row);
  Ask("other");
  Ask("other", 0);
  EXPECT_EQ(Answers("deaf"), 1);
  EXPECT_EQ(Answers("other"), 2);
  fixture_.transport.unsent["deaf"] = kAll / 2 - 1;
  EXPECT_EQ(Answers("deaf"), 2) << "one more, and with that it has its share again";
  fixture_.transport.unsent["deaf"] = 0;
  EXPECT_EQ(Answers("deaf"), 3) << "each is answered once, however often it was asked for";
  EXPECT_EQ(Answers("other"), 2);
}

TEST_F(ServerFetches, OfWhatIsStillOnItsWayAreNotAnsweredASecondTime) {
  Begin();
  for (int times = 0; times < 3; ++times) Ask("deaf");
  EXPECT_EQ(Answers("deaf"), 1);
  Ask("deaf", 0);
  EXPECT_EQ(Answers("deaf"), 2);
  fixture_.transport.unsent["deaf"] = kLogBytes / 2;  // the first is out
  Ask("deaf", 0);
  Ask("deaf");
  EXPECT_EQ(Answers("deaf"), 3);
}

// For each worker they are in memory again.
TEST_F(ServerFetches, OfPartsWaitWhileAsMuchIsOnItsWayToAll) {
  Begin(kLogBytes / 2);
  Ask("deaf", 0);
  ASSERT_EQ(Answers("deaf"), 1);
  Ask("other", 0);
  EXPECT_EQ(Answers("other"), 0);
  fixture_.transport.unsent["deaf"] = 0;
  EXPECT_EQ(Answers("other"), 1);
}

// After a restart nothing is in memory, and nobody knows to how much a file unpacks.
TEST_F(ServerFetches, WhatIsOnDiskAloneIsReadByTheWritingThreadWhileOthersAreServed) {
  Begin();
  fixture_.Until([&] { return !fixture_.server->core().HasUnsaved(); });
  fixture_.transport.assigned = 0;
  fixture_.Start();
  for (const char* peer : {"first", "other"}) fixture_.transport.ComeWorker(peer, "", 1, peer[0]);
  fixture_.Until([&] { return fixture_.transport.assigned == 4; });
  fixture_.transport.sent.clear();
  const auto ask = [&](const std::string& peer, const std::string& action) {
    wire::Message question;
    question.envelope.mutable_query()->set_job("a");
    question.envelope.mutable_query()->set_action(action);
    fixture_.transport.Come(peer, std::move(question));
  };
  const auto reply = [&](const std::string& peer) {
    for (int turn = 0; turn < 10; ++turn) fixture_.server->Step(0);
    return fixture_.TakeReply(peer);
  };
  std::unique_lock stopped(fixture_.transport.wake);
  ask("who stops it", "logs");
  fixture_.server->Step(0);
  Ask("first");
  Ask("first", 0);
  Ask("other");
  ask("client", "inputs");
  ask("another", "status");
  EXPECT_TRUE(reply("another"));
  EXPECT_FALSE(reply("client"));
  EXPECT_EQ(Answers("first") + Answers("other"), 0);
  stopped.unlock();
  fixture_.Until([&] { return Answers("first") == 2 && Answers("other") == 1; });
  std::optional<wire::Reply> inputs;
  fixture_.Until([&] { return (inputs = fixture_.TakeReply("client")).has_value(); });
  ASSERT_EQ(inputs->names_size(), 1);
  EXPECT_EQ(fixture_.last_blobs.at(0).blob->ContentHash(), log_.hash);
}

// The file of one that is damaged is told to who asked, who is not kept waiting.
TEST_F(ServerFetches, WhatCannotBeReadBackIsToldToBeMissing) {
  Begin();
  fixture_.Until([&] { return !fixture_.server->core().HasUnsaved(); });
  fixture_.transport.assigned = 0;
  fixture_.Start();
  fixture_.transport.ComeWorker("one", "", 1, 1);
  fixture_.Until([&] { return fixture_.transport.assigned > 0; });
  std::ofstream(fixture_.folder->BlobFile(log_.hash)) << "damaged";
  fixture_.transport.sent.clear();
  Ask("one");
  fixture_.Until([&] {
    return std::ranges::any_of(fixture_.transport.sent, [](const auto& sent) {
      return sent.first == "one" && sent.second.envelope.has_missing();
    });
  });
  EXPECT_TRUE(fixture_.Logged(fixture_.folder->BlobFile(log_.hash).string()));
}

TEST_F(ServerFetches, WhoReadsNothingOfThemLosesItsTasks) {
  fixture_.stalled_s = 0.05;
  Begin();
  Ask("deaf");
  Ask("other");
  fixture_.Until([&] { return !fixture_.server->core().fleet().Knows("deaf"); });
  EXPECT_EQ(fixture_.transport.dropped, std::set<std::string>{"deaf"});
  EXPECT_TRUE(fixture_.server->core().fleet().Knows("other"));
}

}  // namespace
}  // namespace cairn::coordinator
