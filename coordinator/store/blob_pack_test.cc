#include "coordinator/store/blob_pack.h"

#include <gtest/gtest.h>

#include "coordinator/server/testing/hub_fixture.h"

namespace cairn::coordinator {
namespace {

std::vector<wire::NamedBlob> SomeBlobs() {
  Blob two;
  two.PutVector<double>("a", {1, 2, 3});
  two.Put("b", Array::Text("text"));
  return {TextBlob("one"), wire::NameBlob(std::make_shared<const Blob>(std::move(two))), TextBlob("")};
}

TEST(BlobPack, GivesBackWhatWasPackedInOrder) {
  const auto unpacked = UnpackBlobs(PackBlobs(SomeBlobs()));
  ASSERT_TRUE(unpacked.ok()) << unpacked.status().message();
  ASSERT_EQ(unpacked.value().size(), SomeBlobs().size());
  for (std::size_t i = 0; i < SomeBlobs().size(); ++i) {
    EXPECT_EQ(unpacked.value()[i].hash, SomeBlobs()[i].hash);
    EXPECT_EQ(unpacked.value()[i].blob->ContentHash(), SomeBlobs()[i].hash);
  }
}

TEST(BlobPack, AFlippedByteAnywhereIsNoticed) {
  const Blob pack = PackBlobs(SomeBlobs());
  const auto bytes = pack.Get<std::uint8_t>("bytes");
  ASSERT_GT(bytes.size(), SomeBlobs().size());
  std::size_t noticed = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::vector<std::uint8_t> flipped(bytes.begin(), bytes.end());
    flipped[i] ^= 0x10;
    Blob damaged = pack;
    damaged.PutVector("bytes", flipped);
    const auto unpacked = UnpackBlobs(damaged);
    if (!unpacked.ok()) {
      ++noticed;
      continue;
    }
    // A bit that no blob depends on (an unknown field of the envelope) may pass; a blob that is another may
    // not.
    ASSERT_EQ(unpacked.value().size(), SomeBlobs().size()) << "byte " << i;
    for (std::size_t j = 0; j < SomeBlobs().size(); ++j)
      EXPECT_EQ(unpacked.value()[j].blob->ContentHash(), SomeBlobs()[j].hash) << "byte " << i;
  }
  EXPECT_GT(noticed, bytes.size() / 2);
}

TEST(BlobPack, ATruncationAnywhereIsNoticed) {
  const Blob pack = PackBlobs(SomeBlobs());
  const auto bytes = pack.Get<std::uint8_t>("bytes");
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Blob damaged = pack;
    damaged.PutVector("bytes",
                      std::vector<std::uint8_t>(bytes.begin(), bytes.begin() + static_cast<int>(size)));
    EXPECT_EQ(UnpackBlobs(damaged).status().code(), Code::kCorrupt) << size;
  }
  Blob fewer = pack;
  fewer.PutVector<std::int64_t>("frames", {2});
  EXPECT_EQ(UnpackBlobs(fewer).status().code(), Code::kCorrupt) << "bytes are left over";
  EXPECT_EQ(UnpackBlobs(Blob()).status().code(), Code::kCorrupt);
}

}  // namespace
}  // namespace cairn::coordinator
