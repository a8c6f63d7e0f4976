// The options of `cairn simulate loop`, for whoever simulates loops.
#pragma once

#include <string>
#include <vector>

#include "datasets/simulate/loop.h"
#include "schema/command_line/command.h"

namespace cairn::cli {

inline std::vector<std::string> LoopDifficultyNames() {
  std::vector<std::string> names;
  for (const datasets::LoopDifficulty& difficulty : datasets::LoopDifficulties()) {
    names.push_back(difficulty.name);
  }
  return names;
}

// All but difficulty and seed.
inline void AddLoopOptions(Command app, datasets::SimulateLoopOptions* loop) {
  app.Add("--robots", loop->robots, "How many, from 1 to 64; each starts anywhere")
      .Within(1, 64)
      .ShowDefault();
  datasets::LoopSensing& sensing = loop->sensing;
  app.Add("--sensor", sensing.sensor, "A button pressed at landmarks, or a camera (contact, range-bearing)")
      .OneOf({"contact", "range-bearing"})
      .ShowDefault();
  app.Add("--false-rate", sensing.false_rate, "Share of the observations that are of nothing")
      .Within(0.0, 0.5)
      .ShowDefault();
  app.Add("--miss-rate", sensing.miss_rate, "Share of the landmarks that are passed unnoticed")
      .Within(datasets::kDriveMissRate, 0.9)
      .ShowDefault();
  app.Add("--types", sensing.types, "Classes of landmarks that look different").Within(1, 16).ShowDefault();
  app.Add("--confusion", sensing.confusion, "Probability that a landmark is taken for another type's")
      .Within(0.0, 0.5)
      .ShowDefault();
  app.AddFlag("--identities", sensing.identities, "Observations say which landmark they are of");
  app.AddFlag("--sonar", loop->sonar, "Walls, and a ring of 24 sonars");
}

}  // namespace cairn::cli
