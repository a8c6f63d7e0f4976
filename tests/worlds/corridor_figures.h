// How well what is made by hand localises in the simulated corridor: [Thr98] table 3 and
// section 5.2.1, that the simulator is held to. For a test, and for a program that prints them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "datasets/evaluate/learning/features.h"
#include "datasets/simulate/corridor/corridor.h"

namespace cairn {

struct PaperFigure {
  const char* set;
  double window_m;
  double reduction;
};

// Perfect knowledge of doors (d1, d2) and of lights (d3).
inline constexpr std::array kPaperFigures = {PaperFigure{"d1", 2, 0.083},
                                             PaperFigure{"d1", 50, 0.050},
                                             PaperFigure{"d2", 2, 0.014},
                                             PaperFigure{"d2", 5, 0.098},
                                             PaperFigure{"d2", datasets::kGlobal, 0.0},
                                             PaperFigure{"d3", 2, 0.156}};

struct SetFigures {
  std::map<double, double> known, detected;  // by window: error reduction
  datasets::Detection detection;
};

inline std::map<double, double> ReductionsOf(const Blob& samples, const std::string& feature) {
  datasets::ScoreOptions how;
  how.samplings = 1;  // of the soft score nothing depends on it
  std::map<double, double> reductions;
  for (const auto& score : datasets::EvaluateFeatures(samples, nullptr, {feature}, {}, how).windows)
    reductions[score.window_m] = score.soft.error_reduction.value();
  return reductions;
}

inline SetFigures FiguresOf(const std::string& set, std::uint64_t seed) {
  datasets::SimulateCorridorOptions options;
  options.set = set;
  options.seed = seed;
  const Blob samples = datasets::SimulateCorridor(options);
  const std::vector<std::string> names = samples.Texts("feature_name");
  return {ReductionsOf(samples, names[0]), ReductionsOf(samples, names[1]),
          datasets::CompareFeatures(samples, names[1], names[0])};
}

inline double Mean(const std::vector<SetFigures>& figures, std::map<double, double> SetFigures::* what,
                   double window_m) {
  double sum = 0;
  for (const SetFigures& one : figures) sum += (one.*what).at(window_m);
  return sum / static_cast<double>(figures.size());
}

inline datasets::Detection AllDetections(const std::vector<SetFigures>& figures) {
  datasets::Detection all;
  for (const SetFigures& one : figures) {
    all.both += one.detection.both;
    all.only_detected += one.detection.only_detected;
    all.only_true += one.detection.only_true;
    all.neither += one.detection.neither;
  }
  return all;
}

}  // namespace cairn
