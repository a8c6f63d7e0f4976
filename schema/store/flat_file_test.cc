#include "schema/store/flat_file.h"

#include <chrono>
#include <numeric>

#include "schema/flat_blob_testing.h"
#include "schema/store/testing.h"

namespace cairn {
namespace {

using flat_testing::Flat;
using store_testing::Bytes;
using store_testing::OddBlob;
using store_testing::Overwrite;
using store_testing::TempFolder;

Status Write(const TempFolder& temp, const std::string& bytes, const Hash& hash) {
  Result<FlatFileWriter> writer = FlatFileWriter::Create(temp / "part", hash);
  EXPECT_TRUE(writer.ok());
  for (std::size_t at = 0; at < bytes.size(); at += 100)
    if (Status status =
            writer.value().Write(std::as_bytes(std::span(std::string_view(bytes).substr(at, 100))));
        !status.ok())
      return status;
  return writer.value().Publish(temp / "whole");
}

TEST(FlatFile, RoundTripsEveryTypeAndShape) {
  const TempFolder temp;
  const Hash hash = OddBlob().ContentHash();
  ASSERT_TRUE(Write(temp, Flat(OddBlob()), hash).ok());
  EXPECT_EQ(temp.Files(), std::vector<std::string>{"whole"});
  EXPECT_TRUE(CheckFlatFile(temp / "whole", hash).ok());
  const Result<BlobPtr> read = ReadFlatFile(temp / "whole", hash);
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read.value()->fields(), OddBlob().fields());
}

TEST(FlatFile, OfOneThatWasJustWrittenPartsAreReadAsOfOneThatWasReadThrough) {
  const TempFolder temp;
  Blob blob;
  std::vector<double> values(50'000);
  std::iota(values.begin(), values.end(), 0.5);
  blob.PutVector("range_m", values);
  const std::string flat = Flat(blob);
  Result<FlatFileWriter> writer = FlatFileWriter::Create(temp / "part", blob.ContentHash());
  ASSERT_TRUE(writer.ok());
  for (std::size_t at = 0; at < flat.size(); at += 70'000)  // across chunks of 64 KiB
    ASSERT_TRUE(
        writer.value().Write(std::as_bytes(std::span(std::string_view(flat).substr(at, 70'000)))).ok());
  ASSERT_TRUE(writer.value().Publish(temp / "whole").ok());
  const FlatParts parts = writer.value().TakeParts(temp / "whole");
  const Result<FlatParts> opened = FlatParts::Open(temp / "whole", blob.ContentHash());
  ASSERT_TRUE(opened.ok());
  for (const std::int64_t first : {0, 8190, 49'999}) {
    const proto::BlobPart part = RowsPart("range_m", first, 1);
    const Result<BlobPtr> read = parts.Read(part);
    ASSERT_TRUE(read.ok()) << read.status().message();
    EXPECT_EQ(read.value()->Get<double>("range_m")[0], 0.5 + static_cast<double>(first));
    EXPECT_EQ(read.value()->fields(), opened.value().Read(part).value()->fields());
  }
  std::string bad = flat;
  bad.back() = static_cast<char>(bad.back() ^ 1);
  const auto bytes = std::as_bytes(std::span(bad));
  Overwrite(temp / "whole", {bytes.begin(), bytes.end()});
  EXPECT_TRUE(parts.Read(RowsPart("range_m", 0, 1)).ok());
  EXPECT_EQ(parts.Read(RowsPart("range_m", 49'999, 1)).status().code(), Code::kCorrupt);
}

TEST(FlatFile, OneThatIsThereStaysAndOneThatIsDamagedIsReplaced) {
  const TempFolder temp;
  const Hash hash = OddBlob().ContentHash();
  ASSERT_TRUE(Write(temp, Flat(OddBlob()), hash).ok());
  const auto date = std::filesystem::last_write_time(temp / "whole") - std::chrono::hours(1);
  std::filesystem::last_write_time(temp / "whole", date);
  ASSERT_TRUE(Write(temp, Flat(OddBlob()), hash).ok());
  EXPECT_EQ(std::filesystem::last_write_time(temp / "whole"), date);
  EXPECT_EQ(temp.Files(), std::vector<std::string>{"whole"});
  std::string bad = Flat(OddBlob());
  bad.back() = static_cast<char>(bad.back() ^ 1);
  const auto bytes = std::as_bytes(std::span(bad));
  Overwrite(temp / "whole", {bytes.begin(), bytes.end()});
  ASSERT_TRUE(Write(temp, Flat(OddBlob()), hash).ok());
  EXPECT_TRUE(CheckFlatFile(temp / "whole", hash).ok());
}

TEST(FlatFile, WhatIsCutOffOrNotWhatItsHashSaysIsNeverThere) {
  const TempFolder temp;
  const std::string flat = Flat(OddBlob());
  const Hash hash = OddBlob().ContentHash();
  EXPECT_EQ(Write(temp, flat.substr(0, flat.size() - 1), hash).code(), Code::kCorrupt);
  std::string lie = flat;
  lie.back() = static_cast<char>(lie.back() ^ 1);
  EXPECT_EQ(Write(temp, lie, hash).code(), Code::kCorrupt);
  EXPECT_EQ(Write(temp, flat + "x", hash).code(), Code::kCorrupt);
  EXPECT_TRUE(temp.Files().empty());
}

TEST(FlatFile, DamageAnywhereIsSeenWhenItIsReadAndWhenItIsChecked) {
  const TempFolder temp;
  const Hash hash = OddBlob().ContentHash();
  ASSERT_TRUE(Write(temp, Flat(OddBlob()), hash).ok());
  const std::vector<std::byte> good = Bytes(temp / "whole");
  for (std::size_t i = 0; i < good.size(); i += 3) {
    std::vector<std::byte> bad = good;
    bad[i] ^= std::byte{0x10};
    Overwrite(temp / "bad", bad);
    EXPECT_FALSE(CheckFlatFile(temp / "bad", hash).ok()) << i;
    EXPECT_FALSE(ReadFlatFile(temp / "bad", hash).ok()) << i;
    Overwrite(temp / "bad", {good.begin(), good.begin() + static_cast<std::ptrdiff_t>(i)});
    EXPECT_EQ(CheckFlatFile(temp / "bad", hash).code(), Code::kCorrupt) << i;
    EXPECT_EQ(ReadFlatFile(temp / "bad", hash).status().code(), Code::kCorrupt) << i;
  }
  EXPECT_EQ(CheckFlatFile(temp / "none", hash).code(), Code::kNotFound);
}

TEST(FlatFile, OneThatIsGivenUpLeavesNothing) {
  const TempFolder temp;
  {
    Result<FlatFileWriter> writer = FlatFileWriter::Create(temp / "part", Hash{});
    ASSERT_TRUE(writer.ok());
    EXPECT_EQ(temp.Files().size(), 1u);
    const FlatFileWriter moved = std::move(writer).value();
  }
  EXPECT_TRUE(temp.Files().empty());
  EXPECT_EQ(FlatFileWriter::Create(temp / "no/part", Hash{}).status().code(), Code::kNotFound);
}

}  // namespace
}  // namespace cairn
