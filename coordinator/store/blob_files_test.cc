#include "coordinator/store/blob_files.h"

#include <gtest/gtest.h>

#include <fstream>

#include "coordinator/server/testing/hub_fixture.h"
#include "schema/store/blob_file.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

class Files : public ::testing::Test {
 protected:
  std::vector<wire::NamedBlob> Small(int count) const {
    std::vector<wire::NamedBlob> blobs;
    for (int i = 0; i < count; ++i) blobs.push_back(TextBlob("blob " + std::to_string(i)));
    return blobs;
  }
  void Write(const std::vector<wire::NamedBlob>& blobs) {
    std::vector<Hash> written;
    ASSERT_TRUE(files_.Write(blobs, written).ok());
    EXPECT_EQ(written.size(), blobs.size());
  }
  std::size_t FileCount() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_.Blobs()), fs::directory_iterator()));
  }
  static std::vector<Hash> Hashes(const std::vector<wire::NamedBlob>& blobs) {
    std::vector<Hash> hashes;
    for (const wire::NamedBlob& named : blobs) hashes.push_back(named.hash);
    return hashes;
  }

  TempFolder temp_;
  StoreFolder folder_ = StoreFolder::Open(temp_.path() / "s").value();
  BlobFiles files_{folder_};
};

TEST_F(Files, AFewBlobsHaveFilesOfTheirOwn) {
  const auto blobs = Small(3);
  Write(blobs);
  EXPECT_EQ(FileCount(), 3u);
  for (const wire::NamedBlob& named : blobs) {
    EXPECT_TRUE(fs::exists(folder_.BlobFile(named.hash)));
    EXPECT_EQ(files_.Read(named.hash).value()->ContentHash(), named.hash);
  }
}

TEST_F(Files, ManySmallOnesShareAFileAndLargeOnesDoNot) {
  auto blobs = Small(100);
  blobs.push_back(TextBlob(std::string(100'000, 'x')));
  Write(blobs);
  EXPECT_EQ(FileCount(), 2u);
  BlobFiles again(folder_);  // as after a restart
  for (const wire::NamedBlob& named : blobs) {
    EXPECT_TRUE(again.Check(named.hash).ok());
    EXPECT_EQ(again.Read(named.hash).value()->ContentHash(), named.hash);
    EXPECT_EQ(files_.Read(named.hash).value()->ContentHash(), named.hash);
  }
}

TEST_F(Files, APackGoesWithItsLastBlob) {
  const auto blobs = Small(20);
  Write(blobs);
  std::vector<Hash> all_but_one = Hashes(blobs);
  const Hash last = all_but_one.back();
  all_but_one.pop_back();
  files_.Remove(all_but_one);
  EXPECT_FALSE(files_.Has(all_but_one[0]));
  ASSERT_TRUE(files_.Has(last));
  EXPECT_TRUE(files_.Read(last).ok());
  files_.Remove({last});
  EXPECT_FALSE(files_.Has(last));
  EXPECT_EQ(FileCount(), 0u);
}

TEST_F(Files, AStartKeepsWhatIsNamedOnly) {
  const auto packed = Small(20);
  const auto alone = TextBlob("alone"), unnamed = TextBlob("unnamed");
  Write(packed);
  Write({alone});
  Write({unnamed});
  files_.RemoveAllBut({packed[4].hash, alone.hash});
  EXPECT_TRUE(files_.Has(packed[4].hash));
  EXPECT_TRUE(files_.Has(alone.hash));
  EXPECT_FALSE(files_.Has(packed[5].hash));
  EXPECT_FALSE(files_.Has(unnamed.hash));
  EXPECT_EQ(FileCount(), 2u);
}

TEST_F(Files, ADamagedPackIsQuarantinedAtTheStart) {
  const auto blobs = Small(20);
  Write(blobs);
  const fs::path pack = folder_.PackFiles().at(0);
  fs::resize_file(pack, fs::file_size(pack) / 2);
  BlobFiles again(folder_);
  EXPECT_FALSE(again.Has(blobs[0].hash));
  EXPECT_EQ(again.Check(blobs[0].hash).code(), Code::kNotFound);
  EXPECT_TRUE(fs::exists(pack.string() + ".damaged"));
}

// As where a right is missing for a moment, which root would not notice: a link that leads to itself.
TEST_F(Files, WhatCannotBeLookedAtNowIsNotGone) {
  const auto packed = Small(20), alone = std::vector{TextBlob("alone")};
  Write(packed);
  Write(alone);
  const fs::path aside = temp_.path() / "aside";
  fs::rename(folder_.Blobs(), aside);
  fs::create_symlink(folder_.Blobs(), folder_.Blobs());
  for (const Hash& hash : {packed[0].hash, alone[0].hash}) {
    EXPECT_TRUE(files_.Has(hash));
    const Status status = files_.Read(hash).status();
    EXPECT_TRUE(SaysNothing(status)) << status.message();
  }
  EXPECT_TRUE(SaysNothing(files_.Check(alone[0].hash)));
  files_.ForgetGonePacks();
  fs::remove(folder_.Blobs());
  fs::rename(aside, folder_.Blobs());
  for (const Hash& hash : {packed[0].hash, alone[0].hash}) EXPECT_TRUE(files_.Read(hash).ok());
}

TEST_F(Files, AWriteThatFailsLeavesNothing) {
  fs::remove_all(folder_.Blobs());
  std::vector<Hash> written;
  EXPECT_FALSE(files_.Write(Small(20), written).ok());
  EXPECT_TRUE(written.empty());
  EXPECT_FALSE(files_.Has(Small(20)[0].hash));
}

}  // namespace
}  // namespace cairn::coordinator
