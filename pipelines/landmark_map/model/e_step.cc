#include "pipelines/landmark_map/model/e_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cairn::landmark_map {
namespace {

std::string Time(double seconds) { return fmt::format("{:.3f}", seconds); }

template <class E = NoPathError>
[[noreturn]] void Refuse(const Slice& slice, int step, const std::string& why) {
  throw E("robot '" + slice.robot + "', step " + std::to_string(step) + " (time " +
          Time(slice.steps.time_s[step]) + " s): " + why);
}

MotionKernel KernelTo(const EStepModel& model, const Slice& slice, int step) {
  const MotionIncrement increment = slice.steps.IncrementTo(step);
  return {increment, ErrorOf(increment, model.noise), model.grid.cell_m, model.grid.headings, model.shape};
}

// [TBF98] eq. 16 from the step before; step 0 has no motion increment to it. `kept` (may be nullptr): takes
// the kernel.
LayeredGrid Moved(const EStepModel& model, const Slice& slice, int step, const LayeredGrid& belief,
                  std::vector<MotionKernel>* kept) {
  if (step == 0) return belief;
  MotionKernel kernel = KernelTo(model, slice, step);
  if (kept == nullptr) return kernel.Forward(belief);
  kernel.KeepStencils();
  LayeredGrid moved = kernel.Forward(belief);
  kept->push_back(std::move(kernel));
  return moved;
}

// [TBF98] eq. 17 over the motion increment to `step`, by the kernel that the forward pass kept or one like
// it.
LayeredGrid MovedBack(const EStepModel& model, const Slice& slice, int step, const Alphas& alphas,
                      const LayeredGrid& message, const LayeredGrid& support, HalfTurn* half_turn) {
  if (alphas.kernels.empty()) return KernelTo(model, slice, step).Backward(message, support, half_turn);
  const int first_increment = std::max(slice.first, 1);
  return alphas.kernels[static_cast<std::size_t>(step - first_increment)].Backward(message, support,
                                                                                   half_turn);
}

// Multiplies by P(o | xi, m) for all that was seen at a step and returns the logarithm by which the table was
// scaled: after each observation its largest value is one again, or many of them would leave the range of a
// double.
double ObserveAll(const EStepModel& model, const Slice& slice, int step, LayeredGrid* belief) {
  double log_scale = 0.0;
  // [TBF98] section 4.1.3: the first E-step has no map and ignores what was observed.
  if (model.perception == nullptr) return log_scale;
  const RobotSteps& steps = slice.steps;
  for (int k = steps.first_observation[step]; k < steps.first_observation[step + 1]; ++k) {
    Observe(steps.observations[k], model.grid, *model.perception, belief);
    const double max = belief->Max();
    if (!std::isnormal(max)) return log_scale;  // the caller sees it
    belief->Scale(1.0 / max);
    log_scale += std::log(max);
  }
  return log_scale;
}

void Cut(const Box& limit, LayeredGrid* belief) {
  if (limit.empty()) return;
  for (Layer& layer : belief->layers) {
    const Box kept = Intersection(layer.box, limit);
    if (kept == layer.box) continue;
    Layer cut(kept);
    for (int y = kept.y0; y < kept.y0 + kept.ny; ++y) {
      for (int x = kept.x0; x < kept.x0 + kept.nx; ++x) cut.Row(y)[x] = layer.Row(y)[x];
    }
    layer = std::move(cut);
  }
}

std::string Seen(const Slice& slice, int step) {
  const int count = slice.steps.first_observation[step + 1] - slice.steps.first_observation[step];
  if (count == 0) return "nothing was observed there";
  std::string text = "observed there:";
  for (int k = slice.steps.first_observation[step]; k < slice.steps.first_observation[step + 1]; ++k) {
    const Observation& o = slice.steps.observations[k];
    const double range_m = std::hypot(o.x_m, o.y_m);
    text += range_m > 0 ? " landmark type " + std::to_string(o.type) + " at " + Time(range_m) + " m;"
                        : " a contact detection of landmark type " + std::to_string(o.type) + ";";
  }
  text.pop_back();
  return text;
}

// Observes, normalises, prunes and normalises again; returns the logarithm of P(o | past).
double NormalizeAndPrune(const EStepModel& model, const Slice& slice, int step, LayeredGrid* belief) {
  Cut(model.limit, belief);
  const double before = belief->Sum();
  if (!(before > 0.0))
    Refuse(slice, step,
           "the robot has left the box that box_m allows: all probability lies outside; take a larger box_m, "
           "or 0");
  // [TBF98] eq. 15
  const double log_scale = ObserveAll(model, slice, step, belief);
  const double after = belief->Sum();
  if (!std::isnormal(after)) {
    Refuse(slice, step,
           "the evidence is impossible under the model, all probability vanished; " + Seen(slice, step));
  }
  // [TBF98] section 5, selective computation and memorization
  const double least = model.prune * belief->Max();
  for (Layer& layer : belief->layers) {
    layer.Prune(least);
    if (model.whole_tables) layer.Cover(model.limit);
  }
  // [TBF98] eq. 15, its normaliser
  belief->Scale(1.0 / belief->Sum());
  return std::log(after / before) + log_scale;
}

// `held`: cells of the tables that are kept already; `largest`: of any of them or the one at hand.
void CheckMemory(const EStepModel& model, const Slice& slice, int step, std::int64_t held,
                 std::int64_t largest) {
  const double cells = static_cast<double>(held) + kBeliefCopies * static_cast<double>(largest);
  const double bytes = cells * sizeof(double);
  if (bytes <= model.memory_bytes) return;
  Refuse<InputError>(
      slice, step,
      "the beliefs would need about " + std::to_string(std::llround(std::ceil(bytes / 1e6))) +
          " MB or more, memory_mb = " + std::to_string(std::llround(model.memory_bytes / 1e6)) +
          ": take a larger cell_m or heading_deg, or a smaller slice_mcells");
}

// Scales a message to a largest value of one. What alpha keeps always has a way on, so beta never vanishes
// there.
void Rescale(const Slice& slice, int step, LayeredGrid* message) {
  const double max = message->Max();
  if (!std::isnormal(max)) Refuse(slice, step, "alpha and beta have no pose in common");
  message->Scale(1.0 / max);
}

// alpha * beta, normalised; zero where either is.
LayeredGrid Product(const Slice& slice, int step, const LayeredGrid& alpha, const LayeredGrid& beta) {
  LayeredGrid product = alpha;
  for (std::size_t c = 0; c < product.layers.size(); ++c) {
    std::vector<double>& values = product.layers[c].values;
    const std::vector<double>& other = beta.layers[c].values;
    // [TBF98] eq. 13
    for (std::size_t i = 0; i < values.size(); ++i) values[i] *= other[i];
  }
  Rescale(slice, step, &product);
  product.Scale(1.0 / product.Sum());
  return product;
}

// Zero wherever alpha is zero: the belief lives nowhere else.
void Mask(const LayeredGrid& alpha, LayeredGrid* message) {
  for (std::size_t c = 0; c < message->layers.size(); ++c) {
    std::vector<double>& values = message->layers[c].values;
    const std::vector<double>& mask = alpha.layers[c].values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (mask[i] == 0.0) values[i] = 0.0;
    }
  }
}

}  // namespace

