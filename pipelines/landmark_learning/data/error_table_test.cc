#include "pipelines/landmark_learning/data/error_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "pipelines/landmark_learning/landmark_learning.h"
#include "pipelines/landmark_learning/tasks/block_task.h"
#include "pipelines/landmark_learning/testing.h"
#include "pipelines/testing/in_process.h"

namespace cairn::landmark_learning {
namespace {

BlobPtr Learn(const Options& options, std::map<std::string, BlobPtr> inputs) {
  inputs["samples"] = std::make_shared<const Blob>(CorridorSamples().Make());
  return RunInProcess(LandmarkLearning(options, 7), inputs);
}

std::string ErrorTableComplaint(const Options& options, const std::map<std::string, BlobPtr>& inputs) {
  try {
    Learn(options, inputs);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Positions each `step_m` of the corridor, and errors by `cost` of the distance.
template <class F>
Blob Table(double step_m, const F& cost) {
  std::vector<double> x, y, error;
  for (double at = 0; at <= 41.0; at += step_m) {
    x.push_back(at);
    y.push_back(0.0);
  }
  for (const double a : x)
    for (const double b : x) error.push_back(cost(std::abs(a - b)));
  const auto rows = static_cast<std::int64_t>(x.size());
  Blob table;
  table.PutVector("position/x_m", x);
  table.PutVector("position/y_m", y);
  table.Put("error", Array::Of<double>({rows, rows}, error));
  return table;
}

// A corridor of free cells round the samples, with a wall across at 20.2 m that leaves a gap, or none.
Blob Corridor(bool gap) {
  constexpr int kColumns = 210, kRows = 20;
  std::vector<double> p(kColumns * kRows, 0.0);
  for (int row = 0; row < kRows; ++row)
    if (!gap || row < kRows - 2) p[static_cast<std::size_t>(row * kColumns + 101)] = 1.0;
  Blob map;
  map.Put("map/grid/probability", Array::Of<double>({kRows, kColumns}, p));
  map.PutScalar("map/grid/origin_x_m", -0.05);
  map.PutScalar("map/grid/origin_y_m", -2.0);
  map.PutScalar("map/grid/cell_m", 0.2);
  return map;
}

BlobPtr Ptr(Blob blob) { return std::make_shared<const Blob>(std::move(blob)); }

GradientShare WholeGradient(const Options& options, const TrainingData& data) {
  Rng rng(3);
  return GradientOfBlock(options, PlanSum(options, data.training.positions), data.training,
                         RandomParameters<float>({2, 5, 4}, 1.0, rng), {0, data.training.size()});
}

// A fine table of distances is the distance, in the error and in its gradient.
TEST(ErrorTable, OfDistancesIsTheDistance) {
  TrainingData data = TrainingData::Of(CorridorSamples().Make(), "run 1");
  const GradientShare wanted = WholeGradient({.networks = 2}, data);
  AttachTable(Table(0.02, [](double d) { return d; }), &data);
  const TrainingData back = Read<TrainingData>(BlobOf(data));
  const GradientShare share = WholeGradient({.networks = 2, .error = "table"}, back);
  EXPECT_NEAR(share.error, wanted.error, 0.01 * wanted.error);
  double largest = 0.0;
  for (const float g : wanted.gradient) largest = std::max(largest, std::abs(static_cast<double>(g)));
  for (std::size_t i = 0; i < wanted.gradient.size(); ++i)
    EXPECT_NEAR(share.gradient[i], wanted.gradient[i], 0.03 * largest) << i;
}

TEST(ErrorTable, ThatCostsTheSameEverywhereLeavesNothingToLearnButWhetherOneIsRight) {
  const BlobPtr result =
      Learn({.networks = 2, .error = "table", .rate = 0.02, .init_width = 0.5, .steps = 200},
            {{"errors", Ptr(Table(1.0, [](double d) { return d > 0.0 ? 1.0 : 0.0; }))}});
  const auto errors = result->Get<double>("history/training_error_m");
  EXPECT_LE(errors.front(), 1.0);
  EXPECT_LT(errors.back(), 0.97 * errors.front());
}

TEST(ErrorTable, AWallMakesThePathLonger) {
  const Options options{.networks = 2, .window_m = 6.0, .error = "travel", .steps = 1};
  const BlobPtr result = Learn(options, {{"map", Ptr(Corridor(true))}});
  const BlobPtr straight = Learn({.networks = 2, .window_m = 6.0, .steps = 1}, {});
  EXPECT_GT(result->Scalar<double>("prior_error_m"), 1.02 * straight->Scalar<double>("prior_error_m"));
  EXPECT_LT(result->Scalar<double>("prior_error_m"), 1.5 * straight->Scalar<double>("prior_error_m"));
}

TEST(ErrorTable, WhatCannotBeReachedOrReadIsRefused) {
  const Options travel{.error = "travel", .steps = 1}, table{.error = "table", .steps = 1};
  EXPECT_NE(ErrorTableComplaint(travel, {{"map", Ptr(Corridor(false))}})
                .find("no way leads there through the map from run"),
            std::string::npos);
  Blob far = Corridor(true);
  far.PutScalar("map/grid/origin_x_m", 10.0);
  EXPECT_NE(ErrorTableComplaint(travel, {{"map", Ptr(far)}}).find("it lies in no free cell of the map"),
            std::string::npos);
  EXPECT_EQ(ErrorTableComplaint(travel, {}), "error=travel needs the input 'map': --input map=FILE.h5");
  EXPECT_EQ(ErrorTableComplaint(table, {}), "error=table needs the input 'errors': --input errors=FILE.h5");
  EXPECT_EQ(ErrorTableComplaint({.steps = 1}, {{"map", Ptr(far)}}),
            "the input 'map' is for error=travel, not error=distance");
  Blob bad = Table(1.0, [](double d) { return d == 3.0 ? -1.0 : d; });
  EXPECT_EQ(ErrorTableComplaint(table, {{"errors", Ptr(bad)}}),
            "input 'errors': 'error', entry 3: -1, where 0 or more is needed");
  bad.PutVector<double>("position/y_m", {0.0});
  EXPECT_NE(ErrorTableComplaint(table, {{"errors", Ptr(bad)}}).find("'position/y_m' has the shape [1]"),
            std::string::npos);
}

}  // namespace
}  // namespace cairn::landmark_learning
