#include "pipelines/landmark_learning/truth_weights.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

namespace cairn::landmark_learning {
namespace {

constexpr double kCellM = 0.5;

void SumToOne(const char* which, std::vector<double>* weight) {
  double sum = 0.0;
  for (const double w : *weight) sum += w;
  if (!weight->empty() && !(sum > 0.0))
    throw InputError(std::string("the weights of the ") + which + " samples are all zero");
  // [Thr98] eq. 23: P(xi*)
  for (double& w : *weight) w /= sum;
}

void WeighSpace(SampleSet* set) {
  const auto cell_of = [&](std::size_t k) {
    return std::pair(std::floor(set->positions.x_m[k] / kCellM), std::floor(set->positions.y_m[k] / kCellM));
  };
  std::map<std::pair<double, double>, int> samples_in;
  for (std::size_t k = 0; k < set->weight.size(); ++k) ++samples_in[cell_of(k)];
  for (std::size_t k = 0; k < set->weight.size(); ++k) set->weight[k] = 1.0 / samples_in[cell_of(k)];
}

}  // namespace

void WeighTruePositions(const Options& options, TrainingData* data) {
  if (options.true_positions == "samples") return;
  for (const auto& [set, which] :
       {std::pair(&data->training, "training"), std::pair(&data->held_out, "held-out")}) {
    if (options.true_positions == "space") {
      WeighSpace(set);
    } else {
      if (set->weight_in_file.size() != set->weight.size())
        throw InputError(std::string("true_positions=file: a run of the ") + which +
                         " samples has no array 'weight'");
      set->weight = set->weight_in_file;
    }
    SumToOne(which, &set->weight);
  }
}

}  // namespace cairn::landmark_learning
