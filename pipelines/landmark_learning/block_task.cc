#include "pipelines/landmark_learning/block_task.h"

#include <algorithm>
#include <cmath>

#include "pipelines/landmark_learning/error_sum/fast_error.h"
#include "pipelines/landmark_learning/error_sum/features.h"
#include "pipelines/landmark_learning/error_sum/posterior_error.h"
#include "pipelines/landmark_learning/networks/some_networks.h"
#include "pipelines/landmark_learning/sum_path.h"

namespace cairn::landmark_learning {
namespace {

Places Part(const Places& places, const Range& range) {
  const auto part = [&](const std::vector<double>& values) {
    return std::vector<double>(values.begin() + range.first, values.begin() + range.end);
  };
  Places some{part(places.x_m), part(places.y_m), part(places.along_m), {}, places.table};
  if (!places.row.empty()) some.row.assign(places.row.begin() + range.first, places.row.begin() + range.end);
  if (!places.cos_heading.empty()) {
    some.cos_heading = part(places.cos_heading);
    some.sin_heading = part(places.sin_heading);
  }
  return some;
}

std::vector<double> Scaled(const std::vector<double>& weights, const Range& range, double scale) {
  std::vector<double> scaled(weights.begin() + range.first, weights.begin() + range.end);
  for (double& weight : scaled) weight *= scale;
  return scaled;
}

const float* RowsFrom(const SampleSet& set, int first, int inputs) {
  return set.inputs() + static_cast<std::ptrdiff_t>(first) * inputs;
}

// Truths, and the samples that they reach.
struct Group {
  Range reach;
  std::vector<Range> truths;
};

// How E depends on the outputs in reach.
struct OutputSlopes {
  double error = 0.0;
  std::vector<float> d_output;
};

ErrorShare<float> ShareBy(SumPath path, const Pairs& pairs, const std::vector<float>& probability,
                          int vectors, const std::vector<double>& weight, const Range& truths) {
  const Places& places = pairs.samples();
  if (path == SumPath::kTree) return ErrorInPlane(places, probability, vectors, weight, truths);
  if (path == SumPath::kLine)
    return ErrorOnLine(places, pairs.belief(), pairs.error().kind, probability, vectors, weight, truths);
  return ErrorOfTruths(pairs, probability, vectors, weight, truths);
}

// `outputs`: [reach][networks].
OutputSlopes SlopesBy(const Options& options, const SumPlan& plan, const SampleSet& training,
                      const std::vector<float>& outputs, int networks, const Group& group, double scale) {
  const Range& reach = group.reach;
  const Places places = Part(plan.PlacesOf(training.places), reach);
  const Pairs pairs(places, places, BeliefOf(options), ErrorOf(options));
  const std::vector<double> weight = Scaled(training.weight, reach, scale);
  const auto probability = FeatureProbabilities(outputs, networks);
  const int vectors = static_cast<int>(FeatureVectors(networks));
  OutputSlopes slopes;
  std::vector<float> d_probability;
  for (const Range& truths : group.truths) {
    const Range own{truths.first - reach.first, truths.end - reach.first};
    auto share = ShareBy(plan.path, pairs, probability, vectors, weight, own);
    slopes.error += share.posterior;
    if (d_probability.empty()) {
      d_probability = std::move(share.d_probability);
      continue;
    }
    for (std::size_t i = 0; i < d_probability.size(); ++i) d_probability[i] += share.d_probability[i];
  }
  slopes.d_output = OutputGradient(outputs, networks, d_probability);
  return slopes;
}

Pairs PairsOf(const Options& options, const SumPlan& plan, const SampleSet& training) {
  const Places& places = plan.PlacesOf(training.places);
  return {places, places, BeliefOf(options), ErrorOf(options)};
}

Range ReachOf(const Pairs& pairs, const Range& truths) {
  const Range reach = pairs.ReachOf(truths);
  return {std::min(reach.first, truths.first), std::max(reach.end, truths.end)};
}

// Stretches whose reaches overlap go together: the outputs of what they share are computed once.
std::vector<Group> GroupsOf(const Pairs& pairs, const std::vector<Range>& stretches) {
  std::vector<Group> groups;
  for (const Range& stretch : stretches) {
    const Range reach = ReachOf(pairs, stretch);
    if (groups.empty() || reach.first >= groups.back().reach.end) groups.push_back({reach, {}});
    groups.back().reach.end = std::max(groups.back().reach.end, reach.end);
    groups.back().truths.push_back(stretch);
  }
  return groups;
}

}  // namespace

GradientShare GradientOfStretches(const Options& options, const SampleSet& training,
                                  const Parameters<float>& parameters, const std::vector<Range>& truths,
                                  double scale, const InputNoise& noise, int learns) {
  GradientShare sum;
  const SumPlan plan = PlanSum(options, training.places);
  for (const Group& group : GroupsOf(PairsOf(options, plan, training), truths)) {
    const InputRows rows(training.inputs(), group.reach, parameters.shape.inputs, noise);
    const auto activations = Forward(parameters, rows.data(), group.reach.size());
    const auto slopes =
        SlopesBy(options, plan, training, activations.output, parameters.shape.networks, group, scale);
    auto gradient =
        BackwardFrom(learns, parameters, rows.data(), group.reach.size(), activations, slopes.d_output);
    sum.error += slopes.error;
    if (sum.gradient.empty()) {
      sum.gradient = std::move(gradient.values);
      continue;
    }
    for (std::size_t i = 0; i < sum.gradient.size(); ++i) sum.gradient[i] += gradient.values[i];
  }
  return sum;
}

GradientShare GradientOfBlock(const Options& options, const SampleSet& training,
                              const Parameters<float>& parameters, const Range& truths) {
  return GradientOfStretches(options, training, parameters, {truths}, 1.0);
}

SlopeShare SlopesOfBlock(const Options& options, const SampleSet& training,
                         const Parameters<float>& parameters, const Range& truths) {
  const SumPlan plan = PlanSum(options, training.places);
  const Range reach = ReachOf(PairsOf(options, plan, training), truths);
  const auto activations =
      Forward(parameters, RowsFrom(training, reach.first, parameters.shape.inputs), reach.size());
  auto slopes = SlopesBy(options, plan, training, activations.output, parameters.shape.networks,
                         {reach, {truths}}, 1.0);
  return {slopes.error, reach, std::move(slopes.d_output)};
}

SlopeShare SlopesOfOutputs(const Options& options, const SampleSet& training, std::span<const float> outputs,
                           int networks, const Range& truths) {
  const auto row = static_cast<std::size_t>(networks);
  if (outputs.size() != static_cast<std::size_t>(training.size()) * row)
    throw InputError("the outputs are of other samples or networks");
  const SumPlan plan = PlanSum(options, training.places);
  const Range reach = ReachOf(PairsOf(options, plan, training), truths);
  const auto own = outputs.subspan(static_cast<std::size_t>(reach.first) * row,
                                   static_cast<std::size_t>(reach.size()) * row);
  auto slopes = SlopesBy(options, plan, training, {own.begin(), own.end()}, networks, {reach, {truths}}, 1.0);
  return {slopes.error, reach, std::move(slopes.d_output)};
}

double ErrorOfBlock(const Options& options, const SampleSet& sensed, const SampleSet& map,
                    const Parameters<float>& parameters, const Range& truths) {
  const NetworkShape& shape = parameters.shape;
  const Belief belief = BeliefOf(options);
  const Range reach = Pairs(sensed.places, map.places, belief, ErrorOf(options)).ReachOf(truths);
  const Places there = Part(sensed.places, truths), taken_for = Part(map.places, reach);
  const auto of_truth = Forward(parameters, RowsFrom(sensed, truths.first, shape.inputs), truths.size());
  const auto of_sample = Forward(parameters, RowsFrom(map, reach.first, shape.inputs), reach.size());
  return ErrorInMap(Pairs(there, taken_for, belief, ErrorOf(options)),
                    FeatureProbabilities(of_truth.output, shape.networks),
                    FeatureProbabilities(of_sample.output, shape.networks),
                    static_cast<int>(FeatureVectors(shape.networks)), Scaled(sensed.weight, truths, 1.0),
                    {0, truths.size()});
}

std::vector<Range> Blocks(int count, double flops) {
  constexpr double kMost = 4e8, kLeast = 4e7;  // of a task; less only where there is no more
  constexpr double kFew = 4.0;                 // tasks into which a step is cut though one could hold it
  const double pieces = std::max(std::ceil(flops / kMost), std::min(kFew, std::ceil(flops / kLeast)));
  const int blocks = std::clamp(static_cast<int>(std::min(pieces, 4096.0)), 1, std::max(1, count));
  std::vector<Range> ranges;
  for (int b = 0; b < blocks; ++b) {
    const auto at = [&](std::int64_t i) { return static_cast<int>(i * count / blocks); };
    ranges.push_back({at(b), at(b + 1)});
  }
  return ranges;
}

}  // namespace cairn::landmark_learning
