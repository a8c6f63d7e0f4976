#include "pipelines/landmark_learning/error_sum/pairs.h"

#include <algorithm>
#include <cmath>

#include "pipelines/landmark_learning/error_sum/lane_math.h"
#include "schema/error.h"

namespace cairn::landmark_learning {
namespace {

// What rounding may make of a distance that is compared with the reach.
constexpr double kRounding = 1e-6;

// Relative to a point near by, so that float keeps what double has; the last one again up to whole tiles.
template <class Real>
void From(const std::vector<double>& values, const IndexRange& range, double origin,
          std::vector<Real>* relative) {
  const int whole = (range.size() + kTileSamples - 1) / kTileSamples * kTileSamples;
  relative->resize(static_cast<std::size_t>(whole));
  for (int k = 0; k < whole; ++k) {
    const auto at = static_cast<std::size_t>(std::min(range.first + k, range.end - 1));
    (*relative)[static_cast<std::size_t>(k)] = static_cast<Real>(values[at] - origin);
  }
}

// e and Bel_prior of a register of pairs.
template <class L>
class PairLanes {
 public:
  using Real = typename L::Number;
  using Register = typename L::Register;

  PairLanes(const Belief& belief, const ErrorRule& error)
      : gaussian_(belief.shape == BeliefShape::kGaussian),
        error_(error.kind),
        bell_(L::Broadcast(static_cast<Real>(-0.5 / (error.smooth_m * error.smooth_m)))),
        reach_(L::Broadcast(static_cast<Real>(belief.ReachM()))),
        scale_(L::Broadcast(static_cast<Real>(-0.5 / (belief.width_m * belief.width_m)))) {}

  Register Distance(Register dx, Register dy) const { return L::Sqrt(L::Fma(dx, dx, L::Mul(dy, dy))); }
  Register Error(Register distance) const {
    if (error_ == ErrorKind::kPosteriorMass)
      return ExpOfNegative<L>(L::Mul(bell_, L::Mul(distance, distance)));
    return error_ == ErrorKind::kDistance ? distance : L::Mul(distance, distance);
  }
  Register Believed(Register distance) const {
    const auto within =
        gaussian_ ? ExpOfNegative<L>(L::Mul(scale_, L::Mul(distance, distance))) : L::Broadcast(Real(1));
    return L::IfAtMost(distance, reach_, within);
  }

