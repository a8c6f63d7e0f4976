#include "datasets/detect/posts.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "schema/error.h"
#include "schema/square.h"

namespace cairn::datasets {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

// Beams from `first`, so many, round the end of a full turn.
struct Run {
  std::size_t first = 0, beams = 0;
};

// Of consecutive beams of which each two are `together`, where some are.
template <class Together>
std::vector<Run> RunsOf(const BeamFan& fan, const std::vector<bool>& has, const Together& together) {
  const std::size_t n = fan.size();
  const auto goes_on = [&](std::size_t i) {
    const std::size_t next = (i + 1) % n;
    return has[i] && has[next] && fan.HasNext(i) && together(i, next);
  };
  std::size_t start = 0;  // where a run ends, so that none is cut in two
  while (start < n && goes_on((start + n - 1) % n)) ++start;
  std::vector<Run> runs;
  if (start == n) return runs;  // all round
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = (start + k) % n;
    if (!has[i]) continue;
    if (k > 0 && !runs.empty() && goes_on((i + n - 1) % n))
      ++runs.back().beams;
    else
      runs.push_back({i, 1});
  }
  return runs;
}

// A run with what is seen on both sides of it.
struct Sides {
  double range_m[2];  // NaN: nothing within reach
};
std::optional<Sides> SidesOf(const BeamFan& fan, std::span<const double> range_m, const Run& run) {
  const std::size_t n = fan.size(), before = (run.first + n - 1) % n, last = (run.first + run.beams - 1) % n;
  if (run.beams + 2 > n || !fan.HasNext(before) || !fan.HasNext(last)) return std::nullopt;
  return Sides{{range_m[before], range_m[(last + 1) % n]}};
}

// By its beams, give or take one.
bool MayBeAsWide(const BeamFan& fan, const Run& run, double range_m, const PostLimits& limits) {
  const auto beams = static_cast<double>(run.beams);
  return (beams - 1) * fan.step_rad() * range_m <= limits.most_m &&
         (beams + 1) * fan.step_rad() * range_m >= limits.least_m;
}

// The circle with its middle at distance d, at `bearing`, of radius R, that was met by ranges at `angle`:
// least squares over the ranges, the edges, and what is known of posts' radii.
class CircleFit {
 public:
  CircleFit(std::vector<double> angle, std::vector<double> range_m, double step_rad, const PostLimits& limits)
      : angle_(std::move(angle)), range_m_(std::move(range_m)), sigma_m_(limits.sigma_m) {
    edge_rad_[0] = angle_.front() - step_rad / 2;
    edge_rad_[1] = angle_.back() + step_rad / 2;
    edge_sigma_rad_ = step_rad / std::sqrt(12.0);  // anywhere between two beams
    radius_m_ = (limits.least_m + limits.most_m) / 4;
    radius_sigma_m_ = (limits.most_m - limits.least_m) / (2 * std::sqrt(12.0));
  }

  std::optional<Post> Fit() {
    const double half_rad = (edge_rad_[1] - edge_rad_[0]) / 2;
    const double nearest_m = *std::ranges::min_element(range_m_);
    at_[2] = nearest_m * std::sin(std::min(half_rad, 1.0));
    at_[0] = nearest_m + at_[2];
    at_[1] = (edge_rad_[0] + edge_rad_[1]) / 2;
    constexpr double kGrazes = 0.15, kLeast_m = 1e-3;
    grazes_m2_ = Square(kGrazes * std::max(at_[2], kLeast_m));
    constexpr int kMostSteps = 40, kWholeSteps = 6;  // then half ones, for those that go to and fro
    constexpr double kStill = 1e-5;
    for (int step = 0; step < kMostSteps; ++step) {
      Linearize();
      const Eigen::Vector3d change = normal_.inverse() * gradient_;
      at_ += (step < kWholeSteps ? 1 : 0.5) * change;
      at_[2] = std::clamp(at_[2], 1e-3, 0.95 * at_[0]);
      if (!at_.allFinite() || at_[0] <= 0) return std::nullopt;
      if (change.cwiseAbs().maxCoeff() < kStill) return Found();
    }
    return std::nullopt;
  }

