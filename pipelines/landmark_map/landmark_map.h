// Landmark maps by EM over alpha-beta on an x-y-theta grid: [TBF98].
#pragma once

#include <array>
#include <cstdint>

#include "pipelines/landmark_map/first_robot.h"
#include "pipelines/landmark_map/incremental.h"
#include "pipelines/landmark_map/state/options.h"
#include "pipelines/landmark_map/state/schedule.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

// Inputs (schema/FORMAT.md): log, and perhaps map, a landmark_map from which EM starts. Result: kind
// landmark_map. A round is an E-step: a chain of tasks `forward` and a chain of tasks `backward` over the
// time slices of each robot, or all slices side by side (speculation.h), then the task `m_step`. With several
// starts the first robot's rounds hold the tasks of all of them (common/fan_out.h, search.h). Where several
// robots are tried as the first, all of that follows once for each (first_robot.h). With the option
// incremental it is one task (incremental.h).
class LandmarkMap : public Pipeline {
 public:
  // Draws no random numbers: the seed is not used.
  explicit LandmarkMap(Options options, std::uint64_t /*seed*/ = 0) : options_(OnePass(std::move(options))) {}

  cairn::Step Start(const Inputs& inputs) const override;
  Blob Run(const Task& task, const Inputs& inputs, Progress& progress) const override;
  cairn::Step Advance(const State& state, Partials& partials, const Inputs& inputs) const override;

 private:
  // With the log's first robot as the first; so many `trials` of the kind there are.
  cairn::Step StartFrom(const Inputs& inputs, std::size_t trials) const;
  cairn::Step AdvanceFrom(const State& state, Partials& partials, const Inputs& inputs) const;
  // Of one of several robots that are tried as the first, then of the next.
  cairn::Step AdvanceTrial(FirstRobotTrials trials, const State& state, Partials& partials,
                           const Inputs& inputs) const;
  // Candidate starts advance together until EM of the first robot has ended in all of them.
  cairn::Step AdvanceSearch(const State& state, Partials& partials, const Inputs& inputs) const;
  // The State of the best candidate, on the finer grid that was asked for: EM goes on from its landmarks.
  void Refine(const std::vector<Landmark>& landmarks, const Settings& coarse, const Inputs& inputs,
              cairn::Step* step) const;
  // With candidates around the best one, or, where there is nothing better, with that alone.
  cairn::Step GoOn(std::vector<cairn::Step> starts, const Inputs& inputs) const;

  Options options_;
};

// For the registry.
using PipelineType = LandmarkMap;
inline constexpr char kSummary[] = "landmark maps and trajectories by EM over alpha-beta";
inline constexpr std::array kInputRoles = {"log", "map?"};

}  // namespace cairn::landmark_map
