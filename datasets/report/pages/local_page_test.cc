#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "datasets/kinds/job_report.h"
#include "datasets/report/draw_map.h"
#include "datasets/report/pages/local_pictures.h"
#include "datasets/report/pages/pages.h"
#include "datasets/testing.h"
#include "schema/kinds/kind.h"

namespace cairn::datasets::report {
namespace {

constexpr float kNo = std::numeric_limits<float>::quiet_NaN();

// A robot that drives 3 m along x and records a trace of four features; one snapshot of 3 by 3 cells; a loop.
Blob Result() {
  Blob result;
  result.Put("robots", Array::Texts({"ann"}));
  result.PutScalar("cell_m", 0.5);
  for (const char* group : {"poses/", "walls/"})
    result.PutVector<double>(std::string("robot/0/") + group + "time_s", {1, 2, 20});
  result.PutVector<double>("robot/0/poses/x_m", {0, 1, 3});
  result.PutVector<double>("robot/0/poses/y_m", {0, 0, 0});
  result.PutVector<double>("robot/0/poses/heading_rad", {0, 0, 0});
  result.PutVector<double>("robot/0/walls/angle_rad", {std::nan(""), 0.1, 0.2});
  result.PutVector<std::int32_t>("traces/robot", {0});
  result.PutVector<double>("traces/first_s", {1});
  result.PutVector<double>("traces/last_s", {3});
  result.PutVector<double>("traces/x_m", {0});
  result.PutVector<double>("traces/y_m", {0});
  result.PutVector<double>("traces/direction_rad", {0});
  result.PutVector<std::int32_t>("traces/first_z", {-1});
  result.PutVector<std::int64_t>("traces/features", {4});
  for (const char* side : {"features/left/", "features/right/"}) {
    const std::string prefix = side;
    result.PutVector<float>(prefix + "angle_low_rad", {0, -0.5, kNo, 0});
    result.PutVector<float>(prefix + "angle_high_rad", {0, 0.5, kNo, 0});
    result.PutVector<float>(prefix + "distance_low_m", {1, 1, kNo, 1});
    result.PutVector<float>(prefix + "distance_high_m", {1.1F, 1.3F, kNo, 1});
    result.PutVector<std::uint8_t>(prefix + "occupied", {1, 0, 0, 1});
  }
  result.PutVector<std::int32_t>("connections/from", {0});
  result.PutVector<std::int32_t>("connections/to", {0});
  result.PutVector<std::int32_t>("connections/kind", {2});
  result.PutVector<std::uint8_t>("connections/used", {1});
  result.PutVector<double>("connections/from_s", {0});
  result.PutVector<double>("connections/to_s", {1});
  for (const char* column : {"from_z_m", "from_u_m", "to_z_m", "to_u_m"})
    result.PutVector<double>(std::string("connections/") + column, {0.5});
  result.PutVector<double>("snapshots/time_s", {20});
  result.PutVector<std::int32_t>("snapshots/robot", {0});
  result.PutVector<double>("snapshots/frame_rad", {0});
  result.Put("snapshots/occupancy",
             Array::Of<float>({1, 3, 3}, std::vector<float>{0, 0, 0, 0, 0, 0, 0.5F, 0.4F, 0}));
  result.Put("snapshots/edge_rad",
             Array::Of<float>({1, 3, 3}, std::vector<float>{kNo, kNo, kNo, kNo, kNo, kNo, 0, 0.1F, kNo}));
  result.Put("snapshots/histogram", Array::Of<double>({1, 8}, std::vector<double>{5, 1, 0, 0, 0, 0, 0, 1}));
  result.PutVector<std::int64_t>("snapshots/edges", {1});
  result.PutVector<double>("snapshots/edge/x0_m", {-0.5});
  result.PutVector<double>("snapshots/edge/y0_m", {0.5});
  result.PutVector<double>("snapshots/edge/x1_m", {0.5});
  result.PutVector<double>("snapshots/edge/y1_m", {0.5});
  result.PutVector<double>("robot/0/positions/time_s", {19.9});
  result.PutVector<std::int32_t>("robot/0/positions/trace", {0});
  result.PutVector<double>("robot/0/positions/z_m", {0.4});
  result.PutVector<double>("robot/0/positions/u_m", {0.1});
  result.PutVector<std::uint8_t>("robot/0/positions/corrected", {1});
  return result;
}

Blob Log() {
  Blob log;
  log.Put("robots", Array::Texts({"ann"}));
  log.PutVector<double>("robot/0/odometry/time_s", {1, 2, 20});
  log.PutVector<double>("robot/0/odometry/turn_rad", {0, 0, std::numbers::pi / 2});
  log.PutVector<double>("robot/0/odometry/forward_m", {0, 1, 2});
  return log;
}

std::string PageOf(const Blob& result, const Blob* log) {
  return JobReportHtml({{.name = "local", .result = &result, .source = log}}, "office");
}

bool IsPng(const std::string& bytes) { return bytes.size() > 200 && bytes.substr(1, 3) == "PNG"; }

TEST(LocalPage, ShowsWhatTheResultHas) {
  const Blob log = Log();
  const std::string bare = PageOf(Result(), nullptr);
  for (const char* word : {"1 edge trace", "Path", "Direction of the walls", "Local grid", "Longest trace"})
    EXPECT_NE(bare.find(word), std::string::npos) << word;
  EXPECT_EQ(bare.find("Immediate on recorded"), std::string::npos);
  const std::string with_log = PageOf(Result(), &log);
  EXPECT_NE(with_log.find("Immediate on recorded"), std::string::npos);
  EXPECT_EQ(with_log, PageOf(Result(), &log)) << "the same bytes";
}

TEST(LocalPage, AnEvaluationAddsErrors) {
  const Blob log = Log();
  LocalEvaluation score;
  score.alignment = {Similarity{}};
  score.path.mean_m = 0.123;
  score.odometry.mean_m = 0.04;
  score.loops.found = 7;
  const std::string page = LocalHtml(Result(), &log, &score);
  ExpectContains(page, "<b>0.123 m</b>");
  ExpectContains(page, "<b>0.040 m</b>");  // to as many decimals as what it is held against
  EXPECT_NE(page.find("0 of 7"), std::string::npos);
}

// A corner of the grids that odometry has turned by a quarter lies in the trace's frame where the path has
// it.
TEST(LocalPage, SuperpositionsTurnTheGridsIntoTheTracesFrame) {
  const LocalResult local = ReadLocalResult(Result());
  const std::vector<Superposed> shown = Superpositions(local, OdometryOf(Log()));
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_NEAR(shown[0].turn_rad, -std::numbers::pi / 2, 1e-12);
  EXPECT_EQ(shown[0].z_m, 0.4);
  EXPECT_TRUE(IsPng(SuperposedPicture(shown).Png()));
}

TEST(LocalPage, PicturesAreDrawnWhereThereIsLittleToSee) {
  LocalResult local = ReadLocalResult(Result());
  EXPECT_TRUE(IsPng(DrawScenePng(LocalSceneOf(Result(), nullptr, nullptr))));
  EXPECT_TRUE(IsPng(TracePicture(local.traces[0]).Png()));
  EXPECT_TRUE(IsPng(LocalGridPicture(local.snapshots[0]).Png()));
  local.traces[0].features.clear();
  EXPECT_TRUE(IsPng(TracePicture(local.traces[0]).Png()));
  local.snapshots[0].histogram.assign(8, 0);
  local.snapshots[0].occupancy.assign(9, 0);
  EXPECT_TRUE(IsPng(LocalGridPicture(local.snapshots[0]).Png()));
  // An edge of which a distance is given and nothing else.
  Blob lone = Result();
  lone.PutVector<float>("features/left/distance_low_m", {1, 1, -1, 1});
  for (const LocalTrace& trace : ReadLocalResult(lone).traces) EXPECT_TRUE(IsPng(TracePicture(trace).Png()));
  EXPECT_EQ(RichestOf({}), nullptr);
  EXPECT_EQ(LongestOf({}), nullptr);
}

TEST(LocalPage, RefusesWhatNoPictureCouldShow) {
  const Blob good = Result();
  for (const auto& [name, value] :
       {std::pair("features/left/distance_high_m", 1e9F), {"features/right/distance_low_m", -1e9F}}) {
    Blob bad = good;
    bad.PutVector(name, std::vector<float>(good.Get<float>(name).size(), value));
    ExpectContains(InputErrorOf([&] { CheckKind(bad, "local_map"); }),
                   std::string("'") + name + "', entry 0");
  }
  for (const double cell_m : {-1.0, 0.0, 1e6, std::nan("")}) {
    Blob bad = good;
    bad.PutScalar("cell_m", cell_m);
    ExpectContains(InputErrorOf([&] { CheckKind(bad, "local_map"); }), "'cell_m': ");
  }
}

TEST(LocalPage, RefusesArraysThatDoNotFit) {
  EXPECT_THROW(ReadLocalResult(Log()), InputError);
  for (const char* shortened :
       {"traces/x_m", "connections/from_z_m", "snapshots/robot", "robot/0/positions/u_m"}) {
    Blob bad = Result();
    bad.PutVector<double>(shortened, {});
    EXPECT_THROW(CheckKind(bad, "local_map"), InputError) << shortened;
  }
  Blob bad = Result();
  bad.PutVector<std::int64_t>("traces/features", {5});
  EXPECT_THROW(CheckKind(bad, "local_map"), InputError);
  bad = Result();
  bad.PutVector<std::int64_t>("snapshots/edges", {-1});
  EXPECT_THROW(CheckKind(bad, "local_map"), InputError);
  bad = Result();
  bad.PutVector<std::int32_t>("connections/to", {1});
  EXPECT_THROW(CheckKind(bad, "local_map"), InputError);
}

}  // namespace
}  // namespace cairn::datasets::report
