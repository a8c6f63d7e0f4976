// How fast BaLL's sum is: E_posterior and its gradient by P(f | s), for samples along a corridor of 89 m.
// Prints milliseconds of one thread (the least of some turns), Gflop/s charged at 8 pairs 2^n, and the share
// of the thread's own peak, which a loop of nothing but fma in registers shows in the same run.
//   ball_rate                          # the table
//   ball_rate SAMPLES NETWORKS WINDOW_M [LENGTH_M]     # one row; window 0: globally uncertain
//   ball_rate paths                    # the ways below pairs squared, beside our own pairs, K = 20,000, n =
//   4 ball_rate step                     # a training step of the paper's networks, part by part
// ball_torch.py runs it beside PyTorch and prints the ratios.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "pipelines/landmark_learning/error_sum/fast_error.h"
#include "pipelines/landmark_learning/error_sum/features.h"
#include "pipelines/landmark_learning/error_sum/lanes.h"
#include "pipelines/landmark_learning/error_sum/posterior_error.h"
#include "pipelines/landmark_learning/networks/networks.h"
#include "schema/rng.h"
#include "tests/bench/bench_main.h"

namespace cairn {
namespace {

using namespace landmark_learning;  // NOLINT: all that is measured

// Seconds of the quickest of some turns: at least three, and 0.3 s of them.
double Quickest(const std::function<void()>& work) {
  using Clock = std::chrono::steady_clock;
  double least = std::numeric_limits<double>::infinity(), all = 0.0;
  for (int turn = 0; turn < 3 || all < 0.3; ++turn) {
    const auto begin = Clock::now();
    work();
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    least = std::min(least, seconds);
    all += seconds;
  }
  return least;
}

// Gflop/s of fma in registers alone: twelve sums that wait for nothing but themselves.
double PeakGflops() {
  using L = Lanes<float>;
  constexpr int kSums = 12, kTimes = 200000;
  float out[kSums * L::kCount];
  const double seconds = Quickest([&] {
    L::Register sum[kSums];
    auto factor = L::Broadcast(0.999F), term = L::Broadcast(0.001F);
    for (int i = 0; i < kSums; ++i) sum[i] = L::Broadcast(static_cast<float>(i));
    for (int t = 0; t < kTimes; ++t) {
      asm volatile("" : "+x"(factor), "+x"(term));
#pragma GCC unroll 12
      for (int i = 0; i < kSums; ++i) sum[i] = L::Fma(sum[i], factor, term);
    }
    for (int i = 0; i < kSums; ++i) L::Store(out + i * L::kCount, sum[i]);
  });
  volatile float kept = out[0];
  static_cast<void>(kept);
  return 2e-9 * kTimes * kSums * L::kCount / seconds;
}

struct Row {
  int samples, networks;
  double window_m;
  double length_m = 89.0;
  BeliefShape shape = BeliefShape::kUniform;
};

// Pairs whose belief is not zero.
double PairsOf(const Row& row, const Positions& positions) {
  if (row.window_m == 0.0) return static_cast<double>(row.samples) * row.samples;
  const Belief belief{row.shape, row.window_m};
  double pairs = 0.0;
  for (std::size_t a = 0, first = 0, end = 0; a < positions.x_m.size(); ++a) {
    while (positions.x_m[a] - positions.x_m[first] > belief.ReachM()) ++first;
    while (end < positions.x_m.size() && positions.x_m[end] - positions.x_m[a] <= belief.ReachM()) ++end;
    pairs += static_cast<double>(end - first);
  }
  return pairs;
}

// Samples along a corridor whose features are drawn at random.
struct World {
  Positions positions;
  std::vector<float> g;
  std::vector<double> weight;

