#include "schema/store/checksum_trailer.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <thread>
#include <utility>
#include <vector>

#include "schema/store/blob_file.h"
#include "schema/store/hdf5_handle.h"
#include "schema/store/testing.h"

namespace cairn {
namespace {

using store_testing::Bytes;
using store_testing::OddBlob;
using store_testing::Overwrite;
using store_testing::TempFolder;

TEST(Trailer, AStoredFileComesBack) {
  const TempFolder folder;
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "blob", OddBlob()).ok());
  const Result<BlobFile> read = ReadStoredFile(folder / "a.h5");
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read.value().blob.ContentHash(), OddBlob().ContentHash());
  EXPECT_EQ(ReadStoredFile(folder / "none.h5").status().code(), Code::kNotFound);
}

// Zeros, of which a small file may hold as many as its maker likes.
TEST(StoredFile, WhatUnpacksToFarMoreThanItsKindDoesIsDamaged) {
  const TempFolder folder;
  Blob blob;
  blob.PutVector("zeros", std::vector<std::uint8_t>(std::size_t{8} << 20));
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "blob", blob).ok());
  ASSERT_LT(std::filesystem::file_size(folder / "a.h5"), 80'000u);
  EXPECT_TRUE(ReadStoredFile(folder / "a.h5").ok());
  EXPECT_TRUE(ReadStoredFile(folder / "a.h5", std::uint64_t{8} << 20).ok());
  const Status status = ReadStoredFile(folder / "a.h5", (std::uint64_t{8} << 20) - 1).status();
  EXPECT_EQ(status.code(), Code::kCorrupt);
  EXPECT_NE(status.message().find("more than 8.4 MB unpacked"), std::string::npos) << status.message();
}

#ifndef CAIRN_SANITIZED
// Reads it with no more than half of `bytes` of memory, says what came of it, and ends.
[[noreturn]] void ReadForWantOf(std::size_t bytes, const std::filesystem::path& path) {
  std::ifstream self("/proc/self/statm");
  rlim_t pages = 0;
  self >> pages;
  const rlim_t most = pages * static_cast<rlim_t>(::getpagesize()) + bytes / 2;
  const rlimit limit{most, most};
  ::setrlimit(RLIMIT_AS, &limit);
  const Status status = ReadStoredFile(path).status();
  std::cerr << status.message() << std::endl;
  ::_exit(static_cast<int>(status.code()));
}

// Else no coordinator would begin on a store with such a file; one that is as large as it says may be whole.
TEST(StoredFile, WhereItTakesAllMemoryItIsDamagedIfItUnpacksToFarMoreThanItHas) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // a process of its own has no free memory of other tests
  const TempFolder folder;
  constexpr std::size_t kSize = std::size_t{96} << 20;
  for (const auto& [value, code] : {std::pair{0, Code::kCorrupt}, {1, Code::kIo}}) {
    Blob blob;
    blob.PutVector("bytes", std::vector<std::uint8_t>(kSize, static_cast<std::uint8_t>(value)));
    ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "blob", blob).ok());
    EXPECT_EXIT(ReadForWantOf(kSize, folder / "a.h5"), testing::ExitedWithCode(static_cast<int>(code)),
                "there is not the memory");
  }
}
#endif

TEST(Trailer, AnyFlippedByteIsSeen) {
  const TempFolder folder;
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "blob", OddBlob()).ok());
  std::vector<std::byte> bytes = Bytes(folder / "a.h5");
  ASSERT_TRUE(store::CheckTrailer(bytes, "a").ok());
  for (std::byte& byte : bytes) {
    byte ^= std::byte{1};
    ASSERT_EQ(store::CheckTrailer(bytes, "a").code(), Code::kCorrupt);
    byte ^= std::byte{1};
  }
  bytes[bytes.size() / 2] ^= std::byte{1};
  Overwrite(folder / "a.h5", bytes);
  const Status status = ReadStoredFile(folder / "a.h5").status();
  EXPECT_EQ(status.code(), Code::kCorrupt);
  EXPECT_EQ(status.message(),
            (folder / "a.h5").string() + ": damaged: its bytes are not those that were written");
}

// The name is given to and fro between a stored file and one that holds something else and is damaged.
TEST(Trailer, WhatHasTheNameAMomentLaterIsNotRead) {
  const TempFolder folder;
  ASSERT_TRUE(WriteBlobFile(folder / "right.h5", "blob", OddBlob()).ok());
  Blob other = OddBlob();
  other.Put("another", Array::Scalar(1.0));
  ASSERT_TRUE(WriteBlobFile(folder / "wrong.h5", "blob", other).ok());
  std::vector<std::byte> bytes = Bytes(folder / "wrong.h5");
  bytes.back() ^= std::byte{1};
  Overwrite(folder / "wrong.h5", bytes);
  std::filesystem::create_hard_link(folder / "right.h5", folder / "a.h5");
  std::atomic<bool> stop = false;
  std::thread swapper([&] {
    for (int i = 0; !stop; ++i) {
      std::filesystem::create_hard_link(folder / (i % 2 == 0 ? "wrong.h5" : "right.h5"), folder / "next.h5");
      std::filesystem::rename(folder / "next.h5", folder / "a.h5");
    }
  });
  int right = 0, damaged = 0;
  while (right < 100 || damaged < 100) {
    const Result<BlobFile> read = ReadStoredFile(folder / "a.h5");
    if (read.ok()) {
      ++right;
      if (read.value().blob.ContentHash() == OddBlob().ContentHash()) continue;
      ADD_FAILURE() << "the trailer of one file was looked at, the data of another read";
      break;
    }
    ++damaged;
    EXPECT_EQ(read.status().code(), Code::kCorrupt) << read.status().message();
  }
  stop = true;
  swapper.join();
}

