// How a range reading comes about in a given map: [Thr01] eqs 4 to 13. Written as the equations stand, for
// short lists: the search has its own, incremental code (flip_gains.h), which the tests and every round hold
// against this.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace cairn::forward_map {

// Both Gaussians of the model end here, in standard deviations: it cuts off 2e-9 of their mass.
inline constexpr double kReach = 6.0;
// p_rand and p_lost together.
inline constexpr double kMostFailures = 0.95;

struct SensorModel {
  double p_hit = 0.7;       // P(an occupied cell in the beam is detected), in (0, 1)
  double p_rand = 0.05;     // P(a reading is of nothing), in (0, 1)
  double p_lost = 0;        // P(there is no echo, whatever stands there), in [0, 1 - p_rand); 0: as [Thr01]
  double sigma_m = 0.05;    // standard deviation of [Thr01] eq. 4
  double no_echo_m = 0.05;  // of [Thr01] eq. 6: what the sensor gives where it meets nothing
  double z_max_m = 10.0;    // and where [Thr01] eq. 6 is centred

  // That it tells of obstacles.
  double p_sound() const { return 1 - p_rand - p_lost; }
  friend bool operator==(const SensorModel&, const SensorModel&) = default;
  static void Fields(const auto& field) {
    field("p_hit", &SensorModel::p_hit);
    field("p_rand", &SensorModel::p_rand);
    field("p_lost", &SensorModel::p_lost);
    field("sigma_m", &SensorModel::sigma_m);
    field("no_echo_sigma_m", &SensorModel::no_echo_m);
    field("z_max_m", &SensorModel::z_max_m);
  }
};

// exp(-(x / sigma)^2 / 2) / (sigma sqrt(2 pi)) up to kReach standard deviations, then 0; 1/m.
double Normal(double x_m, double sigma_m);

// How far along a beam obstacles can matter to a reading of `z_m`.
double ReachOf(double z_m, const SensorModel& model);

// P(C_i | z_i, m), which is E[c_i] of [Thr01] eq. 13; adds up to 1.
struct Causes {
  double random = 0;             // c_{i,*}
  double lost = 0;               // the echo; not in [Thr01], whose failures all give random ranges
  std::vector<double> obstacle;  // c_{i,k}, k = 1 .. K_i
  double none = 0;               // c_{i,K_i+1}
};

// In all that follows z_m is a reading and obstacles_m are the distances of the K obstacles in its beam, in
// increasing order. A reading without echo is one of z_max_m. One that ends beyond the map's box and detected
// none of them met what the map does not hold, anywhere up to z_max_m.
enum class End : std::uint8_t { kInMap, kBeyond };

// What such a reading, or one without echo, is distributed like where no obstacle was detected: [Thr01] eq.
// 6; 1/m.
double DensityOfNone(double z_m, const SensorModel& model, End end);
// p(z_i, C_i | m) for each C_i: [Thr01] eqs 4 to 9; 1/m.
Causes Joint(double z_m, std::span<const double> obstacles_m, const SensorModel& model,
             End end = End::kInMap);
// p(z_i | m) = sum over C_i of p(z_i, C_i | m); 1/m.
double Density(double z_m, std::span<const double> obstacles_m, const SensorModel& model,
               End end = End::kInMap);
// The E-step: [Thr01] eq. 13.
Causes Responsibilities(double z_m, std::span<const double> obstacles_m, const SensorModel& model,
                        End end = End::kInMap);
// A reading's term of [Thr01] eq. 11: E[log p(z_i, C_i | m)] over `causes`.
double ExpectedLogLikelihood(double z_m, std::span<const double> obstacles_m, const SensorModel& model,
                             const Causes& causes);
// H(C_i) in nats. log p(z_i | m) = ExpectedLogLikelihood + Entropy, where `causes` are those of
// Responsibilities.
double Entropy(const Causes& causes);

}  // namespace cairn::forward_map