  explicit World(const Row& row) : weight(static_cast<std::size_t>(row.samples), 1.0 / row.samples) {
    Rng rng(7);
    for (int k = 0; k < row.samples; ++k) {
      positions.x_m.push_back(row.length_m * (k + rng.Uniform()) / row.samples);
      positions.y_m.push_back(0.2 * rng.Normal());
      positions.along_m.push_back(positions.x_m.back());
      for (int i = 0; i < row.networks; ++i) g.push_back(static_cast<float>(rng.Uniform()));
    }
  }
  ErrorShare<float> Share(const Row& row, const std::vector<float>& probability) const {
    const double width_m = row.window_m > 0.0 ? row.window_m : std::numeric_limits<double>::infinity();
    const Pairs pairs(positions, positions, {row.shape, width_m}, ErrorKind::kDistance);
    return ErrorOfTruePositions(pairs, probability, 1 << row.networks, weight, {0, row.samples});
  }
};

void Measure(const Row& row, double peak) {
  const World world(row);
  const auto probability = FeatureProbabilities(world.g, row.networks);
  double error = 0.0;
  const double seconds = Quickest([&] { error = world.Share(row, probability).posterior; });
  const double gflops = 8e-9 * PairsOf(row, world.positions) * (1 << row.networks) / seconds;
  std::printf("%7d  %2d  %-8s %7g m  %9.3f ms  %6.1f Gflop/s  %4.0f%%  E %.4f m\n", row.samples, row.networks,
              row.shape == BeliefShape::kGaussian ? "gaussian"
              : row.window_m > 0.0                ? "window"
                                                  : "global",
              row.window_m, 1e3 * seconds, gflops, 100.0 * gflops / peak, error);
  std::fflush(stdout);
}

// 164 inputs, 6 hidden units, n = 4, +-2 m ([Thr98] section 5.1).
void MeasureStep() {
  const Row row{2424, 4, 2.0};
  const World world(row);
  const NetworkShape shape{row.networks, 164, 6};
  Rng rng(3);
  const auto parameters = RandomParameters<float>(shape, 0.1, rng);
  std::vector<float> inputs;
  for (int i = 0; i < row.samples * shape.inputs; ++i) inputs.push_back(static_cast<float>(rng.Normal()));
  Activations<float> activations;
  std::vector<float> probability, d_output;
  ErrorShare<float> share;
  double all = 0.0;
  const auto part = [&](const char* name, const std::function<void()>& work) {
    const double ms = 1e3 * Quickest(work);
    std::printf("%-22s %.3f ms\n", name, ms);
    all += ms;
  };
  part("networks", [&] { activations = Forward(parameters, inputs.data(), row.samples); });
  part("P(f | s)", [&] { probability = FeatureProbabilities(activations.output, row.networks); });
  part("E and dE/dP(f | s)", [&] { share = world.Share(row, probability); });
  part("dE/dg", [&] { d_output = OutputGradient(activations.output, row.networks, share.d_probability); });
  part("dE/dw", [&] { Backward(parameters, inputs.data(), row.samples, activations, d_output); });
  std::printf("%-22s %.3f ms\n", "together", all);
}

// One row of `paths`: seconds of both ways, and how far apart they come out.
void Compare(const char* name, const World& world, double window_m, ErrorKind error,
             const std::function<ErrorShare<float>(const std::vector<float>&)>& fast_way) {
  const int samples = world.positions.size();
  const double width_m = window_m > 0.0 ? window_m : std::numeric_limits<double>::infinity();
  const Belief belief{BeliefShape::kUniform, width_m};
  const auto probability = FeatureProbabilities(world.g, 4);
  ErrorShare<float> fast, slow;
  const double slow_s = Quickest([&] {
    const Pairs pairs(world.positions, world.positions, belief, error);
    slow = ErrorOfTruePositions(pairs, probability, 16, world.weight, {0, samples});
  });
  const double fast_s = Quickest([&] { fast = fast_way(probability); });
  const std::vector<double> exact_probability(probability.begin(), probability.end());
  const Pairs pairs(world.positions, world.positions, belief, error);
  const double exact =
      ErrorOfTruePositions(pairs, exact_probability, 16, world.weight, {0, samples}).posterior;
  std::printf(
      "%-42s pairs %9.2f ms  this %8.3f ms  %6.0f times faster  E off by %.1e, by pairs in float %.1e\n",
      name, 1e3 * slow_s, 1e3 * fast_s, slow_s / fast_s, std::abs(fast.posterior / exact - 1.0),
      std::abs(slow.posterior / exact - 1.0));
  std::fflush(stdout);
}

void MeasurePaths() {
  World line({20000, 4, 0.0});
  line.positions.y_m.assign(line.positions.y_m.size(), 0.0);
  const auto on_line = [&](double window_m, ErrorKind error) {
    const Belief belief{BeliefShape::kUniform,
                        window_m > 0.0 ? window_m : std::numeric_limits<double>::infinity()};
    return [&line, belief, error](const std::vector<float>& probability) {
      return ErrorOnLine(line.positions, belief, error, probability, 16, line.weight,
                         {0, line.positions.size()});
    };
  };
  Compare("line, global, distance", line, 0.0, ErrorKind::kDistance, on_line(0.0, ErrorKind::kDistance));
  Compare("line, global, distance travelled", line, 0.0, ErrorKind::kAlong, on_line(0.0, ErrorKind::kAlong));
  Compare("line, global, squared", line, 0.0, ErrorKind::kSquaredDistance,
          on_line(0.0, ErrorKind::kSquaredDistance));
  World scattered({20000, 4, 0.0}), path = scattered;
  Rng rng(5);
  for (std::size_t k = 0; k < scattered.positions.x_m.size(); ++k) {
    scattered.positions.x_m[k] = rng.Uniform(0.0, 100.0);
    scattered.positions.y_m[k] = rng.Uniform(0.0, 100.0);
    // One round of a figure of eight, some 2.2 km, a snapshot each 0.11 m or so.
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(k) / 20000.0;
    path.positions.x_m[k] = 400.0 * std::sin(turn) + 0.3 * rng.Normal();
    path.positions.y_m[k] = 200.0 * std::sin(2.0 * turn) + 0.3 * rng.Normal();
  }
  for (const auto& [name, world] : {std::pair("plane, global, scattered over 100 x 100 m", &scattered),
                                    std::pair("plane, global, along a route of 2 km", &path)}) {
    Compare(name, *world, 0.0, ErrorKind::kDistance,
            [positions = &world->positions, weights = &world->weight](const std::vector<float>& probability) {
              return ErrorInPlane(*positions, probability, 16, *weights, {0, positions->size()});
            });
  }
  Compare("plane, global, squared", scattered, 0.0, ErrorKind::kSquaredDistance,
          [&scattered](const std::vector<float>& probability) {
            return ErrorOnLine(scattered.positions,
                               {BeliefShape::kUniform, std::numeric_limits<double>::infinity()},
                               ErrorKind::kSquaredDistance, probability, 16, scattered.weight,
                               {0, scattered.positions.size()});
          });
  Compare("line, +-2 m, distance", line, 2.0, ErrorKind::kDistance, on_line(2.0, ErrorKind::kDistance));
}

int Main(const std::vector<std::string>& args) {
  if (args.size() == 1 && args[0] == "paths") {
    MeasurePaths();
    return 0;
  }
  if (args.size() == 1 && args[0] == "step") {
    MeasureStep();
    return 0;
  }
  if (!args.empty() && args.size() < 3) {
    std::fprintf(stderr, "usage: ball_rate [paths | step | SAMPLES NETWORKS WINDOW_M [LENGTH_M]]\n");
    return 2;
  }
  const double peak = PeakGflops();
  std::printf("peak of one thread, fma in registers: %.1f Gflop/s\n", peak);
  std::printf("samples  n  belief    window         time    charged, of the peak\n");
  if (!args.empty()) {
    Measure({std::atoi(args[0].c_str()), std::atoi(args[1].c_str()), std::atof(args[2].c_str()),
             args.size() > 3 ? std::atof(args[3].c_str()) : 89.0},
            peak);
    return 0;
  }
  for (const int networks : {1, 2, 4, 8}) {
    for (const double window_m : {0.0, 2.0}) Measure({2424, networks, window_m}, peak);
  }
  Measure({2424, 4, 200.0, 89.0, BeliefShape::kGaussian}, peak);
  Measure({2424, 8, 200.0, 89.0, BeliefShape::kGaussian}, peak);
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return cairn::BenchMain("ball_rate", cairn::Main, argc, argv); }
