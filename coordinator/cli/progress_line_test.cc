#include "coordinator/cli/progress_line.h"

#include <gtest/gtest.h>

namespace cairn::cli {
namespace {

wire::JobInfo Info() {
  wire::JobInfo info;
  info.set_name("museum");
  info.set_stages(2);
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
  EXPECT_EQ(ProgressLine(Info(), 10, 0, 200), "museum 1/2 [##########----------] 0:10 left, 10/20 tasks");
}

TEST(ProgressLine, GoesByWhatWasDoneSinceItBegan) {
  // A resumed job began at a quarter: the second quarter took 10 s, so the other half takes 20 s.
  EXPECT_NE(ProgressLine(Info(), 10, 0.25, 200).find("0:20 left"), std::string::npos);
}

TEST(ProgressLine, IsCutBetweenCharacters) {
  wire::JobInfo info = Info();
  info.set_name("ü");
  EXPECT_EQ(ProgressLine(info, 0, 0, 1), "");
  EXPECT_EQ(ProgressLine(info, 0, 0, 2), "ü");
}

}  // namespace
}  // namespace cairn::cli
