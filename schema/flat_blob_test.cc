#include "schema/flat_blob.h"

#include <gtest/gtest.h>

#include <functional>

#include "schema/flat_blob_testing.h"

namespace cairn {
namespace {

using flat_testing::Flat;

Blob FlatSample() {
  Blob blob;
  blob.PutVector<double>("a/time_s", {1, 2, 3});
  blob.Put("b", Array::Texts({"Grüße", ""}));
  blob.Put("none", Array::Vector<double>({}));
  blob.PutScalar<std::int32_t>("z", 7);
  return blob;
}

Status Check(std::string_view bytes, std::size_t part, const Hash& hash) {
  FlatCheck check(hash);
  for (std::size_t at = 0; at < bytes.size(); at += part)
    if (Status status = check.Add(std::as_bytes(std::span(bytes.substr(at, part)))); !status.ok())
      return status;
  return check.Finish();
}

TEST(FlatBlob, IsGoodHoweverItComesAndHasTheBytesThatItsHeadSays) {
  for (const Blob& blob : {FlatSample(), Blob()}) {
    const std::string flat = Flat(blob);
    for (const std::size_t part : {1, 7, 64, 1000})
      EXPECT_TRUE(Check(flat, part, blob.ContentHash()).ok()) << part;
    EXPECT_EQ(FlatBytes(MetaOf(blob.ContentHash(), blob)).value(), flat.size());
  }
}

TEST(FlatBlob, AFlippedBitTruncationOrALongerOneIsRefusedAtEveryByte) {
  const std::string flat = Flat(FlatSample());
  const Hash hash = FlatSample().ContentHash();
  for (std::size_t i = 0; i < flat.size(); ++i) {
    std::string flipped = flat;
    flipped[i] = static_cast<char>(flipped[i] ^ 4);
    EXPECT_FALSE(Check(flipped, 5, hash).ok()) << i;
    EXPECT_EQ(Check(std::string_view(flat).substr(0, i), 5, hash).code(), Code::kCorrupt) << i;
  }
  EXPECT_EQ(Check(flat + "x", 5, hash).code(), Code::kCorrupt);
  EXPECT_EQ(Check(flat, 5, Hash{}).code(), Code::kCorrupt) << "of another hash";
}

// Nothing is kept for what a head announces.
TEST(FlatBlob, AHeadThatPromisesWhatCannotBeIsRefused) {
  const auto refused = [](const std::function<void(wire::BlobMeta&)>& change) {
    wire::BlobMeta meta = MetaOf(FlatSample().ContentHash(), FlatSample());
    change(meta);
    const Status status = Check(FlatHead(meta), 64, FlatSample().ContentHash());
    return !status.ok() && status.message().find("truncated") == std::string::npos;
  };
  EXPECT_FALSE(refused([](wire::BlobMeta&) {}));
  EXPECT_TRUE(refused([](wire::BlobMeta& m) { m.mutable_arrays(0)->set_shape(0, INT64_MAX); }));
  EXPECT_TRUE(refused([](wire::BlobMeta& m) { m.mutable_arrays(0)->set_shape(0, -1); }));
  EXPECT_TRUE(refused([](wire::BlobMeta& m) { m.mutable_arrays(0)->set_type(99); }));
  EXPECT_TRUE(refused([](wire::BlobMeta& m) { m.mutable_arrays(0)->set_item_bytes(3); }));
  EXPECT_TRUE(refused([](wire::BlobMeta& m) { m.mutable_arrays(0)->set_name("zz"); }));
  EXPECT_TRUE(refused([](wire::BlobMeta& m) { m.mutable_arrays(0)->set_name("\x1b[2J"); }));
  std::string long_list = FlatHead(wire::BlobMeta());
  long_list[18] = 17;  // over a MiB
  EXPECT_EQ(Check(long_list, 64, Hash{}).code(), Code::kRefused);
}

}  // namespace
}  // namespace cairn