 private:
  void Add(const Eigen::Vector3d& slope, double difference, double sigma) {
    normal_ += slope * slope.transpose() / Square(sigma);
    gradient_ += slope * (difference / Square(sigma));
  }
  void Linearize() {
    const double d = at_[0], radius = at_[2];
    normal_.setZero();
    gradient_.setZero();
    squares_m2_ = 0;
    for (std::size_t i = 0; i < angle_.size(); ++i) {
      const double s = std::sin(angle_[i] - at_[1]), c = std::cos(angle_[i] - at_[1]);
      // Half of the chord, squared: of beams that graze it, or would pass it, bent so that its root has a
      // slope.
      const double chord = Square(radius) - Square(d * s), root = std::hypot(chord, 2 * grazes_m2_);
      const double depth = std::sqrt((chord + root) / 2), slope = (1 + chord / root) / 2 / depth;
      const double difference = range_m_[i] - (d * c - depth);
      Add({c + slope * d * s * s, d * s - slope * d * d * s * c, -slope * radius}, difference, sigma_m_);
      squares_m2_ += Square(difference);
    }
    const double half = std::asin(radius / d), slope = 1 / std::sqrt(Square(d) - Square(radius));
    for (const double side : {-1.0, 1.0})
      Add({-side * slope * radius / d, 1, side * slope}, edge_rad_[side > 0 ? 1 : 0] - (at_[1] + side * half),
          edge_sigma_rad_);
    Add({0, 0, 1}, radius_m_ - radius, radius_sigma_m_);
  }
  Post Found() const {
    const Eigen::Matrix3d covariance = normal_.inverse();
    return {at_[0],        at_[1],     at_[2], std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)),
            angle_.size(), squares_m2_};
  }

  std::vector<double> angle_, range_m_;
  double edge_rad_[2], edge_sigma_rad_, radius_m_, radius_sigma_m_, sigma_m_;
  Eigen::Vector3d at_;  // d, bearing, R
  Eigen::Matrix3d normal_;
  Eigen::Vector3d gradient_;
  double squares_m2_ = 0, grazes_m2_ = 0;
};

std::optional<Post> FitRun(const BeamFan& fan, std::span<const double> range_m, const Run& run,
                           const PostLimits& limits) {
  std::vector<double> angles, ranges;
  for (std::size_t k = 0; k < run.beams; ++k) {
    const std::size_t i = run.first + k;
    angles.push_back(fan.angle_rad(i % fan.size()) + (i >= fan.size() ? kTurn : 0));
    ranges.push_back(range_m[i % fan.size()]);
  }
  std::optional<Post> post = CircleFit(angles, ranges, fan.step_rad(), limits).Fit();
  if (!post) return std::nullopt;
  constexpr double kMostSigmas = 3;
  const bool is_round =
      post->squares_m2 <= static_cast<double>(run.beams) * Square(kMostSigmas * limits.sigma_m);
  // Its own error is no larger than what the limits leave.
  const double slack = fan.step_rad() * post->range_m;
  if (!is_round || 2 * post->radius_m > limits.most_m + slack || 2 * post->radius_m < limits.least_m - slack)
    return std::nullopt;
  return post;
}

std::vector<bool> Answered(std::span<const double> range_m) {
  std::vector<bool> answered;
  for (const double range : range_m) answered.push_back(range > 0);
  return answered;
}

bool StandsAlone(const Sides& sides, double first_m, double last_m, const PostLimits& limits) {
  const double clearance_m = limits.most_m / 2;
  const auto is_far = [&](double side_m, double range_m) {
    return std::isnan(side_m) ? range_m + clearance_m < limits.reach_m : side_m > range_m + clearance_m;
  };
  return is_far(sides.range_m[0], first_m) && is_far(sides.range_m[1], last_m);
}

}  // namespace

double MedianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

BeamFan::BeamFan(std::span<const double> x_m, std::span<const double> y_m,
                 std::span<const double> heading_rad) {
  constexpr double kSame_m = 1e-3;
  const std::size_t n = heading_rad.size();
  if (n < 3) throw InputError("fewer than three beams");
  at_ = {x_m[0], y_m[0]};
  for (std::size_t i = 0; i < n; ++i)
    if (DistanceM({x_m[i], y_m[i]}, at_) > kSame_m) throw InputError("beams that begin at several places");
  reversed_ = WrapAngle(heading_rad[1] - heading_rad[0]) < 0;
  const auto heading = [&](std::size_t i) { return heading_rad[reversed_ ? n - 1 - i : i]; };
  std::vector<double> steps;
  angle_rad_ = {heading(0)};
  for (std::size_t i = 1; i < n; ++i) {
    steps.push_back(WrapAngle(heading(i) - heading(i - 1)));
    if (steps.back() <= 0) throw InputError("beams that do not point one beside the other");
    angle_rad_.push_back(angle_rad_.back() + steps.back());
  }
  step_rad_ = MedianOf(steps);
  constexpr double kMostStep = 1.5;  // a wider one has a beam left out, and is not looked into
  for (const double step : steps) has_next_.push_back(step < kMostStep * step_rad_);
  const double rest = angle_rad_.front() + kTurn - angle_rad_.back();
  if (rest < -step_rad_ / 2) throw InputError("beams of more than a turn");
  has_next_.push_back(rest < kMostStep * step_rad_);
}

