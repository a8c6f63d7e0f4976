#include "datasets/common/text_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "datasets/testing.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

std::string Repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

class TextFile : public testing::Test {
 protected:
  void TearDown() override { SetTextLimits({}); }
  TestFolder folder_;
};

TEST_F(TextFile, ALittleGzipThatUnpacksToMuchIsStoppedOnTheWay) {
  const std::string path = folder_.Put("bomb.csv.gz", Repeated(std::string(1023, '1') + "\n", 8 << 10));
  EXPECT_LT(std::filesystem::file_size(path), 64U << 10) << "8 MB of text";
  SetTextLimits({.file_bytes = 4 << 20, .line_bytes = 1 << 20});
  EXPECT_NE(InputErrorOf([&] { (void)ReadText(path); }).find("bomb.csv.gz: more than 4 MB of text, unpacked"),
            std::string::npos);
  SetTextLimits({.file_bytes = 8 << 20, .line_bytes = 1 << 20});
  EXPECT_EQ(ReadText(path).size(), 8U << 20);
}

TEST_F(TextFile, ALineHasALimitHoweverItIsCutIntoParts) {
  const std::string path = folder_.Put("line.csv.gz", Repeated(std::string(1000, '1'), 3000));
  SetTextLimits({.file_bytes = 8 << 20, .line_bytes = 2 << 20});
  EXPECT_NE(InputErrorOf([&] { (void)ReadText(path); }).find("line.csv.gz: a line of more than 2 MB"),
            std::string::npos);
  const std::string lines = folder_.Put("lines.csv.gz", Repeated(std::string(1000, '1') + "\n", 3000));
  EXPECT_EQ(ReadText(lines).size(), 3'003'000U);
}

// Were it opened as files are, the test would never end.
TEST_F(TextFile, NobodyWaitsForAFifo) {
  const std::string path = folder_ / "fifo.csv";
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  EXPECT_NE(InputErrorOf([&] { (void)ReadText(path); }).find("fifo.csv: is a FIFO"), std::string::npos);
}

}  // namespace
}  // namespace cairn::datasets
