#include "schema/command_line/renamed.h"

#include <gtest/gtest.h>

namespace cairn::cli {
namespace {

TEST(ArgumentNow, KnowsFlagsAndTheWordsThatTheyTake) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(ArgumentNow("out.h5", "--press-m"), "--contact-m");
  EXPECT_EQ(ArgumentNow("out.h5", "--press-m=0.3"), "--contact-m=0.3");
  EXPECT_EQ(ArgumentNow("coordinator", "--log-json"), "--log-format=json");
  EXPECT_EQ(ArgumentNow("--sensor", "press"), "contact");
  EXPECT_EQ(ArgumentNow("out.h5", "--sensor=press"), "--sensor=contact");
  EXPECT_NE(testing::internal::GetCapturedStderr().find("'--press-m' is called '--contact-m' now"),
            std::string::npos);
  testing::internal::CaptureStderr();
  EXPECT_EQ(ArgumentNow("loop", "press"), "press");  // a file of that name
  EXPECT_EQ(ArgumentNow("--sensor", "range-bearing"), "range-bearing");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ArgumentsNow, AreAllWordsUpToTwoDashes) {
  std::vector<std::string> given = {"cairn-worker", "--log-json", "--sensor", "press", "--", "--log-json"};
  std::vector<char*> words;
  for (std::string& word : given) words.push_back(word.data());
  testing::internal::CaptureStderr();
  const std::vector<std::string> now = ArgumentsNow(&words);
  testing::internal::GetCapturedStderr();
  EXPECT_EQ(std::vector<std::string>(words.begin(), words.end()),
            (std::vector<std::string>{"cairn-worker", "--log-format=json", "--sensor", "contact", "--",
                                      "--log-json"}));
}

}  // namespace
}  // namespace cairn::cli
