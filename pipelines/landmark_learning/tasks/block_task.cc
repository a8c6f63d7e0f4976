#include "pipelines/landmark_learning/tasks/block_task.h"

#include <algorithm>
#include <cmath>

#include "pipelines/landmark_learning/error_sum/fast_error.h"
#include "pipelines/landmark_learning/error_sum/features.h"
#include "pipelines/landmark_learning/error_sum/posterior_error.h"
#include "pipelines/landmark_learning/networks/some_networks.h"
#include "pipelines/landmark_learning/state/sum_path.h"

namespace cairn::landmark_learning {
namespace {

Positions Part(const Positions& positions, const IndexRange& range) {
  const auto part = [&](const std::vector<double>& values) {
    return std::vector<double>(values.begin() + range.first, values.begin() + range.end);
  };
  Positions some{part(positions.x_m), part(positions.y_m), part(positions.along_m), {}, positions.table};
  if (!positions.row.empty())
    some.row.assign(positions.row.begin() + range.first, positions.row.begin() + range.end);
  if (!positions.cos_heading.empty()) {
    some.cos_heading = part(positions.cos_heading);
    some.sin_heading = part(positions.sin_heading);
  }
  return some;
}

std::vector<double> Scaled(const std::vector<double>& weights, const IndexRange& range, double scale) {
  std::vector<double> scaled(weights.begin() + range.first, weights.begin() + range.end);
  for (double& weight : scaled) weight *= scale;
  return scaled;
}

const float* RowsFrom(const SampleSet& set, int first, int inputs) {
  return set.inputs() + static_cast<std::ptrdiff_t>(first) * inputs;
}

// True positions, and the samples that they reach.
struct Group {
  IndexRange reach;
  std::vector<IndexRange> true_positions;
};

// How E depends on the outputs in reach.
struct OutputGradients {
  double error = 0.0;
  std::vector<float> d_output;
};

ErrorShare<float> ShareBy(SumPath path, const Pairs& pairs, const std::vector<float>& probability,
                          int vectors, const std::vector<double>& weight, const IndexRange& true_positions) {
  const Positions& positions = pairs.samples();
  if (path == SumPath::kTree) return ErrorInPlane(positions, probability, vectors, weight, true_positions);
  if (path == SumPath::kLine)
    return ErrorOnLine(positions, pairs.belief(), pairs.error().kind, probability, vectors, weight,
                       true_positions);
  return ErrorOfTruePositions(pairs, probability, vectors, weight, true_positions);
}

// `outputs`: [reach][networks].
OutputGradients OutputGradientsBy(const Options& options, const SumPlan& plan, const SampleSet& training,
                                  const std::vector<float>& outputs, int networks, const Group& group,
                                  double scale) {
  const IndexRange& reach = group.reach;
  const Positions positions = Part(plan.PositionsOf(training.positions), reach);
  const Pairs pairs(positions, positions, BeliefOf(options), ErrorOf(options));
  const std::vector<double> weight = Scaled(training.weight, reach, scale);
  const auto probability = FeatureProbabilities(outputs, networks);
  const int vectors = static_cast<int>(FeatureVectors(networks));
  OutputGradients gradients;
  std::vector<float> d_probability;
  for (const IndexRange& true_positions : group.true_positions) {
    const IndexRange own{true_positions.first - reach.first, true_positions.end - reach.first};
    auto share = ShareBy(plan.path, pairs, probability, vectors, weight, own);
    gradients.error += share.posterior;
    if (d_probability.empty()) {
      d_probability = std::move(share.d_probability);
      continue;
    }
    for (std::size_t i = 0; i < d_probability.size(); ++i) d_probability[i] += share.d_probability[i];
  }
  gradients.d_output = OutputGradient(outputs, networks, d_probability);
  return gradients;
}

Pairs PairsOf(const Options& options, const SumPlan& plan, const SampleSet& training) {
  const Positions& positions = plan.PositionsOf(training.positions);
  return {positions, positions, BeliefOf(options), ErrorOf(options)};
}

IndexRange ReachOf(const Pairs& pairs, const IndexRange& true_positions) {
  const IndexRange reach = pairs.ReachOf(true_positions);
  return {std::min(reach.first, true_positions.first), std::max(reach.end, true_positions.end)};
}

// Stretches whose reaches overlap go together: the outputs of what they share are computed once.
std::vector<Group> GroupsOf(const Pairs& pairs, const std::vector<IndexRange>& stretches) {
  std::vector<Group> groups;
  for (const IndexRange& stretch : stretches) {
    const IndexRange reach = ReachOf(pairs, stretch);
    if (groups.empty() || reach.first >= groups.back().reach.end) groups.push_back({reach, {}});
    groups.back().reach.end = std::max(groups.back().reach.end, reach.end);
    groups.back().true_positions.push_back(stretch);
  }
  return groups;
}

}  // namespace

GradientShare GradientOfStretches(const Options& options, const SumPlan& plan, const SampleSet& training,
                                  const Parameters<float>& parameters,
                                  const std::vector<IndexRange>& true_positions, double scale,
                                  const InputNoise& noise, int learns) {
  GradientShare sum;
  for (const Group& group : GroupsOf(PairsOf(options, plan, training), true_positions)) {
    const InputRows rows(training.inputs(), group.reach, parameters.shape.inputs, noise);
    const auto activations = Forward(parameters, rows.data(), group.reach.size());
    const auto gradients = OutputGradientsBy(options, plan, training, activations.output,
                                             parameters.shape.networks, group, scale);
    auto gradient =
        BackwardFrom(learns, parameters, rows.data(), group.reach.size(), activations, gradients.d_output);
    sum.error += gradients.error;
    if (sum.gradient.empty()) {
      sum.gradient = std::move(gradient.values);
      continue;
    }
    for (std::size_t i = 0; i < sum.gradient.size(); ++i) sum.gradient[i] += gradient.values[i];
  }
  return sum;
}

GradientShare GradientOfBlock(const Options& options, const SumPlan& plan, const SampleSet& training,
                              const Parameters<float>& parameters, const IndexRange& true_positions) {
  return GradientOfStretches(options, plan, training, parameters, {true_positions}, 1.0);
}

OutputGradientShare OutputGradientOfBlock(const Options& options, const SumPlan& plan,
                                          const SampleSet& training, const Parameters<float>& parameters,
                                          const IndexRange& true_positions) {
  const IndexRange reach = ReachOf(PairsOf(options, plan, training), true_positions);
  const auto activations =
      Forward(parameters, RowsFrom(training, reach.first, parameters.shape.inputs), reach.size());
  auto gradients = OutputGradientsBy(options, plan, training, activations.output, parameters.shape.networks,
                                     {reach, {true_positions}}, 1.0);
  return {gradients.error, reach, std::move(gradients.d_output)};
}

OutputGradientShare OutputGradientOfOutputs(const Options& options, const SumPlan& plan,
                                            const SampleSet& training, std::span<const float> outputs,
                                            int networks, const IndexRange& true_positions) {
  const auto row = static_cast<std::size_t>(networks);
  if (outputs.size() != static_cast<std::size_t>(training.size()) * row)
    throw InputError("the outputs are of other samples or networks");
  const IndexRange reach = ReachOf(PairsOf(options, plan, training), true_positions);
  const auto own = outputs.subspan(static_cast<std::size_t>(reach.first) * row,
                                   static_cast<std::size_t>(reach.size()) * row);
  auto gradients = OutputGradientsBy(options, plan, training, {own.begin(), own.end()}, networks,
                                     {reach, {true_positions}}, 1.0);
  return {gradients.error, reach, std::move(gradients.d_output)};
}

double ErrorOfBlock(const Options& options, const SampleSet& sensed, const SampleSet& map,
                    const Parameters<float>& parameters, const IndexRange& true_positions) {
  const NetworkShape& shape = parameters.shape;
  const Belief belief = BeliefOf(options);
  const IndexRange reach =
      Pairs(sensed.positions, map.positions, belief, ErrorOf(options)).ReachOf(true_positions);
  const Positions there = Part(sensed.positions, true_positions), taken_for = Part(map.positions, reach);
  const auto of_truth =
      Forward(parameters, RowsFrom(sensed, true_positions.first, shape.inputs), true_positions.size());
  const auto of_sample = Forward(parameters, RowsFrom(map, reach.first, shape.inputs), reach.size());
  return ErrorInMap(Pairs(there, taken_for, belief, ErrorOf(options)),
                    FeatureProbabilities(of_truth.output, shape.networks),
                    FeatureProbabilities(of_sample.output, shape.networks),
                    static_cast<int>(FeatureVectors(shape.networks)),
                    Scaled(sensed.weight, true_positions, 1.0), {0, true_positions.size()});
}

std::vector<IndexRange> Blocks(int count, double flops) {
  constexpr double kMost = 4e8, kLeast = 4e7;  // of a task; less only where there is no more
  constexpr double kFew = 4.0;                 // tasks into which a step is cut though one could hold it
  const double pieces = std::max(std::ceil(flops / kMost), std::min(kFew, std::ceil(flops / kLeast)));
  const int blocks = std::clamp(static_cast<int>(std::min(pieces, 4096.0)), 1, std::max(1, count));
  std::vector<IndexRange> ranges;
  for (int b = 0; b < blocks; ++b) {
    const auto at = [&](std::int64_t i) { return static_cast<int>(i * count / blocks); };
    ranges.push_back({at(b), at(b + 1)});
  }
  return ranges;
}

}  // namespace cairn::landmark_learning
