// The E-step against the sum over all paths in a tiny world, written from the equations and sharing no
// recursion.
#include "pipelines/landmark_map/model/e_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include "pipelines/landmark_map/testing.h"
#include "schema/rng.h"

namespace cairn::landmark_map {
namespace {

using Pose = std::tuple<int, int, int>;  // layer, x, y
constexpr int kHeadings = 6;

RobotSteps TinySteps() {
  RobotSteps steps;
  steps.time_s = {0, 1, 2, 3};
  steps.odo_x_m = {0.0, 1.2, 1.9, 1.9};
  steps.odo_y_m = {0.0, 0.3, 1.3, 2.1};
  steps.odo_heading_rad = {0, 0.2, 1.0, 1.6};
  steps.path_m = {0, 1.3, 1.3, 0.8};
  steps.turn_rad = {0, 0.2, 0.8, 0.6};
  steps.first_observation = {0, 1, 1, 3, 4};
  steps.observations = {{0, 0.4, 0.1}, {1, 0, 0}, {0, -0.7, 0.5}, {1, 0, 0}};
  return steps;
}

EStepModel TinyModel(const Perception* perception) {
  EStepModel model;
  model.grid = {0.8, kHeadings};
  model.noise = {0.1, 0.3, 1.0, 0.2, 0.2};
  model.prune = 0.0;
  model.perception = perception;
  return model;
}

Perception RandomPerception() {
  Rng rng(11);
  Perception perception;
  for (int type = 0; type < 2; ++type) {
    Layer layer(Box{-1 + type, -2, 5, 4});
    for (double& value : layer.values) value = 0.05 + rng.Uniform();
    perception.likelihood.layers.push_back(std::move(layer));
    perception.outside.push_back(0.02);
  }
  return perception;
}

double Lookup(const Perception& p, int type, int x, int y) {
  const Layer& layer = p.likelihood.layers[type];
  return layer.box.Contains(x, y) ? layer.At(x, y) : p.outside[type];
}

double ObservationProbability(const RobotSteps& steps, int step, const EStepModel& model, const Pose& pose) {
  const auto [c, x, y] = pose;
  double probability = 1.0;
  for (int k = steps.first_observation[step]; k < steps.first_observation[step + 1]; ++k) {
    const Observation& o = steps.observations[k];
    const double angle = c * 2 * std::numbers::pi / kHeadings;
    const double px = x + (std::cos(angle) * o.x_m - std::sin(angle) * o.y_m) / model.grid.cell_m;
    const double py = y + (std::sin(angle) * o.x_m + std::cos(angle) * o.y_m) / model.grid.cell_m;
    const int ix = static_cast<int>(std::floor(px)), iy = static_cast<int>(std::floor(py));
    const double ax = px - ix, ay = py - iy;
    probability *= (1 - ax) * (1 - ay) * Lookup(*model.perception, o.type, ix, iy) +
                   ax * (1 - ay) * Lookup(*model.perception, o.type, ix + 1, iy) +
                   (1 - ax) * ay * Lookup(*model.perception, o.type, ix, iy + 1) +
                   ax * ay * Lookup(*model.perception, o.type, ix + 1, iy + 1);
  }
  return probability;
}

// P(xi' | u, xi): half of the turn's error, the shift of the heading in between, the other half.
std::map<Pose, double> Successors(const RobotSteps& steps, int step, const EStepModel& model,
                                  const Pose& pose) {
  const MotionIncrement increment = steps.IncrementTo(step);
  const IncrementError error = ErrorOf(increment, model.noise);
  const double angle_step = 2 * std::numbers::pi / kHeadings;
  const Taps half = GaussianTaps(error.heading_rad / std::sqrt(2.0) / angle_step);
  const double length = std::hypot(increment.dx_m, increment.dy_m);
  std::map<Pose, double> successors;
  const auto [c, x, y] = pose;
  for (int a = -half.reach(); a <= half.reach(); ++a) {
    const double angle = (c + a) * angle_step, cosine = std::cos(angle), sine = std::sin(angle);
    const double dx = (cosine * increment.dx_m - sine * increment.dy_m) / model.grid.cell_m;
    const double dy = (sine * increment.dx_m + cosine * increment.dy_m) / model.grid.cell_m;
    const double norm = length / model.grid.cell_m;
    for (const StencilPoint& p :
         ShiftStencil(dx, dy, dx / norm, dy / norm, error.along_m / model.grid.cell_m)) {
      for (int b = -half.reach(); b <= half.reach(); ++b) {
        const int layer = ((c + a + b) % kHeadings + kHeadings) % kHeadings;
        successors[{layer, x + p.dx, y + p.dy}] += half.At(a) * p.weight * half.At(b);
      }
    }
  }
  return successors;
}

// Adds the probability of every path to the marginals of the poses that it goes through.
struct Enumeration {
  const RobotSteps& steps;
  const EStepModel& model;
  std::vector<std::map<Pose, double>> marginals = std::vector<std::map<Pose, double>>(4);
  double evidence = 0.0;
  std::vector<Pose> path;

