#include "coordinator/cli/output/progress_line.h"

#include <gtest/gtest.h>

namespace cairn::cli {
namespace {

wire::JobInfo Info() {
  wire::JobInfo info;
  info.set_name("museum");
  info.set_stages(2);
  info.set_stage_name("landmarks");
  info.set_round(3);
  info.set_tasks(20);
  info.set_tasks_done(10);
  info.set_rounds_left(4);
  return info;
}

TEST(Duration, IsMinutesAndSecondsOrHours) {
  EXPECT_EQ(Duration(-1), "0:00");
  EXPECT_EQ(Duration(64.6), "1:05");
  EXPECT_EQ(Duration(7380), "2:03:00");
}

TEST(PartDone, CountsRoundsAndTheRoundsTasks) {
  EXPECT_DOUBLE_EQ(PartDone(Info()), 3.5 / 7);
  wire::JobInfo unknown = Info();
  unknown.set_rounds_left(0);
  EXPECT_LT(PartDone(unknown), 0);
}

TEST(ProgressLine, SaysStageTasksAndWhatIsLeft) {
  wire::JobInfo info = Info();
  EXPECT_EQ(ProgressLine(info, 200), "museum 1/2 landmarks [##########----------] 10/20 tasks") << "unknown";
  info.set_eta_s(10);
  info.set_note("iteration 3");
  EXPECT_EQ(ProgressLine(info, 200),
            "museum 1/2 landmarks [##########----------] about 0:10 left, 10/20 tasks, iteration 3");
}

TEST(LeftText, IsASpanWhereTheDataDecideWhatIsToCome) {
  wire::JobInfo info = Info();
  EXPECT_EQ(LeftText(info), "") << "unknown";
  info.set_eta_s(10);
  info.set_eta_least_s(8);
  info.set_eta_most_s(15);
  EXPECT_EQ(LeftText(info), "0:10") << "narrow";
  info.set_eta_least_s(5);
  info.set_eta_most_s(65);
  EXPECT_EQ(LeftText(info), "0:05 to 1:05");
  EXPECT_NE(ProgressLine(info, 200).find(" about 0:05 to 1:05 left,"), std::string::npos);
  info.set_eta_least_s(0.02);
  info.set_eta_most_s(0.2);
  EXPECT_EQ(LeftText(info), "0:01") << "not 0:00 to 0:00";
  info.set_eta_most_s(9);
  EXPECT_EQ(LeftText(info), "0:01 to 0:09");
}

TEST(ProgressLine, TheOnlyStageNeedsNoName) {
  wire::JobInfo info = Info();
  info.set_stages(1);
  EXPECT_EQ(ProgressLine(info, 200), "museum 1/1 [##########----------] 10/20 tasks");
}

TEST(ProgressLine, IsCutBetweenCharacters) {
  wire::JobInfo info = Info();
  info.set_name("ü");
  EXPECT_EQ(ProgressLine(info, 1), "");
  EXPECT_EQ(ProgressLine(info, 2), "ü");
}

}  // namespace
}  // namespace cairn::cli
