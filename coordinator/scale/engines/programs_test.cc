#include "coordinator/scale/engines/programs.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

namespace cairn::coordinator {
namespace {

constexpr double kLong_s = 30 * 86400;

TEST(RunPrograms, GivesEachItsInputAndBringsWhatItSays) {
  const std::string much(1 << 20, 'x');
  const std::vector<ProgramOutput> outputs = RunPrograms(
      {{{"cat"}, much}, {{"sh", "-c", "cat; echo said >&2; exit 3"}, "in"}, {{"true"}, "not read"}}, kLong_s);
  ASSERT_EQ(outputs.size(), 3U);
  EXPECT_EQ(outputs[0].out, much);
  EXPECT_EQ(outputs[0].exit_code, 0);
  EXPECT_EQ(outputs[0].failure, "");
  EXPECT_EQ(outputs[1].out, "in");
  EXPECT_EQ(outputs[1].exit_code, 3);
  EXPECT_EQ(outputs[1].failure, "sh: said");
  EXPECT_EQ(outputs[2].exit_code, 0);
  EXPECT_EQ(RunPrograms({{{"sh", "-c", "echo sh: error: no >&2; exit 1"}, ""}}, kLong_s)[0].failure,
            "sh: error: no");
}

// Each waits for what the other writes: one after the other they would wait for ever.
TEST(RunPrograms, RunsThemSideBySide) {
  const std::string dir = testing::TempDir() + "/side_by_side." + std::to_string(::getpid());
  const auto meet = [&](const std::string& mine, const std::string& other) {
    return Program{{"sh", "-c",
                    "mkdir -p " + dir + "; : >" + dir + "/" + mine + "; until [ -e " + dir + "/" + other +
                        " ]; do sleep 0.01; done"},
                   ""};
  };
  for (const ProgramOutput& output : RunPrograms({meet("a", "b"), meet("b", "a")}, kLong_s))
    EXPECT_EQ(output.exit_code, 0) << output.failure;
  std::filesystem::remove_all(dir);
}

TEST(RunPrograms, OneThatIsNotThereOrHangsIsSaidAndKeepsNobody) {
  const std::vector<ProgramOutput> outputs =
      RunPrograms({{{"no-such-program-anywhere"}, ""}, {{"sh", "-c", "kill -9 $$"}, ""}}, kLong_s);
  EXPECT_EQ(outputs[0].failure, "no-such-program-anywhere: No such file or directory");
  EXPECT_EQ(outputs[1].failure, "sh: ended by signal 9");
  EXPECT_EQ(outputs[1].exit_code, -1);
  const ProgramOutput hangs = RunPrograms({{{"sleep", "1000000"}, ""}}, 0.05)[0];
  EXPECT_EQ(hangs.exit_code, -1);
  EXPECT_TRUE(hangs.failure.starts_with("sleep: no answer for")) << hangs.failure;
}

// As ssh leaves a master behind, which holds its pipes.
TEST(RunPrograms, WhatItLeavesRunningKeepsNobody) {
  const ProgramOutput output = RunPrograms({{{"sh", "-c", "sleep 1000 & echo $!"}, ""}}, kLong_s)[0];
  EXPECT_EQ(output.exit_code, 0);
  RunPrograms({{{"kill", output.out.substr(0, output.out.find('\n'))}, ""}}, kLong_s);
}

TEST(ShellWord, IsOneWordWhateverIsInIt) {
  for (const std::string text : {"plain", "", "two words", "it's", "$(reboot) `x` \\ \"", "-rf\n*"})
    EXPECT_EQ(RunPrograms({{{"sh", "-c", "printf %s " + ShellWord(text)}, ""}}, kLong_s)[0].out, text);
}

}  // namespace
}  // namespace cairn::coordinator