  void Walk(int step, const Pose& pose, double probability) {
    probability *= ObservationProbability(steps, step, model, pose);
    path.push_back(pose);
    if (step + 1 == steps.size()) {
      evidence += probability;
      for (int t = 0; t < steps.size(); ++t) marginals[t][path[t]] += probability;
    } else {
      for (const auto& [next, p] : Successors(steps, step + 1, model, pose))
        Walk(step + 1, next, probability * p);
    }
    path.pop_back();
  }
};

TEST(EStep, EqualsTheSumOverAllPaths) {
  const RobotSteps steps = TinySteps();
  const Perception perception = RandomPerception();
  const EStepModel model = TinyModel(&perception);
  Enumeration all{steps, model, std::vector<std::map<Pose, double>>(4), 0.0, {}};
  all.Walk(0, {0, 0, 0}, 1.0);

  const Slice slice{steps, 0, 4, "a"};
  NoProgress progress;
  const LayeredGrid start = DiracStart(model.grid);
  const Alphas alphas = Forward(model, slice, start, progress);
  EXPECT_NEAR(alphas.log_likelihood, std::log(all.evidence), 1e-9);
  int compared = 0;
  Backward(model, slice, alphas, start, UniformBeta(alphas.tables.back()), progress,
           Visitor{[&](int step, const LayeredGrid& belief) {
                     EXPECT_NEAR(belief.Sum(), 1.0, 1e-12);
                     for (const auto& [pose, p] : all.marginals[step]) {
                       const auto [c, x, y] = pose;
                       ASSERT_NEAR(belief.layers[c].At(x, y), p / all.evidence, 1e-9);
                       ++compared;
                     }
                   },
                   nullptr});
  EXPECT_GT(compared, 100);
}

TEST(EStep, AlphaSumsToOneAtEveryStep) {
  const RobotSteps steps = TinySteps();
  const Perception perception = RandomPerception();
  EStepModel model = TinyModel(&perception);
  model.prune = 1e-3;
  NoProgress progress;
  const Alphas alphas = Forward(model, {steps, 0, 4, "a"}, DiracStart(model.grid), progress);
  ASSERT_EQ(alphas.tables.size(), 4U);
  for (const LayeredGrid& alpha : alphas.tables) EXPECT_NEAR(alpha.Sum(), 1.0, 1e-12);
}

// Forward over a slice from where the slice before ended, backward from where the slice after began.
TEST(EStep, SlicesGiveWhatOnePassGives) {
  const RobotSteps steps = TinySteps();
  const Perception perception = RandomPerception();
  const EStepModel model = TinyModel(&perception);
  NoProgress progress;
  const LayeredGrid start = DiracStart(model.grid);
  std::vector<LayeredGrid> whole(4), sliced(4);
  const Alphas one = Forward(model, {steps, 0, 4, "a"}, start, progress);
  Backward(model, {steps, 0, 4, "a"}, one, start, UniformBeta(one.tables.back()), progress,
           Visitor{[&](int step, const LayeredGrid& belief) { whole[step] = belief; }, nullptr});

  const Slice early{steps, 0, 2, "a"}, late{steps, 2, 4, "a"};
  const Alphas first = Forward(model, early, start, progress);
  const Alphas second = Forward(model, late, first.tables.back(), progress);
  const Visitor keep{[&](int step, const LayeredGrid& belief) { sliced[step] = belief; }, nullptr};
  const LayeredGrid beta =
      Backward(model, late, second, first.tables.back(), UniformBeta(second.tables.back()), progress, keep);
  Backward(model, early, first, start, beta, progress, keep);
  EXPECT_NEAR(first.log_likelihood + second.log_likelihood, one.log_likelihood, 1e-12);
  for (int t = 0; t < 4; ++t) {
    for (int c = 0; c < kHeadings; ++c) {
      ASSERT_EQ(whole[t].layers[c].box, sliced[t].layers[c].box);
      for (std::size_t i = 0; i < whole[t].layers[c].values.size(); ++i) {
        ASSERT_NEAR(whole[t].layers[c].values[i], sliced[t].layers[c].values[i], 1e-12);
      }
    }
  }
}

struct Pass {
  explicit Pass(const EStepModel& model) {
    const RobotSteps steps = TinySteps();
    const Slice slice{steps, 0, 4, "a"};
    NoProgress progress;
    const LayeredGrid start = DiracStart(model.grid);
    const Alphas alphas = Forward(model, slice, start, progress);
    log_likelihood = alphas.log_likelihood;
    kernels = alphas.kernels.size();
    Backward(model, slice, alphas, start, UniformBeta(alphas.tables.back()), progress,
             Visitor{[&](int step, const LayeredGrid& belief) { beliefs[step] = belief; },
                     [&](int step, const HalfTurn& turn) { turns[step] = turn.mean_rad; }});
  }
  std::vector<LayeredGrid> beliefs = std::vector<LayeredGrid>(4);
  std::vector<double> turns = std::vector<double>(4);
  double log_likelihood = 0.0;
  std::size_t kernels = 0;
};

TEST(EStep, KernelsThatAreKeptGiveTheSameBits) {
  const Perception perception = RandomPerception();
  EStepModel model = TinyModel(&perception);
  const Pass made_again(model);
  model.keep_kernels = true;
  const Pass kept(model);
  EXPECT_EQ(made_again.kernels, 0U);
  EXPECT_EQ(kept.kernels, 3U) << "one a motion increment";
  EXPECT_EQ(kept.log_likelihood, made_again.log_likelihood);
  EXPECT_EQ(kept.turns, made_again.turns);
  for (int t = 0; t < 4; ++t) {
    for (int c = 0; c < kHeadings; ++c)
      EXPECT_EQ(kept.beliefs[t].layers[c].values, made_again.beliefs[t].layers[c].values);
  }
}

TEST(EStep, WholeTablesHoldTheSameBeliefAndMore) {
  const Perception perception = RandomPerception();
  EStepModel model = TinyModel(&perception);
  model.prune = 1e-3;
  model.limit = Box{-8, -8, 17, 17};
  const Pass boxes(model);
  model.whole_tables = true;
  const Pass whole(model);
  EXPECT_NEAR(whole.log_likelihood, boxes.log_likelihood, 1e-12);
  for (int t = 0; t < 4; ++t) {
    EXPECT_NEAR(whole.turns[t], boxes.turns[t], 1e-12);
    for (int c = 0; c < kHeadings; ++c) {
      ASSERT_EQ(whole.beliefs[t].layers[c].box, model.limit);
      for (int y = -8; y <= 8; ++y) {
        for (int x = -8; x <= 8; ++x)
          ASSERT_NEAR(whole.beliefs[t].layers[c].At(x, y), boxes.beliefs[t].layers[c].At(x, y), 1e-12);
      }
    }
  }
  EXPECT_LT(boxes.beliefs[0].cells(), whole.beliefs[0].cells());
}

TEST(EStep, ImpossibleEvidenceNamesRobotStepAndObservation) {
  const RobotSteps steps = TinySteps();
  Perception perception = RandomPerception();
  perception.likelihood.layers[1] = Layer(Box{100, 100, 1, 1});
  perception.outside = {0.02, 0.0};
  const EStepModel model = TinyModel(&perception);
  NoProgress progress;
  try {
    Forward(model, {steps, 0, 4, "rover"}, DiracStart(model.grid), progress);
    FAIL();
  } catch (const InputError& e) {
    const std::string what = e.what();
    for (const char* part : {"rover", "step 2", "impossible", "landmark type 1"}) {
      EXPECT_NE(what.find(part), std::string::npos) << what;
    }
  }
}

// Hundreds of unlikely observations at one step leave the range of a double unless each is normalised.
TEST(EStep, ManyUnlikelyObservationsAtOneStepStayFinite) {
  RobotSteps steps = TinySteps();
  steps.observations.assign(400, Observation{0, 0.4, 0.1});
  steps.first_observation = {0, 0, 0, 200, 400};
  Perception perception = RandomPerception();
  for (double& value : perception.likelihood.layers[0].values) value *= 1e-6;
  perception.outside[0] *= 1e-6;
  EStepModel model = TinyModel(&perception);
  model.prune = 1e-3;
  NoProgress progress;
  const Slice slice{steps, 0, 4, "a"};
  const LayeredGrid start = DiracStart(model.grid);
  const Alphas alphas = Forward(model, slice, start, progress);
  EXPECT_TRUE(std::isfinite(alphas.log_likelihood));
  EXPECT_LT(alphas.log_likelihood, -400 * 10.0);
  Backward(model, slice, alphas, start, UniformBeta(alphas.tables.back()), progress,
           Visitor{[](int, const LayeredGrid& belief) { EXPECT_NEAR(belief.Sum(), 1.0, 1e-12); }, nullptr});
}

// One landmark, which the robot first sees at its third step, 1.5 m ahead.
TEST(EStep, AStartAnywhereHoldsEveryPlaceThatLeadsToTheFirstObservation) {
  RobotSteps steps = TinySteps();
  steps.observations = {{0, 1.5, 0.0}};
  steps.first_observation = {0, 0, 0, 1, 1};
  Perception perception;
  perception.likelihood.layers = {Layer(Box{20, 10, 1, 1}), Layer()};
  perception.outside = {0.01, 0.01};
  EStepModel model = TinyModel(&perception);
  for (const auto& [forward_error, walk] :
       {std::pair{0.0, 0.0}, {0.1, 0.0}, {0.4, 0.0}, {0.0, 0.1}, {0.0, 0.2}}) {
    model.noise = {0.0, walk, 1.0, forward_error, 0.0};
    const double distance_m = steps.path_m[1] + steps.path_m[2],
                 astray_m = forward_error * distance_m + walk * std::pow(distance_m, 1.5);
    const LayeredGrid start = UniformStart(model, {steps, 0, 4, "a"});
    EXPECT_NEAR(start.Sum(), 1.0, 1e-12);
    for (int c = 0; c < kHeadings; ++c) {
      const double angle = c * 2 * std::numbers::pi / kHeadings;
      const double dx = steps.odo_x_m[2] + 1.5, dy = steps.odo_y_m[2];
      const double x = 20.0 - (std::cos(angle) * dx - std::sin(angle) * dy) / model.grid.cell_m;
      const double y = 10.0 - (std::sin(angle) * dx + std::cos(angle) * dy) / model.grid.cell_m;
      const Box& box = start.layers[static_cast<std::size_t>(c)].box;
      EXPECT_TRUE(box.Contains(static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y)))) << c;
      // What lies next to it, and what lies within three standard deviations of the way: no more.
      EXPECT_LE(box.nx, 2 + 2 * std::ceil(3.0 * astray_m / model.grid.cell_m)) << c;
      EXPECT_GE(box.nx, 2 + 2 * std::floor(3.0 * astray_m / model.grid.cell_m)) << c;
    }
  }
  steps.observations[0].type = 1;  // which the map does not hold
  EXPECT_THROW(UniformStart(model, {steps, 0, 4, "a"}), NoPathError);
}

