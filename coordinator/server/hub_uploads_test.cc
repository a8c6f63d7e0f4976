// Inputs that come in pieces, over real files.
#include <fstream>

#include "coordinator/server/hub_bench.h"
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

class HubUploads : public ::testing::Test {
 protected:
  proto::Job LargeJob() {
    proto::Job job = bench_.MakeJob();
    (*job.mutable_input_blobs())["log"] = large_.hash.Binary();
    return job;
  }
  // The files that are there of inputs: half of them and whole ones.
  std::vector<std::string> Half() const { return NamesIn(bench_.folder->Uploads()); }
  std::vector<std::string> Whole() const { return NamesIn(bench_.folder->Blobs()); }
  static std::vector<std::string> NamesIn(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
    return names;
  }
  void BringHalf(const std::string& peer) {
    bench_.transport.Come(peer, HubBench::Offer(large_.hash, flat_.size()));
    bench_.Until([&] { return bench_.TakeCredit(peer) > 0; });
    bench_.transport.Come(peer, HubBench::Piece(large_.hash, 0, flat_.substr(0, 1 << 20)));
    bench_.Until([&] { return bench_.TakeCredit(peer) > 0 || flat_.size() < 2 << 20 || Half().size() == 1; });
  }
  std::uint64_t Count(wire::RefusalKind kind) const { return bench_.hub->refusals().count(kind); }

  HubBench bench_;
  const wire::NamedBlob large_ = LargeBlob();
  const std::string flat_ = flat_testing::Flat(*large_.blob);
};

TEST_F(HubUploads, AJobWhoseInputCameInPiecesIsDurableAndRunsAlsoAfterARestart) {
  ASSERT_TRUE(bench_.Upload(large_).ok());
  EXPECT_EQ(Whole(), std::vector<std::string>{large_.hash.Hex() + ".flat"}) << "durable when it is answered";
  EXPECT_EQ(bench_.Ask(bench_.Submission(LargeJob(), false)).jobs(0).id(), "1-toy");
  EXPECT_TRUE(Half().empty());
  bench_.Start();
  EXPECT_EQ(bench_.State("1-toy"), "queued");
  bench_.transport.swallow = [](const wire::Assign&) { return true; };
  bench_.transport.ComeWorker("w");
  bench_.Until([&] { return bench_.transport.assigned > 0; });
  wire::Message fetch;
  fetch.envelope.mutable_fetch()->set_hash(large_.hash.Binary());
  bench_.transport.sent.clear();
  bench_.transport.Come("w", fetch);
  bench_.Until([&] { return !bench_.transport.sent.empty(); });
  ASSERT_TRUE(bench_.transport.sent.back().second.envelope.has_blob());
  EXPECT_EQ(bench_.transport.sent.back().second.blobs[0].blob->fields(), large_.blob->fields());
}

TEST_F(HubUploads, AnInputGoesWithTheLastJobThatNeedsIt) {
  bench_.transport.ComeWorker("w");
  ASSERT_TRUE(bench_.Upload(large_).ok());
  ASSERT_TRUE(bench_.Ask(bench_.Submission(LargeJob(), false)).ok());
  bench_.Until([&] { return bench_.State("1-toy") == "done"; });
  bench_.Until([&] { return Whole().empty(); });
}

