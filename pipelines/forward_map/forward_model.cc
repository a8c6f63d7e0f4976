#include "pipelines/forward_map/forward_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cairn::forward_map {
namespace {

// x log y, 0 where x is.
double XLogY(double x, double y) { return x > 0 ? x * std::log(y) : 0.0; }

template <class Term>
double SumOver(const Causes& causes, const Causes& other, const Term& term) {
  double sum =
      term(causes.random, other.random) + term(causes.lost, other.lost) + term(causes.none, other.none);
  for (std::size_t k = 0; k < causes.obstacle.size(); ++k) sum += term(causes.obstacle[k], other.obstacle[k]);
  return sum;
}

}  // namespace

double Normal(double x_m, double sigma_m) {
  const double t = x_m / sigma_m;
  if (std::abs(t) > kReach) return 0;
  // [Thr01] eqs 4, 6
  return std::exp(-0.5 * t * t) * (std::numbers::inv_sqrtpi / (std::numbers::sqrt2 * sigma_m));
}

double ReachOf(double z_m, const SensorModel& model) {
  const bool may_be_none = std::abs(z_m - model.z_max_m) <= kReach * model.no_echo_m;
  return may_be_none ? std::max(z_m + kReach * model.sigma_m, model.z_max_m) : z_m + kReach * model.sigma_m;
}

double DensityOfNone(double z_m, const SensorModel& model, End end) {
  // [Thr01] eq. 6, or what lies beyond the box
  return end == End::kBeyond ? 1 / model.z_max_m : Normal(z_m - model.z_max_m, model.no_echo_m);
}

Causes Joint(double z_m, std::span<const double> obstacles_m, const SensorModel& model, End end) {
  Causes joint;
  // [Thr01] eqs 5, 8, 9
  joint.random = model.p_rand / model.z_max_m;
  joint.lost = model.p_lost * DensityOfNone(z_m, model, End::kInMap);
  // [Thr01] eq. 9: reached = (1 - p_rand) (1 - p_hit)^(k-1), less p_lost.
  double reached = model.p_sound();
  for (const double distance_m : obstacles_m) {
    // [Thr01] eqs 4, 7, 8
    joint.obstacle.push_back(reached * model.p_hit * Normal(z_m - distance_m, model.sigma_m));
    reached *= 1 - model.p_hit;
  }
  // [Thr01] eqs 6, 8, 9; the last case of 9 prints the exponent k where K_i is meant.
  joint.none = reached * DensityOfNone(z_m, model, end);
  return joint;
}

double Density(double z_m, std::span<const double> obstacles_m, const SensorModel& model, End end) {
  const Causes joint = Joint(z_m, obstacles_m, model, end);
  return SumOver(joint, joint, [](double p, double) { return p; });
}

Causes Responsibilities(double z_m, std::span<const double> obstacles_m, const SensorModel& model, End end) {
  Causes causes = Joint(z_m, obstacles_m, model, end);
  // [Thr01] eq. 13
  const double eta = 1 / SumOver(causes, causes, [](double p, double) { return p; });
  causes.random *= eta;
  causes.lost *= eta;
  causes.none *= eta;
  for (double& k : causes.obstacle) k *= eta;
  return causes;
}

double ExpectedLogLikelihood(double z_m, std::span<const double> obstacles_m, const SensorModel& model,
                             const Causes& causes) {
  // [Thr01] eq. 11, one reading's term
  return SumOver(causes, Joint(z_m, obstacles_m, model), XLogY);
}

double Entropy(const Causes& causes) {
  return SumOver(causes, causes, [](double p, double q) { return -XLogY(p, q); });
}

}  // namespace cairn::forward_map