std::vector<double> BeamFan::Ordered(std::span<const double> stored) const {
  if (reversed_) return {stored.rbegin(), stored.rend()};
  return {stored.begin(), stored.end()};
}

std::vector<Post> FindPosts(const BeamFan& fan, std::span<const double> range_m, const PostLimits& limits) {
  std::vector<Post> posts;
  const auto together = [&](std::size_t i, std::size_t next) {
    return std::abs(range_m[i] - range_m[next]) < limits.most_m / 2;
  };
  for (const Run& run : RunsOf(fan, Answered(range_m), together)) {
    const double first_m = range_m[run.first], last_m = range_m[(run.first + run.beams - 1) % fan.size()];
    if (!MayBeAsWide(fan, run, first_m, limits)) continue;
    const std::optional<Sides> sides = SidesOf(fan, range_m, run);
    if (!sides || !StandsAlone(*sides, first_m, last_m, limits)) continue;
    if (const auto post = FitRun(fan, range_m, run, limits)) posts.push_back(*post);
  }
  return posts;
}

std::vector<Post> FindReflectors(const BeamFan& fan, std::span<const double> range_m,
                                 std::span<const double> intensity, const Brightness& brightness,
                                 const PostLimits& limits) {
  std::vector<bool> bright;
  for (std::size_t i = 0; i < fan.size(); ++i)
    bright.push_back(range_m[i] > 0 && intensity[i] >= brightness.LeastOfReflectors(range_m[i]));
  const double same_m = limits.most_m / 2;
  const auto together = [&](std::size_t i, std::size_t next) {
    return std::abs(range_m[i] - range_m[next]) < same_m;
  };
  std::vector<Post> reflectors;
  for (const Run& run : RunsOf(fan, bright, together)) {
    std::vector<double> ranges;
    for (std::size_t k = 0; k < run.beams; ++k) ranges.push_back(range_m[(run.first + k) % fan.size()]);
    const double surface_m = MedianOf(ranges);
    const std::optional<Sides> sides = SidesOf(fan, range_m, run);
    if (!sides || !MayBeAsWide(fan, run, surface_m, limits)) continue;
    if (sides->range_m[0] < ranges.front() - same_m || sides->range_m[1] < ranges.back() - same_m) continue;
    if (StandsAlone(*sides, ranges.front(), ranges.back(), limits))
      if (const auto post = FitRun(fan, range_m, run, limits)) {
        reflectors.push_back(*post);
        continue;
      }
    const auto beams = static_cast<double>(run.beams);
    reflectors.push_back({.range_m = surface_m,
                          .bearing_rad = fan.angle_rad(run.first) + (beams - 1) / 2 * fan.step_rad(),
                          .range_sigma_m = limits.sigma_m / std::sqrt(beams),
                          .bearing_sigma_rad = fan.step_rad() / std::sqrt(24.0),  // of two edges
                          .beams = run.beams});
  }
  return reflectors;
}

std::size_t Brightness::BinOf(double range_m) {
  return static_cast<std::size_t>(std::min(range_m, 1e4) / kBin_m);
}

void Brightness::Add(double range_m, float intensity) {
  if (!(range_m > 0) || !std::isfinite(intensity)) return;
  const std::size_t bin = BinOf(range_m);
  if (bin >= seen_.size()) seen_.resize(bin + 1);
  seen_[bin].push_back(intensity);
}

void Brightness::Finish() {
  double top = 0;
  for (const auto& bin : seen_)
    for (const float intensity : bin) top = std::max(top, static_cast<double>(intensity));
  constexpr std::size_t kLeastReadings = 50;
  constexpr double kOften = 0.8, kSpreads = 4, kTimes = 2, kOfTop = 0.05;
  double before = std::numeric_limits<double>::infinity();  // where little was seen: what is nearer
  for (auto& bin : seen_) {
    if (bin.size() >= kLeastReadings) {
      std::ranges::sort(bin);
      const double middle = bin[bin.size() / 2];
      const double often = bin[static_cast<std::size_t>(kOften * static_cast<double>(bin.size() - 1))];
      before = std::max({middle + kSpreads * (often - middle), kTimes * middle, kOfTop * top});
      if (!(before > 0))
        before = std::numeric_limits<double>::infinity();  // drivers that know none write zeros
    }
    least_.push_back(before);
    std::vector<float>().swap(bin);
  }
}

double Brightness::LeastOfReflectors(double range_m) const {
  if (least_.empty()) return std::numeric_limits<double>::infinity();
  return least_[std::min(BinOf(range_m), least_.size() - 1)];
}

}  // namespace cairn::datasets