 private:
  bool gaussian_;
  ErrorKind error_;
  Register bell_, reach_, scale_;
};

}  // namespace

Box BoxAround(const Positions& positions, const IndexRange& range) {
  const auto [low_x, high_x] =
      std::minmax_element(positions.x_m.begin() + range.first, positions.x_m.begin() + range.end);
  const auto [low_y, high_y] =
      std::minmax_element(positions.y_m.begin() + range.first, positions.y_m.begin() + range.end);
  return {*low_x, *high_x, *low_y, *high_y};
}

// [Thr98] section 3.1 lets e be the Kullback-Leibler divergence; of a point mass at the truth it is -log.
double MassCost::Of(double u) { return -std::log((1.0 - kLeast) * u + kLeast); }

Pairs::Pairs(const Positions& true_positions, const Positions& samples, const Belief& belief,
             const ErrorRule& error)
    : true_(true_positions), samples_(samples), belief_(belief), error_(error) {
  CAIRN_DEMAND(!belief.LooksAtHeadings() || (true_positions.cos_heading.size() == true_positions.x_m.size() &&
                                             samples.cos_heading.size() == samples.x_m.size()),
               "headings, where beliefs look at them");
  if (std::isinf(belief.ReachM())) return;
  for (int first = 0; first < samples.size(); first += kTileSamples)
    tiles_.push_back(BoxAround(samples, {first, std::min(samples.size(), first + kTileSamples)}));
  until_ = tiles_;
  for (std::size_t t = 1; t < tiles_.size(); ++t) {
    until_[t].high_x_m = std::max(until_[t].high_x_m, until_[t - 1].high_x_m);
    until_[t].high_y_m = std::max(until_[t].high_y_m, until_[t - 1].high_y_m);
    const std::size_t from_last = tiles_.size() - 1 - t;
    until_[from_last].low_x_m = std::min(until_[from_last].low_x_m, until_[from_last + 1].low_x_m);
    until_[from_last].low_y_m = std::min(until_[from_last].low_y_m, until_[from_last + 1].low_y_m);
  }
}

// Outside of them every tile lies beyond the reach; two searches where samples are in the order of a
// coordinate.
IndexRange Pairs::TilesAround(const Box& true_positions) const {
  const double reach = belief_.ReachM() * (1.0 + kRounding);
  const auto first = std::ranges::partition_point(until_, [&](const Box& t) {
    return t.high_x_m < true_positions.low_x_m - reach || t.high_y_m < true_positions.low_y_m - reach;
  });
  const auto end = std::ranges::partition_point(until_, [&](const Box& t) {
    return t.low_x_m <= true_positions.high_x_m + reach && t.low_y_m <= true_positions.high_y_m + reach;
  });
  return {static_cast<int>(first - until_.begin()), static_cast<int>(std::max(first, end) - until_.begin())};
}

void Pairs::Reach(const IndexRange& true_positions, std::vector<Stretch>* stretches) const {
  stretches->clear();
  const int count = samples_.size();
  if (std::isinf(belief_.ReachM())) {
    stretches->push_back({{0, count}, !belief_.LooksAtHeadings()});
    return;
  }
  const Box box = BoxAround(true_, true_positions);
  const double reach = belief_.ReachM();
  const double within = std::pow(reach * (1.0 - kRounding), 2),
               beyond = std::pow(reach * (1.0 + kRounding), 2);
  const IndexRange around = TilesAround(box);
  for (int t = around.first; t < around.end; ++t) {
    const Box& tile = tiles_[static_cast<std::size_t>(t)];
    const double near_x = std::max({0.0, tile.low_x_m - box.high_x_m, box.low_x_m - tile.high_x_m});
    const double near_y = std::max({0.0, tile.low_y_m - box.high_y_m, box.low_y_m - tile.high_y_m});
    if (near_x * near_x + near_y * near_y > beyond) continue;
    const double far_x = std::max(tile.high_x_m - box.low_x_m, box.high_x_m - tile.low_x_m);
    const double far_y = std::max(tile.high_y_m - box.low_y_m, box.high_y_m - tile.low_y_m);
    const bool all = belief_.shape == BeliefShape::kUniform && !belief_.LooksAtHeadings() &&
                     far_x * far_x + far_y * far_y <= within;
    const int first = t * kTileSamples, end = std::min(count, first + kTileSamples);
    if (!stretches->empty() && stretches->back().samples.end == first && stretches->back().all == all)
      stretches->back().samples.end = end;
    else
      stretches->push_back({{first, end}, all});
  }
}

IndexRange Pairs::ReachOf(const IndexRange& true_positions) const {
  std::vector<Stretch> stretches;
  Reach(true_positions, &stretches);
  if (stretches.empty()) return {0, 0};
  return {stretches.front().samples.first, stretches.back().samples.end};
}

// The table's errors of a row and those of some samples, up to whole tiles.
template <class Real>
void Pairs::LookUp(std::int32_t row, const IndexRange& samples, std::vector<Real>* errors) const {
  const float* table = samples_.table.As<float>().data() + row * samples_.table.shape()[1];
  for (int k = 0; k < static_cast<int>(errors->size()); ++k) {
    const auto at = static_cast<std::size_t>(std::min(samples.first + k, samples.end - 1));
    (*errors)[static_cast<std::size_t>(k)] = static_cast<Real>(table[samples_.row[at]]);
  }
}

template <class Real>
void Pairs::KeepThoseThatFaceAs(std::size_t truth, const Columns<Real>& columns, Real* belief,
                                Real* weighted) const {
  using L = Lanes<Real>;
  const auto cos_a = L::Broadcast(static_cast<Real>(-true_.cos_heading[truth]));
  const auto sin_a = L::Broadcast(static_cast<Real>(-true_.sin_heading[truth]));
  const auto most = L::Broadcast(static_cast<Real>(kRounding - std::cos(belief_.heading_rad)));
  for (int k = 0; k < static_cast<int>(columns.x.size()); k += L::kCount) {
    const auto turned = L::Fma(cos_a, L::Load(columns.cos_heading.data() + k),
                               L::Mul(sin_a, L::Load(columns.sin_heading.data() + k)));
    // [Thr98] section 5.1.2: xi = (x, y, theta)
    L::Store(belief + k, L::IfAtMost(turned, most, L::Load(belief + k)));
    L::Store(weighted + k, L::IfAtMost(turned, most, L::Load(weighted + k)));
  }
}

template <class Real>
void Pairs::Fill(const IndexRange& true_positions, const Stretch& stretch, int stride, Columns<Real>* columns,
                 Real* belief, Real* weighted) const {
  using L = Lanes<Real>;
  const PairLanes<L> lanes(belief_, error_);
  const auto origin = static_cast<std::size_t>(true_positions.first);
  const double x0 = true_.x_m[origin], y0 = true_.y_m[origin], along0 = true_.along_m[origin];
  From(samples_.x_m, stretch.samples, x0, &columns->x);
  From(samples_.y_m, stretch.samples, y0, &columns->y);
  if (error_ == ErrorKind::kAlong) From(samples_.along_m, stretch.samples, along0, &columns->along);
  const bool headings = belief_.LooksAtHeadings();
  if (headings) {
    From(samples_.cos_heading, stretch.samples, 0.0, &columns->cos_heading);
    From(samples_.sin_heading, stretch.samples, 0.0, &columns->sin_heading);
  }
  const int whole = static_cast<int>(columns->x.size());
  if (error_ == ErrorKind::kTable) columns->along.resize(columns->x.size());
  const Real *x = columns->x.data(), *y = columns->y.data(), *along = columns->along.data();
  for (int a = true_positions.first; a < true_positions.end; ++a, belief += stride, weighted += stride) {
    const auto at = static_cast<std::size_t>(a);
    const auto xa = L::Broadcast(static_cast<Real>(true_.x_m[at] - x0));
    const auto ya = L::Broadcast(static_cast<Real>(true_.y_m[at] - y0));
    const auto here = L::Broadcast(static_cast<Real>(true_.along_m[at] - along0));
    if (error_ == ErrorKind::kTable) LookUp(true_.row[at], stretch.samples, &columns->along);
    for (int k = 0; k < whole; k += L::kCount) {
      const auto distance = lanes.Distance(L::Sub(L::Load(x + k), xa), L::Sub(L::Load(y + k), ya));
      const auto error = error_ == ErrorKind::kAlong   ? L::Abs(L::Sub(L::Load(along + k), here))
                         : error_ == ErrorKind::kTable ? L::Load(along + k)
                                                       : lanes.Error(distance);
      if (stretch.all) {
        L::Store(weighted + k, error);
        continue;
      }
      const auto believed = lanes.Believed(distance);
      L::Store(belief + k, believed);
      L::Store(weighted + k, L::Mul(believed, error));
    }
    if (headings) KeepThoseThatFaceAs(at, *columns, belief, weighted);
  }
}

template void Pairs::Fill(const IndexRange&, const Stretch&, int, Columns<float>*, float*, float*) const;
template void Pairs::Fill(const IndexRange&, const Stretch&, int, Columns<double>*, double*, double*) const;

}  // namespace cairn::landmark_learning
