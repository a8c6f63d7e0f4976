#include "datasets/import/trajectories.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/export/export.h"
#include "datasets/testing.h"
#include "datasets/testing_result.h"

namespace cairn::datasets {
namespace {

class ImportTrajectoriesTest : public ImportTest {
 protected:
  ImportReport Import(const std::string& text, const std::string& name = "Rosa.tum") {
    log_ = Blob();
    return ImportTrajectories({{folder_.Put(name, text)}, {}, false}, &log_);
  }
  std::string Refusal(const std::string& text) {
    return InputErrorOf([&] { Import(text); });
  }
};

TEST_F(ImportTrajectoriesTest, QuaternionsAndHeadingsBecomePoses) {
  const double half = std::sqrt(0.5);
  Import("# time x y z\n1 2 3 0 0 0 0 1\n2 3 4 0 0 0 " + std::to_string(half) + " " + std::to_string(-half) +
             "\n",
         "Rosa.txt.gz");
  EXPECT_EQ(log_.Texts("robots"), (std::vector<std::string>{"Rosa"}));
  EXPECT_EQ(Column<double>("robot/0/poses/time_s"), (std::vector<double>{1, 2}));
  EXPECT_EQ(Column<double>("robot/0/poses/x_m"), (std::vector<double>{2, 3}));
  EXPECT_NEAR(Column<double>("robot/0/poses/heading_rad")[1], -std::numbers::pi / 2, 1e-9);
  Import("1 2 3 4\n");
  EXPECT_NEAR(Column<double>("robot/0/poses/heading_rad")[0], 4 - 2 * std::numbers::pi, 1e-12);
}

TEST_F(ImportTrajectoriesTest, WhatWentOutComesBack) {
  const auto files = ExportTum(SmallResult(), folder_ / "out").value();
  ImportTrajectories({files, {"Rosa", "a b"}, false}, &log_);
  EXPECT_EQ(log_.Texts("robots"), (std::vector<std::string>{"Rosa", "a b"}));
  const Blob result = SmallResult();
  for (const char* robot : {"robot/0/poses/", "robot/1/poses/"}) {
    const std::string prefix = robot;
    const auto heading = result.Get<double>(prefix + "mode_heading_rad");
    const auto back = Column<double>(prefix + "heading_rad");
    ASSERT_EQ(back.size(), heading.size());
    for (std::size_t i = 0; i < back.size(); ++i)
      EXPECT_NEAR(std::remainder(back[i] - heading[i], 2 * M_PI), 0, 1e-12);
    const auto x = result.Get<double>(prefix + "mode_x_m");
    EXPECT_EQ(Column<double>(prefix + "x_m"), (std::vector<double>{x.begin(), x.end()}));
  }
}

TEST_F(ImportTrajectoriesTest, WhatWentOutToKittiAndEurocComesBack) {
  const Blob result = SmallResult();
  const auto kitti = ExportKitti(result, folder_ / "kitti").value();
  const auto euroc = ExportEuroc(result, folder_ / "euroc").value();
  for (const TrajectoryImportOptions& options :
       {TrajectoryImportOptions{.files = {kitti[0], kitti[2]},
                                .format = TrajectoryImportOptions::Format::kKitti,
                                .times = {kitti[1], kitti[3]}},
        TrajectoryImportOptions{.files = euroc, .format = TrajectoryImportOptions::Format::kEuroc}}) {
    const ImportReport report = ImportTrajectories(options, &log_);
    EXPECT_TRUE(report.warnings.empty());
    EXPECT_EQ(log_.Texts("robots"), (std::vector<std::string>{"Rosa", "a_b"}));
    EXPECT_EQ(Column<double>("robot/1/poses/time_s"), (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(Column<double>("robot/1/poses/y_m"), (std::vector<double>{0, 0, 2}));
    const auto heading = Column<double>("robot/1/poses/heading_rad");
    EXPECT_NEAR(heading[1], M_PI / 2, 1e-12);
    EXPECT_NEAR(heading[2], 3, 1e-12);
    log_ = Blob();
  }
}

TEST_F(ImportTrajectoriesTest, QuaternionsWithTheRealPartAtTheOtherEndAreDoubted) {
  const std::string first = "1 0 0 0 1 0 0 0\n2 1 0 0 0.995 0 0 0.0998\n3 2 0 0 0.98 0 0 0.1987\n";
  const std::string last = "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0.0998 0.995\n3 2 0 0 0 0 0.1987 0.98\n";
  const ImportReport doubted = Import(first);
  ASSERT_FALSE(doubted.unit_doubts.empty());
  ExpectContains(doubted.unit_doubts.back(), "Rosa.tum: 3 of its 3 poses lie on their sides or backs");
  ExpectContains(doubted.unit_doubts.back(), "TUM's have it last: qx qy qz qw");
  EXPECT_TRUE(Import(last).unit_doubts.empty());
  const auto euroc = [&](std::string text) {
    std::ranges::replace(text, ' ', ',');
    TrajectoryImportOptions options{.files = {folder_.Put("a.csv", text)},
                                    .format = TrajectoryImportOptions::Format::kEuroc};
    return ImportTrajectories(options, &log_).unit_doubts;
  };
  const auto doubts = euroc("1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0.6 0.8\n3 2 0 0 0 0 0.8 0.6\n");
  ASSERT_FALSE(doubts.empty()) << "a robot that has turned";
  ExpectContains(doubts.back(), "last, as TUM's files have it (`import tum`)");
}

// A camera that looks ahead, 1.6 m up, on a robot that goes 5 m ahead and turns to its left.
TEST_F(ImportTrajectoriesTest, KittisOwnPosesAreACameras) {
  const std::string poses = "1 0 0 0 0 1 0 0 0 0 1 0\n0 0 -1 -2 0 1 0 -0.1 1 0 0 5\n";
  TrajectoryImportOptions options{.files = {folder_.Put("00.txt", poses)},
                                  .format = TrajectoryImportOptions::Format::kKitti,
                                  .times = {folder_.Put("times.txt", "0.0e+00\n1.037e-01\n")},
                                  .camera_axes = true};
  EXPECT_TRUE(ImportTrajectories(options, &log_).warnings.empty()) << "0.1 m up";
  EXPECT_EQ(Column<double>("robot/0/poses/time_s"), (std::vector<double>{0, 0.1037}));
  EXPECT_EQ(Column<double>("robot/0/poses/x_m")[1], 5);
  EXPECT_EQ(Column<double>("robot/0/poses/y_m")[1], 2);
  EXPECT_NEAR(Column<double>("robot/0/poses/heading_rad")[1], M_PI / 2, 1e-12);
  options.camera_axes = false;
  const ImportReport upright = ImportTrajectories(options, &log_);
  ASSERT_EQ(upright.warnings.size(), 2U);
  ExpectContains(upright.warnings[1], "tilted by up to 90");
  ASSERT_EQ(upright.unit_doubts.size(), 1U);
  ExpectContains(upright.unit_doubts[0], "it goes 5.000000 m up and down, and 0.100000 m along its y axis");
  ExpectContains(upright.unit_doubts[0], "with --camera-axes");
  // The other way round: a robot that goes 5 m to its left.
  options.files = {folder_.Put("up.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n0 -1 0 0 1 0 0 5 0 0 1 0\n")};
  EXPECT_TRUE(ImportTrajectories(options, &log_).unit_doubts.empty());
  options.camera_axes = true;
  const ImportReport lying = ImportTrajectories(options, &log_);
  ASSERT_EQ(lying.unit_doubts.size(), 1U);
  ExpectContains(lying.unit_doubts[0], "without --camera-axes");
}

TEST_F(ImportTrajectoriesTest, WhatIsNoPoseOfKittiOrEurocIsNamed) {
  const auto refusal = [&](const std::string& poses, const std::string& times) {
    return InputErrorOf([&] {
      ImportTrajectories({.files = {folder_.Put("a.kitti", poses)},
                          .format = TrajectoryImportOptions::Format::kKitti,
                          .times = {folder_.Put("a.times", times)}},
                         &log_);
    });
  };
  const std::string pose = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  ExpectContains(refusal(pose + pose, "1\n"), "it has 2 poses, ");
  ExpectContains(refusal(pose, "1\n2\n"), " 2 times");
  ExpectContains(refusal(pose + pose, "1\n1\n"), "a.kitti:2: time does not run forward");
  ExpectContains(refusal("2 0 0 0 0 1 0 0 0 0 1 0\n", "1\n"), "a.kitti:1: no rotation: its length is 2");
  ExpectContains(refusal(pose + "1 0 0 0 0 1 0 0 0 0 -1 0\n", "1\n2\n"),
                 "a.kitti:2: no rotation: its determinant is -1.000000: one axis points the other way");
  ExpectContains(refusal("1 0 0 0 1 0 0 0 0 0 1 0\n", "1\n"), "a.kitti:1: no rotation: its determinant is 0");
  ExpectContains(refusal("1 0 0 0 0 1 0 0\n", "1\n"), "a.kitti:1: wrong number of values: 8 where 12");
  ExpectContains(refusal("1 0 0 1e8 0 1 0 0 0 0 1 0\n", "1\n"), "a.kitti:1: no place on Earth");
  ExpectContains(InputErrorOf([&] {
                   ImportTrajectories({.files = {folder_.Put("a.kitti", pose)},
                                       .format = TrajectoryImportOptions::Format::kKitti},
                                      &log_);
                 }),
                 "0 files of times for 1 trajectories");
  ExpectContains(InputErrorOf([&] {
                   ImportTrajectories({.files = {folder_.Put("a.csv", "#timestamp, x\n1000,1,2,3,1,0,0\n")},
                                       .format = TrajectoryImportOptions::Format::kEuroc},
                                      &log_);
                 }),
                 "a.csv:2: wrong number of values: 7 where 8 and more");
}

TEST_F(ImportTrajectoriesTest, TiltIsSaidAndBadLinesAreNamed) {
  const ImportReport report = Import("1 0 0 0 0 0 0 1\n2 0 0 2 0.5 0 0 0.8660254\n");
  ASSERT_EQ(report.warnings.size(), 2U);
  ExpectContains(report.warnings[0], "heights differ by 2.0");
  ExpectContains(report.warnings[1], "tilted by up to 60.0");
  ExpectContains(Refusal("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0\n"), "Rosa.tum:2: wrong number of values: 7");
  ExpectContains(Refusal("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 0\n"), "Rosa.tum:2: no quaternion");
  ExpectContains(Refusal("1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"), "Rosa.tum:2: time does not run forward");
  ExpectContains(Refusal("1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"), "are times rounded to whole seconds?");
  ExpectContains(Refusal("1 nan 0 0 0 0 0 1\n"), "Rosa.tum:1: not finite");
  ExpectContains(Refusal("#\n"), "there is no pose in it");
  const std::string file = folder_.Put("a.tum", "1 0 0 0\n");
  ExpectContains(InputErrorOf([&] { ImportTrajectories({{file, file}, {}, false}, &log_); }),
                 "a second robot is called 'a'");
  ExpectContains(InputErrorOf([&] { ImportTrajectories({{file}, {"a", "b"}, false}, &log_); }),
                 "2 names for 1 trajectories");
}

}  // namespace
}  // namespace cairn::datasets
