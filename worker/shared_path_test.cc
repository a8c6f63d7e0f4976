#include "worker/shared_path.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <semaphore>

#include "schema/blob_part.h"
#include "schema/flat_blob_testing.h"
#include "worker/testing/rig.h"

namespace cairn::worker {
namespace {

namespace fs = std::filesystem;

Blob Values(double first) {
  std::vector<double> values(100'000, first);
  Blob blob;
  blob.PutVector("v", values);
  return blob;
}

class SharedPathTest : public ::testing::Test {
 protected:
  SharedPathTest() { fs::create_directories(folder_); }
  ~SharedPathTest() override { fs::remove_all(folder_); }

  fs::path FileOf(const Hash& hash) const { return folder_ / (hash.Hex() + ".flat"); }
  Hash Write(const Blob& blob, std::size_t damaged_at = 0) const {
    std::string flat = flat_testing::Flat(blob);
    if (damaged_at > 0) flat[damaged_at] = static_cast<char>(flat[damaged_at] ^ 1);
    std::ofstream(FileOf(blob.ContentHash()), std::ios::binary) << flat;
    return blob.ContentHash();
  }
  Look LookFor(const Want& want) {
    shared_.LookFor(want);
    woken_.acquire();
    const std::vector<Look> looks = shared_.TakeLooks();
    EXPECT_EQ(looks.size(), 1u);
    return looks.at(0);
  }
  static Want PartOfIt(const Hash& blob, std::int64_t first, std::int64_t count) {
    const proto::BlobPart part = RowsPart("v", first, count);
    return {NameOfPart(blob, part), true, PartOf{blob, part}};
  }

  const fs::path folder_ = fs::temp_directory_path() / ("cairn-shared-path-" + std::to_string(::getpid()));
  std::counting_semaphore<> woken_{0};
  SharedPath shared_{folder_, [this] { woken_.release(); }};
};

TEST_F(SharedPathTest, WhatIsThereIsReadWholeAndInParts) {
  const Hash hash = Write(Values(1));
  EXPECT_EQ(LookFor({hash}).blob->fields(), Values(1).fields());
  EXPECT_EQ(LookFor(PartOfIt(hash, 5, 10)).blob->at("v").size(), 10);
}

TEST_F(SharedPathTest, WhatIsNotThereIsNoNews) {
  for (const Want& want : {Want{Values(1).ContentHash()}, PartOfIt(Values(1).ContentHash(), 0, 1)}) {
    const Look look = LookFor(want);
    EXPECT_EQ(look.blob, nullptr);
    EXPECT_EQ(look.why, "");
  }
  const Look beyond = LookFor(PartOfIt(Write(Values(2)), 100'000, 1));
  EXPECT_EQ(beyond.blob, nullptr);
  EXPECT_EQ(beyond.why, "") << "the coordinator says so";
}

TEST_F(SharedPathTest, WhatIsNotWhatItsHashSaysIsToldOnceAndNeverGiven) {
  for (const bool of_part : {false, true}) {
    const Hash hash = Write(Values(of_part ? 2 : 1), 5000);
    const Want want = of_part ? PartOfIt(hash, 90'000, 1) : Want{hash};  // another part than the damaged one
    const Look look = LookFor(want);
    EXPECT_EQ(look.blob, nullptr);
    EXPECT_NE(look.why.find(FileOf(hash).string()), std::string::npos) << look.why;
    const Look again = LookFor(want);
    EXPECT_EQ(again.blob, nullptr);
    EXPECT_EQ(again.why, "");
  }
  fs::create_directory(FileOf(Values(3).ContentHash()));
  EXPECT_EQ(LookFor({Values(3).ContentHash()}).blob, nullptr);
}

// Of what lies there nothing goes over the wire; the rest does, and what is damaged.
TEST_F(SharedPathTest, AWorkerFetchesWhatItDoesNotFindThere) {
  Rig rig(
      [](const Task&, const Inputs& inputs, Progress&) {
        return Number(inputs.Get("a")->Get<double>("v")[0] + inputs.Get("b")->Get<double>("v")[0]);
      },
      [this](WorkerOptions& options) { options.shared_path = folder_; });
  rig.Begin();
  const Hash there = Write(Values(1));
  const auto sum = [&](const Hash& b) {
    wire::Assign assign = RunTask(0, {{"a", there}, {"b", b}});
    *assign.mutable_task()->mutable_inputs(0)->mutable_part() = RowsPart("v", 10, 10);
    rig.Assign(assign);
    return rig.Serve().blobs.at(0).blob->Scalar<double>("v");
  };
  EXPECT_EQ(sum(Write(Values(2))), 3);
  EXPECT_EQ(rig.fetches, 0);
  EXPECT_EQ(sum(rig.Keep(Values(4))), 5);
  EXPECT_EQ(rig.fetches, 1);
  Write(Values(8), 5000);
  EXPECT_EQ(sum(rig.Keep(Values(8))), 9);
  EXPECT_EQ(rig.fetches, 2);
  EXPECT_NE(rig.log().find("the coordinator is asked for it"), std::string::npos);
}

}  // namespace
}  // namespace cairn::worker
