#include "schema/store/spool.h"

#include <algorithm>
#include <limits>

#include "schema/store/blob_file.h"
#include "schema/store/testing.h"

namespace cairn {
namespace {

using store_testing::Bytes;
using store_testing::TempFolder;
using store_testing::WithSmallFiles;

constexpr std::int64_t kSpoolRows = 3000, kSpoolColumns = 181;

std::vector<double> Values() {
  std::vector<double> values;
  for (std::int64_t i = 0; i < kSpoolRows * kSpoolColumns; ++i)
    values.push_back(0.1 * static_cast<double>(i));
  values[7] = std::numeric_limits<double>::quiet_NaN();
  return values;
}

// Row by row.
Array Spooled(const std::vector<double>& values, const std::filesystem::path& folder) {
  Spool spool(folder);
  for (std::int64_t row = 0; row < kSpoolRows; ++row)
    spool.Add(std::span(values).subspan(static_cast<std::size_t>(row * kSpoolColumns), kSpoolColumns));
  return spool.Take(DType::kF64, sizeof(double), {kSpoolRows, kSpoolColumns}).value();
}

TEST(Spool, GivesWhatWasAddedInMemoryAndOverAFileWithoutAName) {
  const TempFolder folder;
  const std::vector<double> values = Values();
  const Array all = Array::Of<double>({kSpoolRows, kSpoolColumns}, values);
  const Array here = Spooled(values, {}), there = Spooled(values, folder / "");
  EXPECT_FALSE(here.is_in_file());
  EXPECT_EQ(here, all);
  EXPECT_TRUE(there.is_in_file());
  EXPECT_EQ(there, all);
  there.LetGo(there.bytes());
  EXPECT_EQ(there, all) << "what was let go comes back";
  EXPECT_TRUE(folder.Files().empty());
}

TEST(Spool, OfAFewValuesThereIsNoFile) {
  const TempFolder folder;
  Spool spool(folder / "none");
  spool.Add(std::span<const double>(std::vector<double>{1, 2}));
  const Result<Array> array = spool.Take(DType::kF64, sizeof(double), {2});
  ASSERT_TRUE(array.ok()) << array.status().message();
  EXPECT_EQ(array.value(), Array::Vector<double>({1, 2}));
}

TEST(Spool, PiecesAreAllOfIt) {
  const TempFolder folder;
  const Array array = Spooled(Values(), folder / "");
  std::vector<std::byte> bytes;
  std::size_t pieces = 0;
  array.TakeInPieces([&](std::span<const std::byte> piece) {
    bytes.insert(bytes.end(), piece.begin(), piece.end());
    return ++pieces > 0;
  });
  EXPECT_GT(pieces, 4U);
  EXPECT_TRUE(std::ranges::equal(bytes, array.bytes()));
  pieces = 0;
  array.TakeInPieces([&](std::span<const std::byte>) { return ++pieces < 2; });
  EXPECT_EQ(pieces, 2U);
}

TEST(Spool, AFolderThatIsNotThereIsNamed) {
  const TempFolder folder;
  Spool spool(folder / "none");
  const std::vector<double> values = Values();
  spool.Add(std::span(values));
  const Result<Array> array = spool.Take(DType::kF64, sizeof(double), {kSpoolRows, kSpoolColumns});
  ASSERT_FALSE(array.ok());
  EXPECT_EQ(array.status().code(), Code::kNotFound);
  EXPECT_NE(array.status().message().find("/none: cannot write what is read"), std::string::npos);
}

Blob BlobWith(const Array& array, const std::vector<double>& zeros, const std::filesystem::path& folder) {
  Blob blob = store_testing::OddBlob();
  blob.Put("laser/range_m", array);
  blob.Put("map/cells", Spooled(zeros, folder));
  return blob;
}

TEST(Spool, AFileOfArraysOverFilesHasTheSameBytes) {
  const TempFolder folder;
  const std::vector<double> values = Values();
  std::vector<double> zeros(values.size(), 0);  // which are deflated
  for (std::size_t i = 0; i < zeros.size(); i += 10) zeros[i] = values[i];
  const Blob here = BlobWith(Spooled(values, {}), zeros, {}),
             there = BlobWith(Spooled(values, folder / ""), zeros, folder / "");
  ASSERT_TRUE(WriteBlobFile(folder / "here.h5", "log", here).ok());
  ASSERT_TRUE(WriteNewBlobFile(folder / "there.h5", "log", there).ok());
  EXPECT_EQ(Bytes(folder / "here.h5"), Bytes(folder / "there.h5"));
  const Result<BlobFile> read = ReadBlobFile(folder / "there.h5");
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read.value().blob.ContentHash(), here.ContentHash());
  EXPECT_EQ(WriteNewBlobFile(folder / "there.h5", "log", there).code(), Code::kRefused);
  ASSERT_TRUE(WriteBlobFile(folder / "there.h5", "poses", there).ok());
  EXPECT_EQ(ReadBlobFile(folder / "there.h5").value().kind, "poses");
  EXPECT_EQ(folder.Files().size(), 2U);
}

TEST(Spool, AFullDiskLeavesNothing) {
  const TempFolder folder;
  const std::vector<double> values = Values();
  EXPECT_TRUE(WithSmallFiles(2'000'000, [&] {
    Spool spool(folder / "");
    spool.Add(std::span(values));
    return spool.Take(DType::kF64, sizeof(double), {kSpoolRows, kSpoolColumns}).status().code() ==
           Code::kNoSpace;
  }));
  Blob blob;
  blob.Put("laser/range_m", Spooled(values, folder / ""));
  EXPECT_TRUE(WithSmallFiles(2'000'000, [&] {
    const Status status = WriteBlobFile(folder / "a.h5", "log", blob);
    return status.code() == Code::kNoSpace &&
           status.message().ends_with("a.h5: cannot write: no file may grow so large here (ulimit -f)");
  }));
  EXPECT_TRUE(folder.Files().empty());
}

}  // namespace
}  // namespace cairn
