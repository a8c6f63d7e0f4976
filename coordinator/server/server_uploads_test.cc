// Inputs that come in pieces, over real files.
#include <fstream>

#include "coordinator/server/testing/hub_fixture.h"
#include "schema/blob_part.h"
#include "schema/store/flat_file.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

wire::NamedBlob LargeBlob(std::size_t numbers = 400'000) {
  std::vector<double> values(numbers);
  for (std::size_t i = 0; i < numbers; ++i) values[i] = static_cast<double>(i);
  Blob blob;
  blob.PutVector("values", values);
  return wire::NameBlob(std::make_shared<const Blob>(std::move(blob)));
}

class ServerUploads : public ::testing::Test {
 protected:
  proto::Job LargeJob() {
    proto::Job job = fixture_.MakeJob();
    (*job.mutable_input_blobs())["log"] = large_.hash.Binary();
    return job;
  }
  // The files that are there of inputs: half of them and whole ones.
  std::vector<std::string> Half() const { return NamesIn(fixture_.folder->Uploads()); }
  std::vector<std::string> Whole() const { return NamesIn(fixture_.folder->Blobs()); }
  static std::vector<std::string> NamesIn(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
    return names;
  }
  void BringHalf(const std::string& peer) {
    fixture_.transport.Come(peer, ServerFixture::Offer(large_.hash, flat_.size()));
    fixture_.Until([&] { return fixture_.TakeCredit(peer) > 0; });
    fixture_.transport.Come(peer, ServerFixture::Piece(large_.hash, 0, flat_.substr(0, 1 << 20)));
    fixture_.Until(
        [&] { return fixture_.TakeCredit(peer) > 0 || flat_.size() < 2 << 20 || Half().size() == 1; });
  }
  std::uint64_t Count(wire::RefusalKind kind) const { return fixture_.server->refusals().count(kind); }

  ServerFixture fixture_;
  const wire::NamedBlob large_ = LargeBlob();
  const std::string flat_ = flat_testing::Flat(*large_.blob);
};

TEST_F(ServerUploads, AJobWhoseInputCameInPiecesIsDurableAndRunsAlsoAfterARestart) {
  ASSERT_TRUE(fixture_.Upload(large_).ok());
  EXPECT_EQ(Whole(), std::vector<std::string>{large_.hash.Hex() + ".flat"}) << "durable when it is answered";
  EXPECT_EQ(fixture_.Ask(fixture_.Submission(LargeJob(), false)).jobs(0).id(), "1-toy");
  EXPECT_TRUE(Half().empty());
  fixture_.Start();
  EXPECT_EQ(fixture_.State("1-toy"), "queued");
  fixture_.transport.swallow = [](const wire::Assign&) { return true; };
  fixture_.transport.ComeWorker("w");
  fixture_.Until([&] { return fixture_.transport.assigned > 0; });
  wire::Message fetch;
  fetch.envelope.mutable_fetch()->set_hash(large_.hash.Binary());
  fixture_.transport.sent.clear();
  fixture_.transport.Come("w", fetch);
  fixture_.Until([&] { return !fixture_.transport.sent.empty(); });
  ASSERT_TRUE(fixture_.transport.sent.back().second.envelope.has_blob());
  EXPECT_EQ(fixture_.transport.sent.back().second.blobs[0].blob->fields(), large_.blob->fields());
}