TEST(Trailer, AnyTruncationIsSeen) {
  const TempFolder folder;
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "blob", OddBlob()).ok());
  const std::vector<std::byte> bytes = Bytes(folder / "a.h5");
  for (std::size_t size = 0; size < bytes.size(); ++size)
    ASSERT_EQ(store::CheckTrailer(std::span(bytes).first(size), "a").code(), Code::kCorrupt) << size;
}

TEST(Trailer, WhereItIsGoneTheFileIsReadOnlyByWhoeverAsksForItAndNeverInAStore) {
  const TempFolder folder;
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "blob", OddBlob()).ok());
  std::vector<std::byte> bytes = Bytes(folder / "a.h5");
  bytes.resize(bytes.size() - store::kTrailerBytes);
  Overwrite(folder / "a.h5", bytes);
  EXPECT_EQ(ReadStoredFile(folder / "a.h5").status().code(), Code::kCorrupt);
  const Status status = ReadBlobFile(folder / "a.h5").status();
  EXPECT_EQ(status.code(), Code::kCorrupt);
  EXPECT_NE(status.message().find("another program has changed it"), std::string::npos) << status.message();
  const Result<BlobFile> read =
      ReadBlobFile(folder / "a.h5", {.only = {}, .without = {}, .changed_too = true});
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_TRUE(read.value().changed);
  EXPECT_EQ(read.value().blob.ContentHash(), OddBlob().ContentHash());
}

// As h5py and h5edit do it.
TEST(Trailer, AChangeThroughHdf5IsSeen) {
  const TempFolder folder;
  const std::string path = folder / "a.h5";
  ASSERT_TRUE(WriteBlobFile(path, "blob", OddBlob()).ok());
  {
    const store::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    const store::Handle data(H5Dopen2(file.get(), "types/i32", H5P_DEFAULT), H5Dclose);
    const std::int32_t values[3] = {0, -1, 2147483647};  // they were -1, 0, …
    ASSERT_GE(H5Dwrite(data.get(), H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), 0);
  }
  const Status status = ReadBlobFile(path).status();
  EXPECT_NE(status.message().find("another program has changed it"), std::string::npos) << status.message();
  const Result<BlobFile> read = ReadBlobFile(path, {.only = {}, .without = {}, .changed_too = true});
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_TRUE(read.value().changed);
  EXPECT_EQ(read.value().blob.Get<std::int32_t>("types/i32")[1], -1);
}

TEST(Trailer, AFileOfAnotherProgramNeedsNone) {
  const TempFolder folder;
  const std::string path = folder / "a.h5";
  {
    const store::Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    const store::Handle one(H5Screate(H5S_SCALAR), H5Sclose);
    const std::int64_t format = 1;
    const store::Handle a(
        H5Acreate2(file.get(), "cairn_format", H5T_STD_I64LE, one.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    ASSERT_GE(H5Awrite(a.get(), H5T_NATIVE_INT64, &format), 0);
    const store::Handle text(H5Tcopy(H5T_C_S1), H5Tclose);
    const store::Handle b(
        H5Acreate2(file.get(), "cairn_kind", text.get(), one.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    ASSERT_GE(H5Awrite(b.get(), text.get(), "x"), 0);
  }
  const Result<BlobFile> read = ReadBlobFile(path);
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_FALSE(read.value().changed);
}

// Fletcher-32 counts in ones' complement: two bytes of 0xFF are to it what two of 0x00 are.
TEST(Trailer, DamageThatFletcherTakesForNothingIsSeen) {
  const TempFolder folder;
  constexpr std::size_t kChanges = 80;
  Blob blob;
  std::vector<std::int32_t> landmark(2 * kChanges);
  for (std::size_t i = 0; i < landmark.size(); ++i) landmark[i] = i % 3 == 0 ? -1 : i % 3 == 1 ? 0 : 7;
  blob.PutVector<std::int32_t>("map_landmark", landmark);
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "landmark_map", blob).ok());
  const std::vector<std::byte> good = Bytes(folder / "a.h5");
  const auto found = std::ranges::search(good, std::as_bytes(std::span(landmark)));
  ASSERT_FALSE(found.empty());
  const auto begin = static_cast<std::size_t>(found.begin() - good.begin());
  std::size_t changes = 0, unseen_by_fletcher = 0;
  for (std::size_t i = 0; i < landmark.size() && changes < kChanges; ++i) {
    if (landmark[i] == 7) continue;
    ++changes;
    std::vector<std::byte> bad = good;
    for (std::size_t k = 0; k < 4; ++k) bad[begin + 4 * i + k] ^= std::byte{0xFF};
    Overwrite(folder / "b.h5", bad);
    const Status status = ReadBlobFile(folder / "b.h5").status();
    ASSERT_EQ(status.code(), Code::kCorrupt) << i;
    if (status.message().find("its checksum is wrong") != std::string::npos) continue;
    ++unseen_by_fletcher;
    EXPECT_NE(status.message().find("its bytes are not those that were written"), std::string::npos)
        << status.message();
  }
  EXPECT_EQ(changes, kChanges);
  EXPECT_GT(unseen_by_fletcher, kChanges / 2);
}

}  // namespace
}  // namespace cairn
