#include "coordinator/store/served_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <iterator>

#include "coordinator/server/testing/hub_fixture.h"

namespace cairn::coordinator {
namespace {

class ServedFile : public ::testing::Test {
 protected:
  TempFolder temp_;
  const std::filesystem::path path_ = temp_.path() / "served";
};

TEST_F(ServedFile, ComesBackAsItWasWritten) {
  EXPECT_EQ(ReadServed(path_).value(), 0) << "none yet";
  ASSERT_TRUE(WriteServed(path_, 123456.789).ok());
  EXPECT_EQ(ReadServed(path_).value(), 123456.789);
  ASSERT_TRUE(WriteServed(path_, 0).ok());
  EXPECT_EQ(ReadServed(path_).value(), 0);
}

TEST_F(ServedFile, AnyFlippedByteAndAnyTruncationIsSeen) {
  ASSERT_TRUE(WriteServed(path_, 86400).ok());
  std::ifstream file(path_);
  const std::string good{std::istreambuf_iterator<char>(file), {}};
  ASSERT_GT(good.size(), 32u);
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 1);
    std::ofstream(path_) << bad;
    EXPECT_EQ(ReadServed(path_).status().code(), Code::kCorrupt) << i;
    std::ofstream(path_) << good.substr(0, i);
    EXPECT_EQ(ReadServed(path_).status().code(), Code::kCorrupt) << i;
  }
}

// Whoever may write the folder put it there: nobody waits for its writer, or reads to the end of it.
TEST_F(ServedFile, WhatIsNoSmallFileIsRefused) {
  ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  EXPECT_EQ(ReadServed(path_).status().code(), Code::kRefused);
  std::filesystem::remove(path_);
  std::filesystem::create_directory(path_);
  EXPECT_EQ(ReadServed(path_).status().code(), Code::kRefused);
  std::filesystem::remove(path_);
  std::ofstream(path_).close();
  std::filesystem::resize_file(path_, std::uintmax_t{1} << 40);
  EXPECT_EQ(ReadServed(path_).status().code(), Code::kCorrupt);
}

}  // namespace
}  // namespace cairn::coordinator
