// What matters in training: four networks for +-2 m, trained again and again with one thing changed. Which
// sensors ([Thr98] section 7, sensor selection); which way to train and how large a network (section 5.1.4).
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "datasets/reproduce/ball/study.h"
#include "datasets/reproduce/paper_figure.h"

namespace cairn::datasets {

struct BallVariant {
  std::string stage;                                    // its stage's name
  std::string title;                                    // for people
  std::function<bool(const std::string& input)> keeps;  // which inputs; empty: all
  BallRecipe options;                                   // beyond the recipe's
};

// "all", then each group of inputs left out: rows, columns, brightness, colour, texture, camera, sonar.
std::vector<BallVariant> SensorVariants();

// Ways to train, each with its own rate, and hidden units, in one layer or two. `steps`: of the recipe.
std::vector<BallVariant> TrainingVariants(std::int64_t steps);

BallJob MakeVariantJob(const std::string& study, const std::string& set, std::uint64_t seed,
                       const BallRecipe& recipe, const std::vector<BallVariant>& variants);

struct VariantScores {
  std::string set;
  std::map<std::string, double> reduction, seconds;  // by stage; seconds of computing, all workers together
};

VariantScores ScoreVariantJob(const BallJob& ball, const std::vector<BallVariant>& variants,
                              const std::map<std::string, Blob>& results);

// A table with a row a variant: reduction by set, and how much less than the first variant's in the same
// corridor (a paired difference); with `times` also seconds. `figure` brings title and claim.
PaperFigure VariantFigure(PaperFigure figure, const std::vector<BallVariant>& variants,
                          const std::vector<VariantScores>& scores, bool times);

// Samples with some of their inputs.
Blob WithInputs(const Blob& samples, const std::function<bool(const std::string& input)>& keeps);

}  // namespace cairn::datasets
