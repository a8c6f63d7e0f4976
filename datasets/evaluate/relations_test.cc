#include "datasets/evaluate/relations.h"

#include <cmath>
#include <numbers>

#include "datasets/import/recorded/carmen.h"
#include "datasets/testing.h"
#include "datasets/testing_result.h"

namespace cairn::datasets {
namespace {

constexpr double kPiOfRelations = std::numbers::pi;

// 1 m a second along x for 10 s, then up.
Track Corner() { return {{0, 10, 20}, {{0, 0, 0}, {10, 0, 0}, {10, 10, kPiOfRelations / 2}}}; }

TEST(Relations, ErrorsAreOfTheDifferenceOfRelativePoses) {
  const std::vector<Relation> relations{
      {1, 3, {2, 0, 0}},        // right, between rows far apart
      {2, 12, {8, 2.3, 0.05}},  // off by 0.3 m, as the pose's heading is 9 degrees
      {30, 31, {0, 0, 0}}};     // nowhere
  const RelationScore score = ScoreRelations(Corner(), relations, 0);
  EXPECT_EQ(score.scored, 2);
  EXPECT_EQ(score.outside, 1);
  ExpectContains(MakeScores(score).ToText(),
                 "relations.outside               1, outside the time of the poses\n");
  const double heading = 0.1 * kPiOfRelations;  // of the pose at 12 s
  EXPECT_NEAR(score.translation_m, 0.3 / 2, 1e-12);
  EXPECT_NEAR(score.translation_rms_m, 0.3 / std::sqrt(2), 1e-12);
  EXPECT_NEAR(score.rotation_deg, (heading - 0.05) * 180 / kPiOfRelations / 2, 1e-9);
  EXPECT_NEAR(ScoreRelations(Corner(), {{101, 103, {2, 0, 0}}}, 100).translation_m, 0, 1e-12);
  ExpectContains(InputErrorOf([&] { ScoreRelations(Corner(), {{101, 103, {2, 0, 0}}}, 0); }),
                 "they go from 0 to 20 s, the first relation is of 101 s; --offset-s");
}

TEST(Relations, TheFrameOfTheTrackDoesNotMatter) {
  Track turned = Corner();
  for (Pose& pose : turned.poses) {
    const double c = std::cos(2.0), s = std::sin(2.0);
    pose = {c * pose.x_m - s * pose.y_m + 5, s * pose.x_m + c * pose.y_m - 7,
            WrapAngle(pose.heading_rad + 2)};
  }
  const std::vector<Relation> relations{{2, 12, {8, 2.3, 0.05}}, {12, 3, {1, 1, 1}}};
  const RelationScore a = ScoreRelations(Corner(), relations, 0), b = ScoreRelations(turned, relations, 0);
  EXPECT_NEAR(a.translation_m, b.translation_m, 1e-12);
  EXPECT_NEAR(a.rotation_rms_deg, b.rotation_rms_deg, 1e-9);
}

TEST(Relations, FilesAreReadAndBadLinesNamed) {
  const TestFolder folder;
  const auto relations = ReadRelations(folder.Put("a.relations.gz", "# by hand\n1 2 0.5 -0.1 0 0 0 3.5\n"));
  ASSERT_EQ(relations.size(), 1U);
  EXPECT_EQ(relations[0].motion.y_m, -0.1);
  EXPECT_NEAR(relations[0].motion.heading_rad, 3.5 - 2 * kPiOfRelations, 1e-12);
  const auto refusal = [&](const std::string& text) {
    const std::string file = folder.Put("b.relations", text);
    return InputErrorOf([&] { ReadRelations(file); });
  };
  ExpectContains(refusal("1 2 0 0 0 0 0 0\n1 2 0 0 0 0 0\n"), "b.relations:2: wrong number of values: 7");
  ExpectContains(refusal("1 2 0 0 x 0 0 0\n"), "b.relations:1: not a number");
  ExpectContains(refusal(""), "there are no relations in it");
}

TEST(Relations, PosesComeFromMapsTablesScansOrOdometry) {
  EXPECT_EQ(ReadTrajectory(SmallResult(), "Rosa").poses[0].x_m, 0) << "the most likely ones, not the means";
  ExpectContains(InputErrorOf([] { ReadTrajectory(SmallResult(), ""); }), "which robot? 'Rosa', ");
  ExpectContains(InputErrorOf([] { ReadTrajectory(SmallResult(), "Max"); }), "there is no robot 'Max'");
  Blob blob({{"robots", Array::Texts({"a"})}});
  ExpectContains(InputErrorOf([&] { ReadTrajectory(blob, ""); }), "neither poses nor odometry");
  blob.PutVector<double>("robot/0/odometry/time_s", {1, 2, 2});
  blob.PutVector<double>("robot/0/odometry/turn_rad", {0, kPiOfRelations / 2, kPiOfRelations / 2});
  blob.PutVector<double>("robot/0/odometry/forward_m", {0, 3, 0});
  const Track reckoned = ReadTrajectory(blob, "");
  EXPECT_EQ(reckoned.time_s, (std::vector<double>{1, 2}));
  EXPECT_NEAR(reckoned.poses[1].y_m, 3, 1e-12);
  EXPECT_NEAR(reckoned.poses[1].heading_rad, kPiOfRelations, 1e-12);
  for (const char* column : {"time_s", "x_m", "y_m", "heading_rad"})
    blob.PutVector<double>("robot/0/laser/" + std::string(column), {7});
  EXPECT_EQ(ReadTrajectory(blob, "").poses[0].x_m, 7);
}

RelationScore ScoreOfLog(const std::string& log, const std::string& relations, double offset_s) {
  CarmenImportOptions options;
  options.path = DataFolder() + "/" + log;
  Blob blob;
  ImportCarmen(options, &blob);
  return ScoreRelations(ReadTrajectory(blob, ""), ReadRelations(DataFolder() + "/" + relations), offset_s);
}

// The errors that others found for the same logs, by code that is not ours.
TEST(RelationsData, RecordedLogsScoreAsElsewhere) {
  if (DataFolder().empty()) GTEST_SKIP() << "CAIRN_DATA is not set (docs/datasets.md)";
  const std::string intel = "carmen-intel/intel.relations.gz";
  const RelationScore corrected = ScoreOfLog("carmen-intel/intel-corrected.log.gz", intel, 976052857.337284);
  EXPECT_EQ(corrected.scored, 2984);
  EXPECT_NEAR(corrected.translation_m, 0.061, 0.003);
  EXPECT_NEAR(corrected.rotation_deg, 2.4, 0.15);
  const RelationScore raw = ScoreOfLog("carmen-intel/intel-raw.log.gz", intel, 0);
  EXPECT_NEAR(raw.translation_m, 7.4, 0.05);
  EXPECT_NEAR(raw.rotation_deg, 41, 0.5);
  const RelationScore fr079 =
      ScoreOfLog("carmen-fr079/freiburg-079-corrected.log.gz", "carmen-fr079/fr079.relations.gz", 1211.41);
  EXPECT_EQ(fr079.scored, 1685);
  EXPECT_NEAR(fr079.translation_m, 0.055, 0.001);
  EXPECT_NEAR(fr079.rotation_deg, 1.1, 0.05);
}

}  // namespace
}  // namespace cairn::datasets
