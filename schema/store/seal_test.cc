#include "schema/store/seal.h"

#include <gtest/gtest.h>

#include <vector>

#include "schema/store/blob_file.h"
#include "schema/store/testing.h"

namespace cairn {
namespace {

using store_testing::Bytes;
using store_testing::OddBlob;
using store_testing::Overwrite;
using store_testing::TempFolder;

TEST(Seal, AStoredFileComesBack) {
  const TempFolder folder;
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "blob", OddBlob()).ok());
  const Result<BlobFile> read = ReadStoredFile(folder / "a.h5");
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read.value().blob.ContentHash(), OddBlob().ContentHash());
  EXPECT_EQ(ReadStoredFile(folder / "none.h5").status().code(), Code::kNotFound);
}

TEST(Seal, AnyFlippedByteIsSeen) {
  const TempFolder folder;
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "blob", OddBlob()).ok());
  std::vector<std::byte> bytes = Bytes(folder / "a.h5");
  ASSERT_TRUE(store::CheckSeal(bytes, "a").ok());
  for (std::byte& byte : bytes) {
    byte ^= std::byte{1};
    ASSERT_EQ(store::CheckSeal(bytes, "a").code(), Code::kCorrupt);
    byte ^= std::byte{1};
  }
  bytes[bytes.size() / 2] ^= std::byte{1};
  Overwrite(folder / "a.h5", bytes);
  const Status status = ReadStoredFile(folder / "a.h5").status();
  EXPECT_EQ(status.code(), Code::kCorrupt);
  EXPECT_EQ(status.message(),
            (folder / "a.h5").string() + ": damaged: its bytes are not those that were written");
}

TEST(Seal, AnyTruncationIsSeen) {
  const TempFolder folder;
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "blob", OddBlob()).ok());
  const std::vector<std::byte> bytes = Bytes(folder / "a.h5");
  for (std::size_t size = 0; size < bytes.size(); ++size)
    ASSERT_EQ(store::CheckSeal(std::span(bytes).first(size), "a").code(), Code::kCorrupt) << size;
}

TEST(Seal, AFileWithoutOneIsReadForAStrangersButNotForTheStore) {
  const TempFolder folder;
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "blob", OddBlob()).ok());
  std::vector<std::byte> bytes = Bytes(folder / "a.h5");
  bytes.resize(bytes.size() - store::kSealBytes);
  Overwrite(folder / "a.h5", bytes);
  EXPECT_TRUE(ReadBlobFile(folder / "a.h5").ok());
  EXPECT_EQ(ReadStoredFile(folder / "a.h5").status().code(), Code::kCorrupt);
}

}  // namespace
}  // namespace cairn