LayeredGrid DiracStart(const GridSpec& grid) {
  LayeredGrid belief;
  belief.layers.resize(static_cast<std::size_t>(grid.headings));
  belief.layers[0] = Layer(Box{0, 0, 1, 1});
  // [TBF98] eq. 14
  belief.layers[0].values[0] = 1.0;
  return belief;
}

int MotionMargin(const EStepModel& model, const RobotSteps& steps, int step) {
  constexpr double kReach = 3.0;  // standard deviations
  MotionIncrement motion;
  for (int s = 1; s <= step; ++s) {
    motion.path_m += steps.path_m[s];
    motion.turn_rad += steps.turn_rad[s];
  }
  const IncrementError error = ErrorOf(motion, model.noise);
  const double astray_m = std::min(2.0, kReach * error.heading_rad) * motion.path_m + kReach * error.along_m;
  return static_cast<int>(std::ceil(astray_m / model.grid.cell_m));
}

std::vector<Box> StartBoxes(const EStepModel& model, const Slice& slice) {
  CAIRN_DEMAND(model.perception != nullptr, "a robot that starts anywhere needs a map");
  const RobotSteps& steps = slice.steps;
  int step = 0, known = 0;  // the first observation that the map can place
  while (known < steps.first_observation.back() &&
         model.perception->Of(steps.observations[known].type).box.empty())
    ++known;
  if (known == steps.first_observation.back())
    Refuse(slice, 0, "the map holds nothing of what the robot saw: it cannot be placed");
  while (steps.first_observation[step + 1] <= known) ++step;
  const int margin = MotionMargin(model, steps, step);
  std::vector<Box> boxes;
  for (int c = 0; c < model.grid.headings; ++c) {
    const double angle = c * 2.0 * std::numbers::pi / model.grid.headings;
    const double dx = steps.odo_x_m[step] - steps.odo_x_m[0], dy = steps.odo_y_m[step] - steps.odo_y_m[0];
    const double x = std::cos(angle) * dx - std::sin(angle) * dy,
                 y = std::sin(angle) * dx + std::cos(angle) * dy;
    const auto cells = [&](double distance_m) {
      return static_cast<int>(std::lround(distance_m / model.grid.cell_m));
    };
    const Box places = PlacesThatSee(steps.observations[known], model.grid, *model.perception, c);
    boxes.push_back(places.Shifted(-cells(x), -cells(y)).Grown(margin));
  }
  return boxes;
}

