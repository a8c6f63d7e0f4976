// A task's arithmetic: a block of true positions against all samples that they may be taken for.
#pragma once

#include <span>
#include <vector>

#include "pipelines/landmark_learning/data/training_data.h"
#include "pipelines/landmark_learning/networks/input_noise.h"
#include "pipelines/landmark_learning/networks/networks.h"
#include "pipelines/landmark_learning/state/options.h"
#include "pipelines/landmark_learning/state/sum_path.h"

namespace cairn::landmark_learning {

// A block's share of E_posterior over the training samples, and of its gradient by all weights. Computes the
// outputs of no other samples than those in its reach.
struct GradientShare {
  double error = 0.0;
  std::vector<float> gradient;  // [parameters]
};
GradientShare GradientOfBlock(const Options& options, const SumPlan& sum, const SampleSet& training,
                              const Parameters<float>& parameters, const IndexRange& true_positions);
// The same of several, in order, whose P(a) are `scale` times as large, with noise on the inputs, by the
// weights of the networks from `learns` on.
GradientShare GradientOfStretches(const Options& options, const SumPlan& sum, const SampleSet& training,
                                  const Parameters<float>& parameters,
                                  const std::vector<IndexRange>& true_positions, double scale,
                                  const InputNoise& noise = {}, int learns = 0);

// The same by the outputs.
struct OutputGradientShare {
  double error = 0.0;
  IndexRange reach{0, 0};       // samples
  std::vector<float> d_output;  // dE/dg, [reach][networks]
};
OutputGradientShare OutputGradientOfBlock(const Options& options, const SumPlan& sum,
                                          const SampleSet& training, const Parameters<float>& parameters,
                                          const IndexRange& true_positions);

// From the outputs of all samples: [samples][networks].
OutputGradientShare OutputGradientOfOutputs(const Options& options, const SumPlan& sum,
                                            const SampleSet& training, std::span<const float> outputs,
                                            int networks, const IndexRange& true_positions);

// A block's share of the E_posterior of `sensed`, which are taken for samples of `map`: held-out ones for
// training samples, or these for each other.
double ErrorOfBlock(const Options& options, const SampleSet& sensed, const SampleSet& map,
                    const Parameters<float>& parameters, const IndexRange& true_positions);

// Cuts `count` true positions, which cost `flops` in all (counted, never measured), into blocks of even size,
// some milliseconds of a core each.
std::vector<IndexRange> Blocks(int count, double flops);

}  // namespace cairn::landmark_learning
