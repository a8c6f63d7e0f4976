#include "pipelines/common/motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pipelines/common/handed_over.h"

namespace cairn {
namespace {

int Wrap(int layer, int layers) { return ((layer % layers) + layers) % layers; }

Box Reach(const Box& box, const Stencil& stencil) {
  Box reach;
  for (const StencilPoint& p : stencil) reach = Union(reach, box.Shifted(p.dx, p.dy));
  return reach;
}

Layer Shift(const Layer& layer, const Stencil& stencil) {
  Layer shifted(Reach(layer.box, stencil));
  for (const StencilPoint& p : stencil) shifted.AddShifted(layer, p.dx, p.dy, p.weight);
  return shifted;
}

// to(x) += weight * from(x + dx, y + dy) over `to`'s box, zero outside `from`'s.
void Gather(const Layer& from, int dx, int dy, double weight, Layer* to) {
  const Box common = Intersection(to->box, from.box.Shifted(-dx, -dy));
  for (int y = common.y0; y < common.y0 + common.ny; ++y) {
    const RowOf<const double> source = from.Row(y + dy) + dx;
    const RowOf<double> target = to->Row(y);
    for (int x = common.x0; x < common.x0 + common.nx; ++x)
      target[x] = std::fma(weight, source[x], target[x]);
  }
}

// Sum of the products over the cells that both have. Eight running values, as in Layer::Sum.
double Dot(const Layer& a, const Layer& b) {
  const Box common = Intersection(a.box, b.box);
  std::array<double, 8> lanes{};
  for (int y = common.y0; y < common.y0 + common.ny; ++y) {
    const double* p = &a.Row(y)[common.x0];
    const double* q = &b.Row(y)[common.x0];
    int i = 0;
    for (; i + 8 <= common.nx; i += 8) {
      for (int k = 0; k < 8; ++k) lanes[k] = std::fma(p[i + k], q[i + k], lanes[k]);
    }
    for (int k = 0; i < common.nx; ++i, ++k) lanes[k] = std::fma(p[i], q[i], lanes[k]);
  }
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

// For each layer the box that holds the boxes of all layers within `reach` of it, around the circle.
std::vector<Box> Dilated(const LayeredGrid& grid, int reach) {
  const int layers = static_cast<int>(grid.layers.size());
  std::vector<Box> boxes(grid.layers.size());
  for (int c = 0; c < layers; ++c) {
    const Box& box = grid.layers[c].box;
    if (box.empty()) continue;
    for (int k = -reach; k <= reach; ++k) {
      Box& wide = boxes[Wrap(c + k, layers)];
      wide = Union(wide, box);
    }
  }
  return boxes;
}

}  // namespace

IncrementError ErrorOf(const MotionIncrement& increment, const MotionNoise& noise) {
  const double drift = noise.heading_drift_rad_per_m;
  const double drift_squared = drift * drift * noise.drift_length_m * increment.path_m;
  const double walk_squared =
      noise.heading_walk_rad_per_sqrt_m * noise.heading_walk_rad_per_sqrt_m * increment.path_m;
  const double turn = noise.turn_ratio * increment.turn_rad;
  // [TBF98] section 2.1: the error grows with the length of the motion.
  return {std::sqrt(drift_squared + walk_squared + turn * turn), noise.forward_ratio * increment.path_m};
}

MotionKernel::MotionKernel(const MotionIncrement& increment, const IncrementError& error, double cell_m,
                           int headings, ErrorShape shape)
    : dx_(increment.dx_m / cell_m),
      dy_(increment.dy_m / cell_m),
      along_(error.along_m / cell_m),
      headings_(headings),
      heading_step_(2.0 * std::numbers::pi / headings) {
  constexpr double kFarthest = 1 << 26;  // cells
  for (const double cells : {dx_, dy_, along_})
    RequireWithin("a motion's cells", cells, -kFarthest, kFarthest);
  RequireWithin("the error of a motion's heading", error.heading_rad, 0.0,
                std::numeric_limits<double>::max());
  // Beyond an eighth of the circle a heading is as good as unknown, and taps would go round it.
  const double half_sigma = std::min(error.heading_rad / std::numbers::sqrt2 / heading_step_, headings / 8.0);
  // [TBF98] eq. 1, footnote 1: the error of the heading
  half_turn_ = shape == ErrorShape::kGaussian ? GaussianTaps(half_sigma) : TriangularTaps(half_sigma);
  const double length = std::sqrt(dx_ * dx_ + dy_ * dy_);
  ux_ = length > 0 ? dx_ / length : 1.0;
  uy_ = length > 0 ? dy_ / length : 0.0;
}

Stencil MotionKernel::StencilOf(int layer) const {
  if (kept_.empty()) return MakeStencil(layer);
  Stencil& kept = kept_[static_cast<std::size_t>(layer)];
  if (kept.size == 0) kept = MakeStencil(layer);
  return kept;
}

Stencil MotionKernel::MakeStencil(int layer) const {
  const double cosine = std::cos(layer * heading_step_), sine = std::sin(layer * heading_step_);
  // [TBF98] eq. 1 for one heading
  // [TBF98] section 5, symmetry: the same stencil for all places
  return ShiftStencil(cosine * dx_ - sine * dy_, sine * dx_ + cosine * dy_, cosine * ux_ - sine * uy_,
                      sine * ux_ + cosine * uy_, along_);
}

HalfTurn MotionKernel::FirstHalfTurn(const LayeredGrid& belief, const LayeredGrid& middle) const {
  const int reach = half_turn_.reach(), headings = static_cast<int>(belief.layers.size());
  double prior = 0.0, mass = 0.0, first = 0.0, second = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    double joint = 0.0;
    for (int c = 0; c < headings; ++c) joint += Dot(belief.layers[c], middle.layers[Wrap(c + k, headings)]);
    joint *= half_turn_.At(k);
    prior += half_turn_.At(k) * k * k;
    mass += joint;
    first += joint * k;
    second += joint * k * k;
  }
  const double square = heading_step_ * heading_step_;
  if (!(mass > 0.0)) return {prior * square, 0.0, prior * square};
  const double mean = first / mass;
  return {prior * square, mean * heading_step_, (second / mass - mean * mean) * square};
}

LayeredGrid MotionKernel::TurnForward(const LayeredGrid& belief) const {
  const int reach = half_turn_.reach(), headings = static_cast<int>(belief.layers.size());
  if (reach == 0) return belief;
  LayeredGrid turned;
  turned.layers.resize(belief.layers.size());
  const std::vector<Box> boxes = Dilated(belief, reach);
  for (int c = 0; c < headings; ++c) {
    if (boxes[c].empty()) continue;
    Layer layer(boxes[c]);
    for (int k = -reach; k <= reach; ++k) {
      layer.AddShifted(belief.layers[Wrap(c - k, headings)], 0, 0, half_turn_.At(k));
    }
    turned.layers[c] = std::move(layer);
  }
  return turned;
}

LayeredGrid MotionKernel::Forward(const LayeredGrid& belief) const {
  // [TBF98] eqs 2, 16
  LayeredGrid moved = TurnForward(belief);
  for (std::size_t c = 0; c < moved.layers.size(); ++c) {
    if (!moved.layers[c].box.empty())
      moved.layers[c] = Shift(moved.layers[c], StencilOf(static_cast<int>(c)));
  }
  return TurnForward(moved);
}

LayeredGrid MotionKernel::Backward(const LayeredGrid& message, const LayeredGrid& support,
                                   HalfTurn* half_turn) const {
  const int reach = half_turn_.reach(), headings = static_cast<int>(support.layers.size());
  const auto at = [&](int c) { return static_cast<std::size_t>(Wrap(c, headings)); };
  // Where the first half turn can have put the support: the only cells of the middle stage that matter.
  LayeredGrid middle;
  middle.layers.resize(support.layers.size());
  const std::vector<Box> boxes = Dilated(support, reach);
  for (int c = 0; c < headings; ++c) {
    if (boxes[c].empty()) continue;
    const Stencil stencil = StencilOf(c);
    Layer turned(Reach(boxes[c], stencil));
    for (int k = -reach; k <= reach; ++k) Gather(message.layers[at(c + k)], 0, 0, half_turn_.At(k), &turned);
    Layer layer(boxes[c]);
    for (const StencilPoint& p : stencil) Gather(turned, p.dx, p.dy, p.weight, &layer);
    middle.layers[at(c)] = std::move(layer);
  }
  if (half_turn != nullptr) *half_turn = FirstHalfTurn(support, middle);
  // [TBF98] eq. 17
  LayeredGrid result;
  result.layers.resize(support.layers.size());
  for (int c = 0; c < headings; ++c) {
    if (support.layers[at(c)].box.empty()) continue;
    Layer layer(support.layers[at(c)].box);
    for (int k = -reach; k <= reach; ++k) Gather(middle.layers[at(c + k)], 0, 0, half_turn_.At(k), &layer);
    result.layers[at(c)] = std::move(layer);
  }
  return result;
}

}  // namespace cairn