LayeredGrid UniformOver(const std::vector<Box>& boxes) {
  LayeredGrid belief;
  for (const Box& box : boxes) {
    Layer layer(box);
    // [TBF98] section 8: a robot whose start is unknown may be anywhere.
    layer.values.assign(layer.values.size(), 1.0);
    belief.layers.push_back(std::move(layer));
  }
  belief.Scale(1.0 / belief.Sum());
  return belief;
}

LayeredGrid UniformStart(const EStepModel& model, const Slice& slice) {
  return UniformOver(StartBoxes(model, slice));
}

LayeredGrid UniformBeta(const LayeredGrid& support) {
  LayeredGrid beta = support;
  for (Layer& layer : beta.layers) {
    // [TBF98] section 4.1.2: beta of the last step is uniform.
    for (double& value : layer.values) value = value > 0.0 ? 1.0 : 0.0;
  }
  return beta;
}

Alphas Forward(const EStepModel& model, const Slice& slice, const LayeredGrid& before, Progress& progress) {
  Alphas alphas;
  std::int64_t cells = 0, largest = 0;
  for (int step = slice.first; step < slice.end; ++step) {
    progress.Tick();
    LayeredGrid belief = Moved(model, slice, step, alphas.tables.empty() ? before : alphas.tables.back(),
                               model.keep_kernels ? &alphas.kernels : nullptr);
    alphas.work += static_cast<double>(belief.cells()) + kStepCells;
    largest = std::max(largest, belief.cells());
    CheckMemory(model, slice, step, cells, largest);
    // [TBF98] eq. 12: what it maximises is the product of the normalisers of all steps.
    alphas.log_likelihood += NormalizeAndPrune(model, slice, step, &belief);
    cells += belief.cells();
    alphas.tables.push_back(std::move(belief));
  }
  return alphas;
}

std::int64_t Alphas::Cells() const {
  std::int64_t cells = 0;
  for (const LayeredGrid& table : tables) cells += table.cells();
  return cells;
}

Frontier ForwardFor(const EStepModel& model, const Slice& slice, LayeredGrid before, double work,
                    Progress& progress) {
  Frontier frontier{slice.first, std::move(before)};
  for (double done = 0.0; frontier.end < slice.end && (done == 0.0 || done < work); ++frontier.end) {
    progress.Tick();
    LayeredGrid belief = Moved(model, slice, frontier.end, frontier.alpha, nullptr);
    done += static_cast<double>(belief.cells()) + kStepCells;
    CheckMemory(model, slice, frontier.end, 0, belief.cells());
    NormalizeAndPrune(model, slice, frontier.end, &belief);
    frontier.alpha = std::move(belief);
  }
  return frontier;
}

LayeredGrid Backward(const EStepModel& model, const Slice& slice, const Alphas& alphas,
                     const LayeredGrid& before, LayeredGrid beta, Progress& progress,
                     const Visitor& visitor) {
  const bool learn = model.perception != nullptr && visitor.increment;
  for (int step = slice.end - 1; step >= slice.first; --step) {
    progress.Tick();
    const LayeredGrid& alpha = alphas.tables[static_cast<std::size_t>(step - slice.first)];
    visitor.step(step, Product(slice, step, alpha, beta));
    if (step == 0) return {};
    // [TBF98] eq. 18
    ObserveAll(model, slice, step, &beta);
    const LayeredGrid& support =
        step == slice.first ? before : alphas.tables[static_cast<std::size_t>(step - 1 - slice.first)];
    HalfTurn turn;
    // [TBF98] eq. 17
    beta = MovedBack(model, slice, step, alphas, beta, support, learn ? &turn : nullptr);
    if (learn) visitor.increment(step, turn);
    Mask(support, &beta);
    Rescale(slice, step - 1, &beta);
  }
  return beta;
}

LayeredGrid ForwardOnly(const Slice& slice, const Alphas& alphas, const LayeredGrid& before,
                        const Visitor& visitor) {
  for (int step = slice.end - 1; step >= slice.first; --step) {
    visitor.step(step, alphas.tables[static_cast<std::size_t>(step - slice.first)]);
  }
  return slice.first == 0 ? LayeredGrid{} : UniformBeta(before);
}

}  // namespace cairn::landmark_map
