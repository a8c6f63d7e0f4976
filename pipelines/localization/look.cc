#include "pipelines/localization/look.h"

#include <algorithm>
#include <limits>
#include <string>

#include "schema/error.h"

namespace cairn::localization {
namespace {

constexpr double kCounted = 1e-3;

// P(f | xi) of one position: prod_i of P(f_i | xi).
double Probability(const double* ones, std::size_t bits, std::size_t f) {
  double product = 1.0;
  // [Thr98] eq. 33
  for (std::size_t i = 0; i < bits; ++i) product *= (f >> i & 1) != 0 ? ones[i] : 1.0 - ones[i];
  return product;
}

// sum over pairs of weight a * weight b * distance
double PairSum(const std::vector<Position>& positions, const std::vector<double>& weight) {
  double sum = 0.0;
  for (std::size_t a = 0; a < positions.size(); ++a) {
    double row = 0.0;
    for (std::size_t b = 0; b < a; ++b) row += weight[b] * DistanceM(positions[a], positions[b]);
    sum += 2.0 * weight[a] * row;
  }
  return sum;
}

}  // namespace

double ExpectedError(const std::vector<Position>& positions, const std::vector<double>& belief,
                     const std::vector<double>& map, std::size_t features, const FeatureGroup& group) {
  const double least = kCounted * *std::ranges::max_element(belief);
  std::vector<Position> counted;
  std::vector<std::size_t> at;
  double all = 0.0;
  for (std::size_t k = 0; k < positions.size(); ++k) {
    if (belief[k] < least) continue;
    counted.push_back(positions[k]);
    at.push_back(k);
    all += belief[k];
  }
  double error = 0.0;
  std::vector<double> weight(at.size());
  for (std::size_t f = 0; f < std::size_t{1} << group.size(); ++f) {
    double mass = 0.0;  // P(f)
    for (std::size_t k = 0; k < at.size(); ++k) {
      weight[k] = belief[at[k]] / all * Probability(&map[at[k] * features + group.first], group.size(), f);
      mass += weight[k];
    }
    // [Thr98] eq. 22
    if (mass > 0.0) error += PairSum(counted, weight) / mass;
  }
  return error;
}

void RequireWeighable(const std::vector<FeatureGroup>& groups) {
  constexpr std::size_t kMost = 12;
  if (groups.size() == 1) return;  // all is sensed
  for (const FeatureGroup& group : groups) {
    if (group.size() > kMost)
      throw InputError("look=active: networks of " + std::to_string(group.size()) +
                       " features, where it weighs " + std::to_string(kMost) + " at most");
  }
}

std::size_t BestLook(const std::vector<Position>& positions, const std::vector<double>& belief,
                     const std::vector<double>& map, std::size_t features,
                     const std::vector<FeatureGroup>& groups) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const double error = ExpectedError(positions, belief, map, features, groups[g]);
    // [Thr98] section 7, active sensing
    if (error < least) {
      least = error;
      best = g;
    }
  }
  return best;
}

}  // namespace cairn::localization