TEST_F(HubUploads, ADamagedInputIsSetAsideByTheNextStart) {
  ASSERT_TRUE(bench_.Upload(large_).ok());
  ASSERT_TRUE(bench_.Ask(bench_.Submission(LargeJob(), false)).ok());
  bench_.hub.reset();
  {
    std::fstream file(bench_.folder->FlatFile(large_.hash), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(2'000'000);
    file.put(77);
  }
  bench_.Start();
  EXPECT_TRUE(bench_.Logged("do not match its hash"));
  EXPECT_EQ(Whole(), std::vector<std::string>{large_.hash.Hex() + ".flat.damaged"});
}

TEST_F(HubUploads, WhatNoJobTakesGoesWithItsClient) {
  ASSERT_TRUE(bench_.Upload(large_, "a").ok());
  ASSERT_TRUE(bench_.Upload(large_, "b").ok()) << "it is there already";
  bench_.transport.gone = {"a"};
  bench_.Until([&] { return bench_.hub->uploads().kept() == 1; });
  EXPECT_EQ(Whole().size(), 1u) << "b needs it";
  bench_.transport.gone = {"a", "b"};
  bench_.Until([&] { return Whole().empty(); });
}

TEST_F(HubUploads, HalfAnInputGoesWithItsClientAndWithItsCoordinator) {
  BringHalf("a");
  EXPECT_EQ(Half().size(), 1u);
  bench_.transport.gone = {"a"};
  bench_.Until([&] { return Half().empty(); });
  BringHalf("b");
  EXPECT_EQ(Half().size(), 1u);
  // As a killed one leaves it.
  fs::copy_file(bench_.folder->Uploads() / Half()[0], bench_.folder->Uploads() / "7.part");
  bench_.Start();
  EXPECT_TRUE(Half().empty());
  EXPECT_TRUE(Whole().empty());
  EXPECT_TRUE(bench_.Upload(large_, "c").ok()) << "it begins again";
}

TEST_F(HubUploads, AClientThatIgnoresItsCreditIsDroppedAndNoMoreThanTheBoundIsKept) {
  const UploadOptions bound;
  const std::string mib(1 << 20, 'x');
  bench_.transport.Come("a", HubBench::Offer(large_.hash, 1 << 30));
  bench_.Until([&] { return bench_.TakeCredit("a") > 0; });
  for (std::uint64_t i = 0; i < 200; ++i)
    bench_.transport.Come("a", HubBench::Piece(large_.hash, i << 20, mib));
  bench_.hub->Step(0);
  EXPECT_LE(bench_.hub->uploads().held_bytes(), bound.window_bytes);
  EXPECT_TRUE(bench_.transport.dropped.contains("a"));
  EXPECT_GE(Count(wire::RefusalKind::kBlob), 1u);
  bench_.Until([&] { return bench_.hub->uploads().size() == 0 && Half().empty(); });
}

TEST_F(HubUploads, WhatIsNotWhatItsHashSaysIsRefusedAndLeavesNothing) {
  const wire::NamedBlob lie{Hash{}, large_.blob};
  EXPECT_FALSE(bench_.Upload(lie).ok());
  std::string flipped = flat_;
  flipped.back() = static_cast<char>(flipped.back() ^ 1);
  bench_.transport.Come("a", HubBench::Offer(large_.hash, flat_.size()));
  bench_.transport.Come("a", HubBench::Piece(large_.hash, 0, flipped));
  std::optional<wire::Reply> reply;
  bench_.Until([&] { return (reply = bench_.TakeReply("a")).has_value(); });
  EXPECT_FALSE(reply->ok());
  EXPECT_NE(reply->message().find("do not match its hash"), std::string::npos) << reply->message();
  EXPECT_TRUE(Half().empty());
  EXPECT_TRUE(Whole().empty());
}

TEST_F(HubUploads, ADiskThatTakesNoMoreRefusesWithTheReason) {
  fs::create_directories(bench_.folder->Uploads() / "1.part");
  const wire::Reply refused = bench_.Upload(large_);
  EXPECT_FALSE(refused.ok());
  EXPECT_NE(refused.message().find("1.part: cannot write"), std::string::npos) << refused.message();
  EXPECT_TRUE(bench_.Upload(large_).ok()) << "the next has better luck";
}

TEST_F(HubUploads, CleaningTakesNothingOfWhatIsOnItsWay) {
  BringHalf("a");
  ASSERT_TRUE(bench_.Upload(TextBlob("the log"), "b").ok());
  wire::Message clean;
  clean.envelope.mutable_clean();
  EXPECT_EQ(bench_.Ask(clean).cleaned_size(), 0);
  EXPECT_EQ(Half().size(), 1u);
  EXPECT_EQ(Whole().size(), 1u);
}

TEST_F(HubUploads, WhatIsTooLargeOrNoHashIsRefusedAtOnce) {
  bench_.transport.Come("a", HubBench::Offer(large_.hash, std::uint64_t{5} << 30));
  wire::Message odd;
  odd.envelope.mutable_offer()->set_hash("short");
  bench_.transport.Come("b", odd);
  for (const char* peer : {"a", "b"}) {
    std::optional<wire::Reply> reply;
    bench_.Until([&] { return (reply = bench_.TakeReply(peer)).has_value(); });
    EXPECT_FALSE(reply->ok());
  }
  EXPECT_EQ(bench_.hub->uploads().size(), 0u);
}

}  // namespace
}  // namespace cairn::coordinator
