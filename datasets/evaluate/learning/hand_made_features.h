// Hand-made features in a file of kind `samples` (schema/FORMAT.md), as evaluation needs them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::datasets {

struct FeatureRun {
  std::string name;
  std::size_t number = 0;  // in the file
  std::vector<double> x_m, y_m;
  std::vector<double> output;       // [samples][features]: P(f_i = 1 | s)
  std::vector<double> heading_rad;  // empty where it is not known
};

// Of the runs that have samples, in order; `features` by their names, in the order that is asked for.
// Throws InputError: no such feature (and which there are), none asked for, one asked for twice or too many,
// shapes that do not fit, a position that is no number or a value that is no probability (which run and row).
std::vector<FeatureRun> ReadFeatureRuns(const Blob& file, const std::vector<std::string>& features);

}  // namespace cairn::datasets
