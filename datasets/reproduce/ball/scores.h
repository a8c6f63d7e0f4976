// What one job of the BaLL study found, as numbers.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "datasets/evaluate/learning/localization.h"
#include "datasets/reproduce/ball/study.h"

namespace cairn::datasets {

// Along the corridor in the run that was held out.
struct OutputCurve {
  std::vector<double> x_m;
  std::vector<double> output;  // [samples][networks]
  std::size_t networks = 0;
};

// A robot that is found: what it believes at each of its first sensations, over `x_m`.
struct BeliefRow {
  double true_x_m = 0, error_m = 0, travelled_m = 0;
  std::vector<double> density;  // [bins]: share of the belief
};

struct BallScores {
  std::string set;
  std::uint64_t seed = 0;
  std::int64_t true_positions = 0;  // samples that were held out
  // Error reduction in each of BallWindows(), of soft features, by stage ("n4_w2") or feature ("door").
  std::map<std::string, std::vector<double>> reduction;
  std::map<std::string, LocalizationScore> localization;  // by stage
  std::map<std::string, OutputCurve> outputs;             // of the trainings that are drawn, by stage
  // Mean over pairs of the n = 4 networks of the absolute correlation of their outputs.
  double correlation = 0;
  std::vector<BeliefRow> belief;  // of the first traverse
  double length_m = 0;            // of the corridor, from the samples
};

// `results`: of the job's stages, by name.
// Throws InputError where one lacks what is scored.
BallScores ScoreBallJob(const BallJob& ball, const std::map<std::string, Blob>& results);

}  // namespace cairn::datasets
