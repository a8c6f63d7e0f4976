// What a sum and a result make of partials of a worker gone bad.
#include "pipelines/landmark_map/state/partial.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace cairn::landmark_map {
namespace {

// Of a slice of one robot: counts of one layer, and a landmark that was observed once.
Blob SomePartial() {
  LayeredGrid counts;
  counts.layers = {Layer(Box{3, -2, 2, 1})};
  counts.layers[0].values = {0.25, 0.75};
  Blob partial;
  counts.Store("counts/", &partial);
  for (const char* name : {"log_likelihood", "work", "first_path_m"}) partial.PutScalar<double>(name, 1.0);
  PutFields("increments/", IncrementSums(), &partial);
  partial.PutScalar<std::int32_t>("robot", 0);
  partial.PutScalar<std::int32_t>("first", 0);
  return partial;
}

void ExpectRefused(const std::function<void(Blob*)>& change) {
  Blob partial = SomePartial();
  change(&partial);
  RoundSum sum(Settings(), 1);
  EXPECT_THROW(sum.Add(partial), InputError);
}

TEST(RoundSum, RefusesWhatNoPartialHolds) {
  RoundSum sum(Settings(), 1);
  EXPECT_NO_THROW(sum.Add(SomePartial()));
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const char* name : {"log_likelihood", "work", "first_path_m"})
    ExpectRefused([&](Blob* partial) { partial->PutScalar<double>(name, kNan); });
  ExpectRefused([](Blob* partial) { partial->PutScalar<double>("work", -2.0); });
  ExpectRefused([](Blob* partial) { partial->PutScalar<std::int32_t>("robot", 1); });
  ExpectRefused([](Blob* partial) { partial->PutScalar<std::int32_t>("confirmed", 2); });
  for (const PathPoint& nowhere : {PathPoint{0, 0, kNan, 0}, PathPoint{0, kNan, 0, 0}, PathPoint{1, 0, 0, 0}})
    ExpectRefused([&](Blob* partial) { PutRows("path/", std::vector{nowhere}, partial); });
  MapRules of_another_map;
  of_another_map.types = 1;
  ExpectRefused([&](Blob* partial) { NoCounts(of_another_map).Store("counts/", partial); });
}

// A cell far away: the box around both is larger than any memory.
TEST(RoundSum, RefusesCountsThatNoMemoryHolds) {
  LayeredGrid far;
  far.layers = {Layer(Box{1 << 27, 1 << 27, 1, 1})};
  Blob partial = SomePartial();
  far.Store("counts/", &partial);
  RoundSum sum(Settings(), 1);
  sum.Add(SomePartial());
  EXPECT_THROW(sum.Add(partial), InputError);
}

// Three steps of which the second sees two landmarks.
RobotSteps ThreeSteps() {
  RobotSteps steps;
  steps.time_s = {0.0, 1.0, 2.0};
  steps.first_observation = {0, 0, 2, 2};
  steps.observations.resize(2);
  return steps;
}

// A summary from step `first` on.
Blob Summary(std::int32_t first, std::size_t steps, const std::vector<std::int32_t>& landmark) {
  Blob summary;
  summary.PutScalar<std::int32_t>("first", first);
  PutRows("pose/", std::vector<PoseSummary>(steps), &summary);
  summary.PutVector("association/landmark", landmark);
  summary.PutVector("association/probability", std::vector<double>(landmark.size(), 0.9));
  return summary;
}

TEST(CheckSummaries, TakesThoseOfAllStepsAlone) {
  const RobotSteps steps = ThreeSteps();
  const auto check = [&](const std::vector<Blob>& summaries) { CheckSummaries(summaries, steps, 5); };
  const Blob begin = Summary(0, 1, {}), rest = Summary(1, 2, {4, -1});
  EXPECT_NO_THROW(check({begin, rest}));
  EXPECT_NO_THROW(check({Summary(0, 3, {0, 0})}));
  EXPECT_THROW(check({}), InputError);
  EXPECT_THROW(check({begin}), InputError);
  EXPECT_THROW(check({rest}), InputError);
  EXPECT_THROW(check({begin, begin, rest}), InputError);
  EXPECT_THROW(check({begin, Summary(1, 3, {4, -1})}), InputError);
  EXPECT_THROW(check({begin, Summary(1, 2, {4})}), InputError);
  EXPECT_THROW(check({begin, Summary(1, 2, {5, -1})}), InputError);
  EXPECT_THROW(check({begin, Summary(1, 2, {4, -2})}), InputError);
}

TEST(CheckSummaries, RefusesPosesAndProbabilitiesThatAreNone) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const char* name : {"pose/x_m", "pose/heading_rad", "pose/mode_y_m", "association/probability"}) {
    Blob summary = Summary(0, 3, {0, 1});
    std::vector<double> values(static_cast<std::size_t>(summary.at(name).size()), 0.5);
    summary.PutVector(name, values);
    EXPECT_NO_THROW(CheckSummaries({summary}, ThreeSteps(), 2)) << name;
    values.back() = kNan;
    summary.PutVector(name, values);
    EXPECT_THROW(CheckSummaries({summary}, ThreeSteps(), 2), InputError) << name;
    values.pop_back();
    summary.PutVector(name, values);
    EXPECT_THROW(CheckSummaries({summary}, ThreeSteps(), 2), InputError) << name;
  }
}

}  // namespace
}  // namespace cairn::landmark_map
