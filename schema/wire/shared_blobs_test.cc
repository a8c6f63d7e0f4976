#include "schema/wire/shared_blobs.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <string>

namespace cairn::wire {
namespace {

std::vector<NamedBlob> Some() {
  Blob one, two;
  one.PutVector<double>("a/x_m", {1, 2, 3});
  one.Put("empty", Array::Of<float>({2, 0, 3}, std::vector<float>{}));
  one.Put("names", Array::Texts({"one", "three"}));
  two.PutVector<std::uint8_t>("u", std::vector<std::uint8_t>(10'000, 7));
  return {NameBlob(std::make_shared<const Blob>(one)), NameBlob(std::make_shared<const Blob>(two)),
          NameBlob(std::make_shared<const Blob>())};
}

// As a process that was started has it: a descriptor of its own.
int Inherited(const SharedMemory& memory) { return ::dup(memory.descriptor()); }

std::string BytesOf(const SharedMemory& memory) {
  std::string bytes(static_cast<std::size_t>(::lseek(memory.descriptor(), 0, SEEK_END)), '\0');
  EXPECT_EQ(::pread(memory.descriptor(), bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
  return bytes;
}

int MemoryOf(const std::string& bytes, bool sealed = true) {
  const int fd = ::memfd_create("test", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  EXPECT_EQ(::write(fd, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  const int seals = sealed ? F_SEAL_WRITE | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL : 0;
  EXPECT_EQ(::fcntl(fd, F_ADD_SEALS, seals), 0);
  return fd;
}

TEST(SharedBlobs, AreReadWhereTheyLieAndOutliveTheirWriter) {
  Result<SharedMemory> memory = ShareBlobs(Some());
  ASSERT_TRUE(memory.ok()) << memory.status().message();
  const int fd = Inherited(memory.value());
  memory = SharedMemory();
  const Result<std::vector<NamedBlob>> back = TakeSharedBlobs(fd);
  ASSERT_TRUE(back.ok()) << back.status().message();
  ASSERT_EQ(back.value().size(), Some().size());
  for (std::size_t i = 0; i < Some().size(); ++i) {
    EXPECT_EQ(back.value()[i].hash, Some()[i].hash);
    EXPECT_EQ(back.value()[i].blob->fields(), Some()[i].blob->fields());
    for (const auto& [name, array] : back.value()[i].blob->fields())
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.bytes().data()) % 64, 0u) << name;
  }
}

TEST(SharedBlobs, NobodyCanChangeThem) {
  const Result<SharedMemory> memory = ShareBlobs(Some());
  ASSERT_TRUE(memory.ok());
  EXPECT_EQ(::pwrite(memory.value().descriptor(), "x", 1, 0), -1);
  EXPECT_NE(::ftruncate(memory.value().descriptor(), 1), 0);
}

TEST(SharedBlobs, WhatIsNotSealedIsRefused) {
  const Result<SharedMemory> memory = ShareBlobs(Some());
  ASSERT_TRUE(memory.ok());
  EXPECT_TRUE(TakeSharedBlobs(MemoryOf(BytesOf(memory.value()))).ok());
  EXPECT_EQ(TakeSharedBlobs(MemoryOf(BytesOf(memory.value()), false)).status().code(), Code::kCorrupt);
  EXPECT_EQ(TakeSharedBlobs(::open("/dev/null", O_RDONLY)).status().code(), Code::kCorrupt);
}

TEST(SharedBlobs, TruncatedAtAnyByteTheyAreRefused) {
  const Result<SharedMemory> memory = ShareBlobs(Some());
  ASSERT_TRUE(memory.ok());
  const std::string bytes = BytesOf(memory.value());
  for (std::size_t length = 0; length < bytes.size(); length += length < 1024 ? 1 : 97)
    EXPECT_EQ(TakeSharedBlobs(MemoryOf(bytes.substr(0, length))).status().code(), Code::kCorrupt) << length;
}

// Padding holds nothing, and a bit of the index may say the same in another way.
TEST(SharedBlobs, AFlippedBitNeverGivesAnotherBlob) {
  const Result<SharedMemory> memory = ShareBlobs(Some());
  ASSERT_TRUE(memory.ok());
  const std::string bytes = BytesOf(memory.value());
  std::size_t refused = 0;
  for (std::size_t at = 0; at < bytes.size(); at += at < 1024 ? 1 : 97) {
    std::string flipped = bytes;
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << at % 8));
    const Result<std::vector<NamedBlob>> back = TakeSharedBlobs(MemoryOf(flipped));
    refused += !back.ok();
    if (!back.ok()) continue;
    for (const NamedBlob& named : back.value()) EXPECT_EQ(named.blob->ContentHash(), named.hash) << at;
  }
  EXPECT_GT(refused, 100u);
}

}  // namespace
}  // namespace cairn::wire
