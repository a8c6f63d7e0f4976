// Samples while they are read: vectors of any sensor, each with the pose at which it was taken
// (schema/FORMAT.md, `samples`).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn::datasets {

struct SampleRun {
  std::string name;
  std::vector<double> time_s, x_m, y_m;
  std::vector<double> heading_rad;  // empty: not known
  std::vector<float> input;         // [samples][inputs]
};

struct Samples {
  std::vector<std::string> input_name;
  std::vector<SampleRun> runs;
};

// Samples of the run that have the pose of an earlier one of it, to the bit.
std::int64_t CountRepeatedPoses(const SampleRun& run);

Blob MakeSamples(const Samples& samples);

}  // namespace cairn::datasets
