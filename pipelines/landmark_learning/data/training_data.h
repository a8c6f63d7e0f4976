// Samples as training wants them: normalised, in an order in which neighbours are neighbours in space.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipelines/landmark_learning/error_sum/pairs.h"
#include "schema/blob.h"

namespace cairn::landmark_learning {

// Samples of some runs, sorted by the coordinate in which they extend farthest.
struct SampleSet {
  Positions positions;
  std::vector<std::int32_t> run;  // index into the runs of the input
  std::vector<double> weight;     // P(xi*), which add up to 1
  Array input;                    // f32, [samples][inputs], (input - mean) / scale; shared, as it is large

  std::vector<double> weight_in_file =
      {};                                // run/N/weight of the input; empty where a run has none; not stored
  std::vector<double> heading_rad = {};  // empty where a run has none; its cosine and sine are in `positions`

  const float* inputs() const { return input.As<float>().data(); }
  int size() const { return positions.size(); }
};

// Of each input.
struct InputNorm {
  std::vector<double> mean, scale;
};

struct TrainingData {
  std::vector<std::string> runs, input_names;
  std::vector<double> mean,
      scale;  // of each input, over the training samples; an input that never changes: scale 1
  SampleSet training, held_out;

  // From an input of kind `samples` (schema/FORMAT.md). Throws InputError that names run and row: arrays of
  // different length, a run of one sample, two samples of one time and position in a run, numbers that are
  // not finite, a `holdout` that is no run or the only one, an unseen run that is none or the one held out.
  // `given`: a mean and a scale to normalise by, or null: those of the training samples. `unseen`: runs that
  // are as if they were not there.
  static TrainingData Of(const Blob& samples, const std::string& holdout, const InputNorm* given = nullptr,
                         const std::vector<std::string>& unseen = {});

  Blob ToBlob() const;
  static TrainingData FromBlob(const Blob& blob);
};

}  // namespace cairn::landmark_learning
