#include "datasets/import/g2o.h"

#include <cmath>

#include "datasets/export/export.h"
#include "datasets/import/recognize.h"
#include "datasets/testing.h"
#include "datasets/testing_result.h"
#include "schema/geometry.h"

namespace cairn::datasets {
namespace {

class ImportG2oTest : public ImportTest {
 protected:
  ImportReport Import(const std::string& text, G2oImportOptions options = {}) {
    log_ = Blob();
    options.file = folder_.Put("graph.g2o", text);
    return ImportG2o(options, &log_);
  }
  std::string Refusal(const std::string& text) {
    return InputErrorOf([&] { Import(text); });
  }
  // Where the controls lead, from (0, 0).
  Pose End(const std::string& robot) {
    Pose pose;
    const auto turn = Column<double>(robot + "odometry/turn_rad");
    const auto forward = Column<double>(robot + "odometry/forward_m");
    for (std::size_t i = 0; i < turn.size(); ++i) {
      pose.heading_rad += turn[i];
      pose.x_m += forward[i] * std::cos(pose.heading_rad);
      pose.y_m += forward[i] * std::sin(pose.heading_rad);
    }
    return pose;
  }
};

constexpr const char* kInformation = " 1 0 0 1 0 1\n";

TEST_F(ImportG2oTest, EdgesBetweenSuccessivePosesAreOdometryAndOthersObservations) {
  // A step ahead, one ahead with a quarter turn that is told backwards, a loop; two landmarks, one touched.
  const ImportReport report = Import(
      std::string("VERTEX_SE2 7 0 0 0\nVERTEX_XY 40 9 9\nFIX 7\n") + "EDGE_SE2 7 8 2 0 0" + kInformation +
      "EDGE_SE2 9 8 0 1 -1.5707963267948966" + kInformation + "EDGE_SE2 9 7 -3 0 0" + kInformation +
      "EDGE_SE2_XY 8 40 0 3 1 0 1\n# words\nEDGE_SE2_XY 9 12 0 0 1 0 1\nEDGE_SE2_XY 7 40 2 0 1 0 1\n");
  EXPECT_EQ(log_.Texts("robots"), (std::vector<std::string>{"robot 0"}));
  const Pose end = End("robot/0/");
  EXPECT_NEAR(end.x_m, 3, 0.006);
  EXPECT_NEAR(end.y_m, 0, 0.006);
  EXPECT_NEAR(end.heading_rad, M_PI / 2, 1e-9);
  EXPECT_EQ(Column<double>("robot/0/odometry/time_s").back(), 2);
  EXPECT_EQ(log_.Texts("landmarks"), (std::vector<std::string>{"12", "40"}));
  EXPECT_EQ(Column<double>("robot/0/observations/time_s"), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(Column<std::int32_t>("robot/0/observations/landmark"), (std::vector<std::int32_t>{1, 1, 0}));
  const auto range = Column<double>("robot/0/observations/range_m");
  const auto bearing = Column<double>("robot/0/observations/bearing_rad");
  EXPECT_EQ(range[0], 2);
  EXPECT_EQ(bearing[1], M_PI / 2);
  EXPECT_TRUE(std::isnan(range[2])) << "a contact detection";
  EXPECT_EQ(report.dropped, (std::map<std::string, std::int64_t>{{"loop between two poses", 1}}));
}

TEST_F(ImportG2oTest, AGapInTheNumbersIsAnotherRobot) {
  const ImportReport report =
      Import(std::string("EDGE_SE2 0 1 1 0 0") + kInformation + "EDGE_SE2 5 6 2 0 0" + kInformation +
                 "EDGE_SE2_XY 3 9 1 1 1 0 1\nEDGE_BEARING_SE2_XY 0 9 1 1\n",
             {.step_s = 0.5});
  EXPECT_EQ(log_.Texts("robots"), (std::vector<std::string>{"robot 0", "robot 1"}));
  EXPECT_NEAR(End("robot/1/").x_m, 2, 0.006);
  EXPECT_EQ(Column<double>("robot/1/odometry/time_s").back(), 3);
  EXPECT_EQ(report.dropped,
            (std::map<std::string, std::int64_t>{{"edge of another kind", 1},
                                                 {"observation from a pose without odometry", 1}}));
}

TEST_F(ImportG2oTest, TheWayOverAGapInTheNumbersIsNoLoop) {
  std::string graph;
  for (const char* poses : {"0 1", "1 2", "7 8", "8 9", "2 7", "7 2", "2 8", "1 7", "0 2", "9 12"})
    graph += std::string("EDGE_SE2 ") + poses + " 1 0 0" + kInformation;
  const ImportReport report = Import(graph);
  EXPECT_EQ(report.robots, 2);
  EXPECT_EQ(report.dropped,
            (std::map<std::string, std::int64_t>{{"loop between two poses", 3},
                                                 {"odometry over a gap in the poses' numbers", 3}}));
}

TEST_F(ImportG2oTest, WhatIsNoneOfThePlaneOrNoGraphIsRefused) {
  ExpectContains(Refusal("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n"),
                 "graph.g2o:1: VERTEX_SE3:QUAT: a graph of three dimensions");
  ExpectContains(Refusal("VERTEX_SE2 0 0 0 0\n"), "no EDGE_SE2 between poses whose numbers follow");
  ExpectContains(Refusal("EDGE_SE2 0 1 1 0\n"), "graph.g2o:1: line cut short");
  ExpectContains(Refusal("EDGE_SE2 0 -1 1 0 0\n"), "graph.g2o:1: no count");
  ExpectContains(Refusal("EDGE_SE2 0 1 1e9 0 0\n"), "graph.g2o:1: no place on Earth");
  ExpectContains(Refusal("ODOMETRY 0 1 1 0 0\n"), "graph.g2o:1: unknown message");
  const std::string no_weights = ": information that is no matrix of weights";
  ExpectContains(Refusal("EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 1 2 1 0 0.3 -1 0 0 -1 0 -1\n"),
                 "graph.g2o:2" + no_weights);
  ExpectContains(Refusal("EDGE_SE2 0 1 1 0 0 1 0 0 1 2 1\n"), "graph.g2o:1" + no_weights);
  // Each two of its axes agree, all three do not.
  ExpectContains(Refusal("EDGE_SE2 0 1 1 0 0 1 -0.9 -0.9 1 -0.9 1\n"), "graph.g2o:1" + no_weights);
  ExpectContains(Refusal("EDGE_SE2_XY 0 9 1 1 1 0 -1\n"), "graph.g2o:1" + no_weights);
  ExpectContains(Refusal("EDGE_SE2 0 1 1 0 0 1 0\n"), "graph.g2o:1: line cut short");
  EXPECT_TRUE(Import("EDGE_SE2 0 1 1 0 0 44.7 0 0 0 0 4.4\nEDGE_SE2 1 2 1 0 0 2 2 0 2 0 1\n").dropped.empty())
      << "a direction of which nothing is known";
  std::string gaps;
  for (int i = 0; i < 1001; ++i)
    gaps += "EDGE_SE2 " + std::to_string(3 * i) + " " + std::to_string(3 * i + 1) + " 1 0 0\n";
  ExpectContains(Refusal(gaps), "more than 1000 times");
  const ImportReport report =
      Import(std::string("EDGE_SE2 0 1 1 0 0") + kInformation + "EDGE_SE2 1 2 x 0 0\n", {.skip_bad = true});
  EXPECT_EQ(report.skipped, (std::map<std::string, std::int64_t>{{"not a number", 1}}));
}

TEST_F(ImportG2oTest, IsRecognized) {
  for (const char* text : {"VERTEX_SE2 0 0 0 0\n", "# words\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n"})
    ExpectContains(Recognize(folder_.Put("a.g2o", text)).value().command, "cairn import g2o ");
  ExpectContains(Recognize(folder_.Put("00.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n")).value().command,
                 "cairn import kitti ");
  EXPECT_FALSE(Recognize(folder_.Put("a.g2o", "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n")).has_value());
}

// A map's own graph is its log again: odometry as the result has it, observations from the same poses.
TEST_F(ImportG2oTest, WhatWentOutComesBack) {
  const Blob log = SmallLog();
  Blob result = SmallResult();
  result.PutScalar<double>("robot/0/distance_scale", 1);
  result.PutScalar<double>("robot/1/distance_scale", 1);
  const std::string graph = FileText(ExportG2o(result, &log, folder_ / "out").value().at(0));
  Import(graph);
  EXPECT_EQ(log_.Texts("robots").size(), 2U);
  EXPECT_NEAR(Column<double>("robot/0/observations/range_m")[0], 2, 1e-9);
  EXPECT_NEAR(Column<double>("robot/0/observations/bearing_rad")[0], 0.5, 1e-9);
  // Controls from (1, 0.1) on, the first one done: 1 m after a turn of 0.1, 2 m after one of 1/3.
  const Pose end = End("robot/0/");
  EXPECT_NEAR(end.x_m, std::cos(0.1) + 2 * std::cos(0.1 + 1.0 / 3), 0.006);
  EXPECT_NEAR(end.heading_rad, 0.1 + 1.0 / 3, 1e-9);
}

}  // namespace
}  // namespace cairn::datasets
