// The runs of a file of kind `samples` (schema/FORMAT.md) that networks are scored on.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "datasets/evaluate/learning/learned_networks.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct HeldOutRun {
  std::string name;
  std::size_t number = 0;  // in the file
  std::span<const double> x_m, y_m;
  std::span<const float> input;              // [samples][inputs]
  std::span<const double> heading_rad = {};  // empty where it is not known
};

struct HeldOutRuns {
  std::vector<HeldOutRun> runs;         // at least one, each with samples; they point into the file
  std::vector<std::string> trained_on;  // left out: the networks have seen them
  std::vector<std::string> stopped_by;  // of `runs`, those that decided when to stop training
};

// A run counts as trained on where the networks name a run like it, and all of that run's positions are
// positions of this one; and a run of twenty samples or more, whatever its name, where more than half of them
// stand where one was trained on of which the networks make the same: a copy. So does one of which more than
// half is by its hashes what they, or networks that they went on from, were trained on. One that they name
// without any sample in their map decided when to stop: by its name, for its positions are not kept. Throws
// InputError that says so: names or number of inputs that differ from the networks', no sample at all, shapes
// that do not fit, a value that is no number (which run, row and input), and a file that holds nothing but
// what was trained on.
HeldOutRuns ReadHeldOutRuns(const Blob& file, const LearnedNetworks& nets);

}  // namespace cairn::datasets
