// Samples as training wants them: normalised, in an order in which neighbours are neighbours in space.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipelines/landmark_learning/error_sum/pairs.h"
#include "schema/blob.h"
#include "schema/kinds/fields.h"

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
  std::vector<std::int64_t> sample_hash = {};  // SampleHashes

  const float* inputs() const { return input.As<float>().data(); }
  int size() const { return positions.size(); }
  static void Fields(const auto& field) {
    field("positions", &SampleSet::positions);
    field("run", &SampleSet::run);
    field("weight", &SampleSet::weight);
    field("input", &SampleSet::input);
    field("heading_rad", &SampleSet::heading_rad);
    field("sample_hash", &SampleSet::sample_hash);
  }
};

// Of each input.
struct InputNorm {
  std::vector<double> mean, scale;
};

struct TrainingData {
  std::vector<std::string> runs, input_names;
  // Of each input, over the training samples; an input that never changes: scale 1.
  std::vector<double> mean, scale;
  SampleSet training, held_out;
  std::vector<std::string> input_doubts;  // inputs that tell when, not where

  // From an input of kind `samples` (schema/FORMAT.md), checked as its kind. `given`: a mean and a scale to
  // normalise by, or null: those of the training samples. `unseen`: runs that are as if they were not there.
  // Throws InputError that names run and row where
  // - there are no inputs, or no run is left to train on;
  // - a run has one sample, or two of one time and position;
  // - `holdout` is no run, or an unseen run is none or the one held out.
  static TrainingData Of(const Blob& blob, const std::string& holdout, const InputNorm* given = nullptr,
                         const std::vector<std::string>& unseen = {});

  static void Fields(const auto& field) {
    field("runs", &TrainingData::runs);
    field("input_name", &TrainingData::input_names);
    field("mean", &TrainingData::mean);
    field("scale", &TrainingData::scale);
    field("training", &TrainingData::training);
    field("held_out", &TrainingData::held_out);
    field("input_doubts", &TrainingData::input_doubts);
  }
};

}  // namespace cairn::landmark_learning