// The coordinator holds none of it, though it may hold much.
TEST_F(ServerUploads, OfAnInputAWorkerIsServedThePartThatItAsksForAndIsToldWhatThatLacks) {
  ASSERT_TRUE(fixture_.Upload(large_).ok());
  ASSERT_TRUE(fixture_.Ask(fixture_.Submission(LargeJob(), false)).ok());
  fixture_.transport.swallow = [](const wire::Assign&) { return true; };
  fixture_.transport.ComeWorker("w");
  fixture_.Until([&] { return fixture_.transport.assigned > 0; });
  const auto answer = [&](const proto::BlobPart& part) {
    wire::Message fetch;
    fetch.envelope.mutable_fetch()->set_hash(large_.hash.Binary());
    *fetch.envelope.mutable_fetch()->mutable_part() = part;
    fixture_.transport.sent.clear();
    fixture_.transport.Come("w", fetch);
    fixture_.Until([&] { return !fixture_.transport.sent.empty(); });
    return fixture_.transport.sent.back().second;
  };
  const proto::BlobPart rows = RowsPart("values", 200'000, 3);
  const wire::Message part = answer(rows);
  ASSERT_TRUE(part.envelope.has_blob());
  EXPECT_EQ(part.envelope.blob().of(), large_.hash.Binary());
  EXPECT_EQ(part.envelope.blob().part().SerializeAsString(), rows.SerializeAsString());
  EXPECT_EQ(part.blobs.at(0).blob->fields(), CutPart(*large_.blob, rows).value()->fields());
  EXPECT_EQ(part.blobs.at(0).hash, part.blobs.at(0).blob->ContentHash());
  for (const proto::BlobPart& bad : {RowsPart("values", 400'000, 1), RowsPart("values", 0, INT64_MAX),
                                     RowsPart("none", 0, 1), RowsPart("values", -1, 1), proto::BlobPart()}) {
    const wire::Message refused = answer(bad);
    ASSERT_TRUE(refused.envelope.has_missing());
    EXPECT_NE(refused.envelope.missing().why(), "");
    EXPECT_EQ(refused.envelope.missing().part().SerializeAsString(), bad.SerializeAsString());
  }
  EXPECT_TRUE(answer(rows).envelope.has_blob()) << "it is whole all the same";
  {
    std::fstream file(fixture_.folder->FlatFile(large_.hash),
                      std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(2'000'000);
    file.put(77);
  }
  EXPECT_TRUE(answer(RowsPart("values", 0, 400'000)).envelope.has_missing());
  EXPECT_TRUE(fixture_.Logged("damaged"));
}

TEST_F(ServerUploads, AnInputGoesWithTheLastJobThatNeedsIt) {
  fixture_.transport.ComeWorker("w");
  ASSERT_TRUE(fixture_.Upload(large_).ok());
  ASSERT_TRUE(fixture_.Ask(fixture_.Submission(LargeJob(), false)).ok());
  fixture_.Until([&] { return fixture_.State("1-toy") == "done"; });
  fixture_.Until([&] { return Whole().empty(); });
}

TEST_F(ServerUploads, ADamagedInputIsQuarantinedByTheNextStart) {
  ASSERT_TRUE(fixture_.Upload(large_).ok());
  ASSERT_TRUE(fixture_.Ask(fixture_.Submission(LargeJob(), false)).ok());
  fixture_.server.reset();
  {
    std::fstream file(fixture_.folder->FlatFile(large_.hash),
                      std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(2'000'000);
    file.put(77);
  }
  fixture_.Start();
  EXPECT_TRUE(fixture_.Logged("do not match its hash"));
  EXPECT_EQ(Whole(), std::vector<std::string>{large_.hash.Hex() + ".flat.damaged"});
}

TEST_F(ServerUploads, WhatNoJobTakesGoesWithItsClient) {
  ASSERT_TRUE(fixture_.Upload(large_, "a").ok());
  ASSERT_TRUE(fixture_.Upload(large_, "b").ok()) << "it is there already";
  fixture_.transport.gone = {"a"};
  fixture_.Until([&] { return fixture_.server->uploads().kept() == 1; });
  EXPECT_EQ(Whole().size(), 1u) << "b needs it";
  fixture_.transport.gone = {"a", "b"};
  fixture_.Until([&] { return Whole().empty(); });
}

TEST_F(ServerUploads, HalfAnInputGoesWithItsClientAndWithItsCoordinator) {
  BringHalf("a");
  EXPECT_EQ(Half().size(), 1u);
  fixture_.transport.gone = {"a"};
  fixture_.Until([&] { return Half().empty(); });
  BringHalf("b");
  EXPECT_EQ(Half().size(), 1u);
  // As a killed one leaves it.
  fs::copy_file(fixture_.folder->Uploads() / Half()[0], fixture_.folder->Uploads() / "7.part");
  fixture_.Start();
  EXPECT_TRUE(Half().empty());
  EXPECT_TRUE(Whole().empty());
  EXPECT_TRUE(fixture_.Upload(large_, "c").ok()) << "it begins again";
}

TEST_F(ServerUploads, AClientThatIgnoresItsCreditIsDroppedAndNoMoreThanTheBoundIsKept) {
  const UploadOptions bound;
  const std::string mib(1 << 20, 'x');
  fixture_.transport.Come("a", ServerFixture::Offer(large_.hash, 1 << 30));
  fixture_.Until([&] { return fixture_.TakeCredit("a") > 0; });
  for (std::uint64_t i = 0; i < 200; ++i)
    fixture_.transport.Come("a", ServerFixture::Piece(large_.hash, i << 20, mib));
  fixture_.server->Step(0);
  EXPECT_LE(fixture_.server->uploads().held_bytes(), bound.window_bytes);
  EXPECT_TRUE(fixture_.transport.dropped.contains("a"));
  EXPECT_GE(Count(wire::RefusalKind::kBlob), 1u);
  fixture_.Until([&] { return fixture_.server->uploads().size() == 0 && Half().empty(); });
}

TEST_F(ServerUploads, WhatIsNotWhatItsHashSaysIsRefusedAndLeavesNothing) {
  const wire::NamedBlob lie{Hash{}, large_.blob};
  EXPECT_FALSE(fixture_.Upload(lie).ok());
  std::string flipped = flat_;
  flipped.back() = static_cast<char>(flipped.back() ^ 1);
  fixture_.transport.Come("a", ServerFixture::Offer(large_.hash, flat_.size()));
  fixture_.transport.Come("a", ServerFixture::Piece(large_.hash, 0, flipped));
  std::optional<wire::Reply> reply;
  fixture_.Until([&] { return (reply = fixture_.TakeReply("a")).has_value(); });
  EXPECT_FALSE(reply->ok());
  EXPECT_NE(reply->message().find("do not match its hash"), std::string::npos) << reply->message();
  EXPECT_TRUE(Half().empty());
  EXPECT_TRUE(Whole().empty());
}

TEST_F(ServerUploads, ADiskThatTakesNoMoreRefusesWithTheReason) {
  fs::create_directories(fixture_.folder->Uploads() / "1.part");
  const wire::Reply refused = fixture_.Upload(large_);
  EXPECT_FALSE(refused.ok());
  EXPECT_NE(refused.message().find("1.part: cannot write"), std::string::npos) << refused.message();
  EXPECT_TRUE(fixture_.Upload(large_).ok()) << "the next has better luck";
}

TEST_F(ServerUploads, CleaningTakesNothingOfWhatIsOnItsWay) {
  BringHalf("a");
  ASSERT_TRUE(fixture_.Upload(TextBlob("the log"), "b").ok());
  wire::Message clean;
  clean.envelope.mutable_clean();
  EXPECT_EQ(fixture_.Ask(clean).cleaned_size(), 0);
  EXPECT_EQ(Half().size(), 1u);
  EXPECT_EQ(Whole().size(), 1u);
}

TEST_F(ServerUploads, WhatIsTooLargeOrNoHashIsRefusedAtOnce) {
  fixture_.transport.Come("a", ServerFixture::Offer(large_.hash, std::uint64_t{5} << 30));
  wire::Message odd;
  odd.envelope.mutable_offer()->set_hash("short");
  fixture_.transport.Come("b", odd);
  for (const char* peer : {"a", "b"}) {
    std::optional<wire::Reply> reply;
    fixture_.Until([&] { return (reply = fixture_.TakeReply(peer)).has_value(); });
    EXPECT_FALSE(reply->ok());
  }
  EXPECT_EQ(fixture_.server->uploads().size(), 0u);
}

}  // namespace
}  // namespace cairn::coordinator