TEST(EStep, ABoxTooSmallAndAMemoryTooSmallAreNamed) {
  const RobotSteps steps = TinySteps();
  EStepModel model = TinyModel(nullptr);
  NoProgress progress;
  model.limit = Box{0, 0, 1, 1};
  const MotionNoise noise = model.noise;
  model.noise = {};
  try {
    Forward(model, {steps, 0, 4, "a"}, DiracStart(model.grid), progress);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("left the box"), std::string::npos) << e.what();
  }
  model.limit = Box{};
  model.noise = noise;
  model.memory_bytes = 100;
  try {
    Forward(model, {steps, 0, 4, "a"}, DiracStart(model.grid), progress);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("memory_mb"), std::string::npos) << e.what();
  }
}

// [TBF98] section 6: beta globally localizes the robot, with the data in reverse order.
TEST(EStep, BetaIsLocalizationInTheReversedData) {
  const RobotSteps steps = TinySteps();
  RobotSteps reversed = steps;
  reversed.odo_x_m = {1.9, 1.9, 1.2, 0.0};
  reversed.odo_y_m = {2.1, 1.3, 0.3, 0.0};
  reversed.path_m = {0, 0.8, 1.3, 1.3};
  reversed.turn_rad = {0, 0.6, 0.8, 0.2};
  reversed.first_observation = {0, 1, 3, 3, 3};  // beta of a step does not hold that step's own
  reversed.observations = {steps.observations[3], steps.observations[1], steps.observations[2]};
  const Perception perception = RandomPerception();
  const EStepModel model = TinyModel(&perception);
  LayeredGrid anywhere;
  for (int c = 0; c < kHeadings; ++c) {
    anywhere.layers.emplace_back(Box{-4, -4, 9, 9});
    anywhere.layers.back().values.assign(81, 1.0);
  }
  anywhere.Scale(1.0 / anywhere.Sum());

  NoProgress progress;
  const Slice later{steps, 1, 4, "a"};
  const Alphas alphas = Forward(model, later, anywhere, progress);
  const LayeredGrid last = UniformBeta(alphas.tables.back());
  const Visitor nothing{[](int, const LayeredGrid&) {}, nullptr};
  LayeredGrid beta = Backward(model, later, alphas, anywhere, last, progress, nothing);
  beta.Scale(1.0 / beta.Sum());

  LayeredGrid start = last;
  start.Scale(1.0 / start.Sum());
  const LayeredGrid back = Forward(model, Slice{reversed, 0, 4, "a"}, start, progress).tables.back();
  double shared = 0.0;  // the reversed data also reach places where the robot may not have started
  for (std::size_t c = 0; c < beta.layers.size(); ++c) {
    for (int y = -4; y < 5; ++y) {
      for (int x = -4; x < 5; ++x) shared += back.layers[c].At(x, y);
    }
  }
  for (std::size_t c = 0; c < beta.layers.size(); ++c) {
    for (int y = -4; y < 5; ++y) {
      for (int x = -4; x < 5; ++x)
        EXPECT_NEAR(beta.layers[c].At(x, y), back.layers[c].At(x, y) / shared, 1e-12);
    }
  }
  EXPECT_GT(beta.Max(), 2.0 / (81 * kHeadings));  // it is not uniform
}

}  // namespace
}  // namespace cairn::landmark_map
