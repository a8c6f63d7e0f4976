// Samples while they are read: vectors of any sensor, or images, each with the pose at which it was taken
// (schema/FORMAT.md, `samples`).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn::datasets {

struct SampleRun {
  std::string name;
  std::vector<double> time_s, x_m, y_m;
  std::vector<double> heading_rad;  // empty: not known
  std::vector<float> input;         // [samples][inputs]
  int image_rows = 0, image_columns = 0;
  std::vector<std::uint8_t> image = {};  // [samples][image_rows][image_columns][3]; empty: there are none
  std::vector<float> feature = {};       // [samples][hand-made features], P(f = 1 | what was sensed)
  // How odometry has it since the sample before: empty, or of each sample, of the first one zeros.
  std::vector<double> turn_rad = {}, forward_m = {}, left_m = {};
  // Where it truly was: empty, or of each sample.
  std::vector<double> true_x_m = {}, true_y_m = {}, true_heading_rad = {};
};

struct Samples {
  std::vector<std::string> input_name;
  std::vector<SampleRun> runs;
  std::vector<std::string> feature_name = {};  // of the hand-made features; empty: there are none
  std::optional<double> label_error_m = {};  // of x_m and of y_m each, standard deviation, where it is stated
};

// Samples of the run that have the pose of an earlier one of it, to the bit.
std::int64_t CountRepeatedPoses(const SampleRun& run);

Blob MakeSamples(const Samples& samples);

}  // namespace cairn::datasets
