#include "datasets/reproduce/landmarks/study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "datasets/reproduce/landmarks/belief_view.h"
#include "datasets/reproduce/landmarks/figures.h"

namespace cairn::datasets {
namespace {

TEST(LandmarkStudy, StagesUseWhatThereIs) {
  const LandmarkStudy study = MakeLandmarkStudy(7);
  std::vector<std::string> known;
  for (const auto& [name, path] : study.job.inputs()) known.push_back(name);
  EXPECT_EQ(known.size(), study.inputs.size());
  for (const proto::Stage& stage : study.job.stages()) {
    for (const auto& [input, source] : stage.inputs())
      EXPECT_NE(std::find(known.begin(), known.end(), source), known.end()) << stage.name() << " " << source;
    EXPECT_EQ(std::find(known.begin(), known.end(), stage.name()), known.end()) << stage.name();
    known.push_back(stage.name());
  }
}

// Landmark by landmark, from the world's truth: the observations of one seen before, with how far the robot
// has driven since.
std::map<int, double> SeenAgain(const Blob& log) {
  const auto landmark = log.Get<std::int32_t>("truth/robot/0/observations/landmark");
  const auto seen_s = log.Get<double>("robot/0/observations/time_s");
  const auto driven_s = log.Get<double>("robot/0/odometry/time_s");
  const auto forward_m = log.Get<double>("robot/0/odometry/forward_m");
  std::map<std::int32_t, double> last_seen_s;
  std::map<int, double> again_m;
  for (std::size_t n = 0; n < landmark.size(); ++n) {
    const auto before = last_seen_s.find(landmark[n]);
    if (before != last_seen_s.end()) {
      double& sum_m = again_m[static_cast<int>(n + 1)];
      for (std::size_t k = 0; k < driven_s.size(); ++k)
        sum_m += driven_s[k] > before->second && driven_s[k] <= seen_s[n] ? std::abs(forward_m[k]) : 0;
    }
    last_seen_s[landmark[n]] = seen_s[n];
  }
  return again_m;
}

TEST(LandmarkStudy, TheCycleClosesAtTheFirstLandmarkSeenAgainAfterALongWay) {
  for (const std::uint64_t seed : {4U, 7U, 8U}) {
    SCOPED_TRACE(seed);
    const LandmarkStudy study = MakeLandmarkStudy(seed);
    const std::map<int, double> again_m = SeenAgain(study.inputs.at("first")),
                                back_m = SeenAgain(study.inputs.at("back"));
    const auto closing = std::ranges::find_if(again_m, [](const auto& seen) { return seen.second > 100.0; });
    ASSERT_NE(closing, again_m.end());
    EXPECT_EQ(study.closing, closing->first);
    ASSERT_FALSE(back_m.empty());
    const auto& [revisit, length_m] = *back_m.begin();
    if (length_m < 100.0) {
      EXPECT_EQ(study.revisit, revisit);
      EXPECT_NEAR(study.revisit_m, length_m, 1e-6);
    } else {
      EXPECT_EQ(study.revisit, 0);
    }
    EXPECT_LT(study.closing, study.observations) << "nothing is left to show after it";
  }
}

TEST(LandmarkStudy, AMissingResultIsNamed) {
  try {
    LandmarkFigures(MakeLandmarkStudy(7), {});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("'map'"), std::string::npos) << e.what();
  }
}

// Two steps: at 1 s a cell at (2, 1) cells, at 3 s two cells from (0, 0) on.
Blob TwoBeliefs() {
  Blob result;
  result.PutVector<double>("robot/0/beliefs/time_s", {1.0, 3.0});
  result.Put("robot/0/beliefs/box", Array::Of<std::int32_t>({2, 4}, {2, 1, 1, 1, 0, 0, 2, 1}));
  result.PutVector<double>("robot/0/beliefs/value", {1.0, 0.25, 0.75});
  result.PutScalar<double>("map/grid/cell_m", 0.5);
  return result;
}

TEST(BeliefView, GivesEachStepsBeliefInMetres) {
  const BeliefView beliefs(TwoBeliefs(), 0);
  ASSERT_EQ(beliefs.size(), 2U);
  EXPECT_EQ(beliefs.StepAt(0.0), 0U);
  EXPECT_EQ(beliefs.StepAt(2.9), 0U);
  EXPECT_EQ(beliefs.StepAt(3.0), 1U);
  const Point first = MostLikely(beliefs.At(0));
  EXPECT_EQ(first.x_m, 1.0);
  EXPECT_EQ(first.y_m, 0.5);
  EXPECT_EQ(MostLikely(beliefs.At(1)).x_m, 0.5);
  EXPECT_EQ(ShareWithin(beliefs.At(1), {0, 0}, 0.1), 0.25);
  EXPECT_EQ(ShareWithin(beliefs.At(1), {0, 0}, 1.0), 1.0);
}

TEST(BeliefView, PlacesAreCountedOnceEach) {
  report::Grid grid;
  grid.columns = 10;
  grid.rows = 1;
  grid.probability = {0.3, 0.2, 0, 0, 0, 0.4, 0, 0, 0, 0.1};
  EXPECT_EQ(PlacesWithShare(grid, 1.5, 0.09), 3);
  EXPECT_EQ(PlacesWithShare(grid, 1.5, 0.2), 2);
  EXPECT_EQ(PlacesWithShare(grid, 1.5, 0.6), 0);
  EXPECT_EQ(PlacesWithShare(grid, 100, 0.5), 1);
}

TEST(BeliefView, ColumnsThatDoNotFitAreRefused) {
  Blob result = TwoBeliefs();
  result.PutVector<double>("robot/0/beliefs/value", {1.0});
  EXPECT_THROW(BeliefView(result, 0), InputError);
  EXPECT_THROW(BeliefView(TwoBeliefs(), 1), InputError);
}

}  // namespace
}  // namespace cairn::datasets
