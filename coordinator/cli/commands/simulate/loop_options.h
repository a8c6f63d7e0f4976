// The options of `cairn simulate loop`, for whoever simulates loops.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "datasets/simulate/loop.h"

namespace cairn::cli {

inline std::vector<std::string> LoopDifficultyNames() {
  std::vector<std::string> names;
  for (const datasets::LoopDifficulty& difficulty : datasets::LoopDifficulties()) {
    names.push_back(difficulty.name);
  }
  return names;
}

// All but difficulty and seed.
inline void AddLoopOptions(CLI::App* app, datasets::SimulateLoopOptions* loop) {
  app->add_option("--robots", loop->robots, "How many, from 1 to 64; each starts anywhere")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  datasets::LoopSensing& sensing = loop->sensing;
  app->add_option("--sensor", sensing.sensor,
                  "A button pressed at landmarks, or a camera (press, range-bearing)")
      ->check(CLI::IsMember({"press", "range-bearing"}))
      ->capture_default_str();
  app->add_option("--false-rate", sensing.false_rate, "Share of the observations that are of nothing")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  app->add_option("--miss-rate", sensing.miss_rate, "Share of the landmarks that are passed unnoticed")
      ->check(CLI::Range(datasets::kDriveMissRate, 0.9))
      ->capture_default_str();
  app->add_option("--types", sensing.types, "Kinds of landmarks that look different")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  app->add_option("--confusion", sensing.confusion, "Probability that a landmark is taken for another type's")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  app->add_flag("--identities", sensing.identities, "Observations say which landmark they are of");
  app->add_flag("--sonar", loop->sonar, "Walls, and a ring of 24 sonars");
}

}  // namespace cairn::cli
