// The M-step as a task, so that those of several candidate starts run side by side.
#pragma once

#include "pipelines/landmark_map/landmarks/summary.h"
#include "pipelines/landmark_map/model/m_step.h"
#include "pipelines/landmark_map/state/partial.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

// What an E-step's partials add up to, and the map that follows.
struct MStep {
  RoundSum sum;
  Perception perception;
  std::vector<Landmark> landmarks;

  // Throws InputError where an array is missing or does not fit the others.
  static MStep FromBlob(const Settings& settings, const Blob& blob, std::size_t robots);
};

// Of the partials that a task adds up, which it has all in memory, where there are several.
inline constexpr double kSumBytes = 64e6;

// Inputs: settings; partial/0, partial/1, … of the `backward` tasks in their order; sum, what those before
// them add up to, unless these are the first. Returns what they all add up to, a RoundSum: sum/….
Blob RunSum(const Options& options, const Task& task, const Inputs& inputs);

// The same inputs, the last ones. Returns an MStep as a blob. Throws InputError where its tables would need
// more than is allowed.
Blob RunMStep(const Options& options, const Task& task, const Inputs& inputs);

// The name of input `index`.
std::string PartialInput(std::size_t index);

}  // namespace cairn::landmark_map
