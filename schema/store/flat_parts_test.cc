#include "schema/store/flat_parts.h"

#include <numeric>

#include "schema/flat_blob_testing.h"
#include "schema/store/testing.h"

namespace cairn {
namespace {

using flat_testing::Flat;
using store_testing::Overwrite;
using store_testing::TempFolder;

constexpr std::int64_t kRows = 50'000, kColumns = 3;

Blob Large() {
  std::vector<double> values(kRows * kColumns);
  std::iota(values.begin(), values.end(), 0.5);
  Blob blob;
  blob.Put("a/range_m", Array::Of<double>({kRows, kColumns}, values));
  blob.PutVector<std::uint8_t>("b", {1, 2, 3});
  blob.PutVector<double>("none", {});
  return blob;
}

void Write(const std::filesystem::path& path, const std::string& bytes) {
  const auto all = std::as_bytes(std::span(bytes));
  Overwrite(path, {all.begin(), all.end()});
}

TEST(FlatParts, AreThoseOfTheBlob) {
  const TempFolder temp;
  Write(temp / "flat", Flat(Large()));
  const Result<FlatParts> parts = FlatParts::Open(temp / "flat", Large().ContentHash());
  ASSERT_TRUE(parts.ok()) << parts.status().message();
  for (const auto& [first, count] : {std::pair<std::int64_t, std::int64_t>{0, kRows},
                                     {0, 1},
                                     {1, 2},
                                     {2730, 1},  // over the end of a chunk
                                     {kRows - 1, 1},
                                     {17, 20'000}}) {
    const proto::BlobPart part = RowsPart("a/range_m", first, count);
    const Result<BlobPtr> read = parts.value().Read(part);
    ASSERT_TRUE(read.ok()) << read.status().message();
    EXPECT_EQ(read.value()->fields(), CutPart(Large(), part).value()->fields()) << first << " " << count;
  }
  const Result<BlobPtr> head = parts.value().Read(HeadPart("range_m"));
  ASSERT_TRUE(head.ok());
  EXPECT_EQ(head.value()->fields(), CutPart(Large(), HeadPart("range_m")).value()->fields());
  EXPECT_EQ(parts.value().Read(RowsPart("b", 0, 4)).status().code(), Code::kRefused);
  EXPECT_EQ(parts.value().Read(RowsPart("c", 0, 1)).status().code(), Code::kRefused);
}

TEST(FlatParts, WhatIsNoWholeFlatBlobIsNotOpened) {
  const TempFolder temp;
  const std::string flat = Flat(Large());
  const Hash hash = Large().ContentHash();
  EXPECT_EQ(FlatParts::Open(temp / "none", hash).status().code(), Code::kNotFound);
  Write(temp / "flat", flat.substr(0, flat.size() - 1));
  EXPECT_EQ(FlatParts::Open(temp / "flat", hash).status().code(), Code::kCorrupt);
  Write(temp / "flat", flat);
  EXPECT_EQ(FlatParts::Open(temp / "flat", Hash{}).status().code(), Code::kCorrupt);
}

TEST(FlatParts, DamageThatCameLaterIsSeenWhereItLiesAndNowhereElse) {
  const TempFolder temp;
  const std::string flat = Flat(Large());
  Write(temp / "flat", flat);
  const Result<FlatParts> parts = FlatParts::Open(temp / "flat", Large().ContentHash());
  ASSERT_TRUE(parts.ok());
  std::string bad = flat;
  bad[flat.size() / 2] = static_cast<char>(bad[flat.size() / 2] ^ 1);
  Write(temp / "flat", bad);
  EXPECT_EQ(parts.value().Read(RowsPart("a/range_m", 0, kRows)).status().code(), Code::kCorrupt);
  EXPECT_EQ(parts.value().Read(RowsPart("a/range_m", kRows / 2, 1)).status().code(), Code::kCorrupt);
  EXPECT_TRUE(parts.value().Read(RowsPart("a/range_m", 0, 1)).ok());
  Write(temp / "flat", flat.substr(0, flat.size() / 2));
  EXPECT_EQ(parts.value().Read(RowsPart("a/range_m", 0, 1)).status().code(), Code::kCorrupt) << "cut off";
  std::filesystem::remove(temp / "flat");
  EXPECT_EQ(parts.value().Read(RowsPart("a/range_m", 0, 1)).status().code(), Code::kNotFound);
}

TEST(FlatPartsCache, ReadsAFileThroughOnceUntilItIsForgotten) {
  const TempFolder temp;
  std::string flat = Flat(Large());
  Write(temp / "flat", flat);
  const Hash hash = Large().ContentHash();
  FlatPartsCache cache;
  const auto first_row = [&] {
    return cache.Read(temp / "flat", hash, RowsPart("a/range_m", 0, 1)).status().code();
  };
  EXPECT_EQ(first_row(), Code::kOk);
  flat[flat.size() / 2] = static_cast<char>(flat[flat.size() / 2] ^ 1);
  Write(temp / "flat", flat);
  EXPECT_EQ(first_row(), Code::kOk) << "of which nobody looked at the rest again";
  cache.Forget(hash);
  EXPECT_EQ(first_row(), Code::kCorrupt);
}

}  // namespace
}  // namespace cairn
