#include "pipelines/landmark_learning/tasks/compact.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/landmark_learning/testing.h"
#include "schema/rng.h"

namespace cairn::landmark_learning {
namespace {

std::vector<double> Outputs(std::size_t count) {
  Rng rng(8);
  std::vector<double> g;
  for (std::size_t i = 0; i < count; ++i) g.push_back(rng.Uniform());
  return g;
}

class Compact : public ::testing::Test {
 protected:
  const SampleSet set_ = TrainingData::Of(CorridorSamples().Make(), "").training;
  const Options options_{.networks = 3};
  const std::vector<double> g_ = Outputs(3 * static_cast<std::size_t>(set_.size()));
};

TEST_F(Compact, EachSampleIsInOneCellAndCellsWeighWhatTheyHold) {
  const Cells cells = CellsOf(set_, 1.0);
  EXPECT_LT(cells.size(), 90);  // 41 m, either side of the middle
  double weight = 0.0;
  int samples = 0;
  for (std::size_t c = 0; c < cells.count.size(); ++c) {
    weight += cells.weight[c];
    samples += cells.count[c];
  }
  EXPECT_NEAR(weight, 1.0, 1e-12);
  EXPECT_EQ(samples, set_.size());
  for (std::size_t k = 0; k < cells.of.size(); ++k)
    EXPECT_LT(std::abs(cells.positions.x_m[static_cast<std::size_t>(cells.of[k])] - set_.positions.x_m[k]),
              1.0);
}

TEST_F(Compact, CellsOfOneSampleEachAreTheSamples) {
  const Cells cells = CellsOf(set_, 1e-4);
  ASSERT_EQ(cells.size(), set_.size());
  const std::vector<float> g(g_.begin(), g_.end());
  const auto share = OutputGradientOfCells<float>(options_, cells, g, 3, {0, cells.size()});
  const OutputGradientShare exact =
      OutputGradientOfOutputs(options_, PlanSum(options_, set_.positions), set_, g, 3, {0, set_.size()});
  EXPECT_NEAR(share.error, exact.error, 1e-5 * exact.error);
  ASSERT_EQ(share.d_output.size(), exact.d_output.size());
  for (std::size_t i = 0; i < share.d_output.size(); ++i)
    EXPECT_NEAR(share.d_output[i], exact.d_output[i], 1e-7) << i;
}

TEST_F(Compact, SmallCellsAreCloseToTheSamples) {
  const std::vector<float> g(g_.begin(), g_.end());
  const double exact =
      OutputGradientOfOutputs(options_, PlanSum(options_, set_.positions), set_, g, 3, {0, set_.size()})
          .error;
  const Cells cells = CellsOf(set_, 0.15);
  ASSERT_LT(cells.size(), set_.size() * 3 / 4);
  EXPECT_NEAR(OutputGradientOfCells<float>(options_, cells, g, 3, {0, cells.size()}).error, exact,
              0.05 * exact);
}

TEST_F(Compact, TheGradientIsThatOfFiniteDifferences) {
  const Cells cells = CellsOf(set_, 0.7);
  const auto all = [&](const std::vector<double>& g) {
    return OutputGradientOfCells<double>(options_, cells, g, 3, {0, cells.size()});
  };
  const auto share = all(g_);
  double largest = 0.0;
  for (const double slope : share.d_output) largest = std::max(largest, std::abs(slope));
  ASSERT_GT(largest, 0.0);
  for (std::size_t i = 0; i < g_.size(); i += 61) {
    const auto at = [&](double step) {
      auto g = g_;
      g[i] += step;
      return all(g).error;
    };
    constexpr double kStep = 3e-4;
    const double slope = (8.0 * (at(kStep) - at(-kStep)) - (at(2 * kStep) - at(-2 * kStep))) / (12.0 * kStep);
    EXPECT_NEAR(share.d_output[i], slope, 1e-6 * std::max(std::abs(slope), 1e-3 * largest)) << i;
  }
}

TEST_F(Compact, BlocksOfCellsAddUp) {
  const Cells cells = CellsOf(set_, 0.7);
  const auto whole = OutputGradientOfCells<double>(options_, cells, g_, 3, {0, cells.size()});
  double error = 0.0;
  std::vector<double> sum(whole.d_output.size(), 0.0);
  for (const IndexRange& block : {IndexRange{0, 20}, IndexRange{20, 33}, IndexRange{33, cells.size()}}) {
    const auto share = OutputGradientOfCells<double>(options_, cells, g_, 3, block);
    error += share.error;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += share.d_output[i];
  }
  EXPECT_NEAR(error, whole.error, 1e-12);
  for (std::size_t i = 0; i < sum.size(); ++i) EXPECT_NEAR(sum[i], whole.d_output[i], 1e-12);
}

}  // namespace
}  // namespace cairn::landmark_learning
