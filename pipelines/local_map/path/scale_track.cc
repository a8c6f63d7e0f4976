#include "pipelines/local_map/path/scale_track.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include "schema/square.h"

namespace cairn::local_map {
namespace {

// Scales that are looked at: their logarithms, from 0.27 to 3.7.
constexpr int kScaleReach = 130;
constexpr std::size_t kScales = 2 * kScaleReach + 1;
constexpr double kScaleStep = 0.01;
using Belief = std::array<double, kScales>;
double LogOf(std::size_t k) { return kScaleStep * (static_cast<double>(k) - kScaleReach); }

constexpr std::size_t kFewApproaches = 10;  // that must agree, and half of all
constexpr double kAgrees = 0.1;             // of a logarithm
constexpr double kLeastScaleSd = 0.02;
constexpr double kTellNothing = 0.3;  // of approaches: so many tell nothing, as something else came into view
constexpr std::array kWalks{0.0, 0.006, 0.012, 0.024};  // sd of the logarithm, a sqrt(m)
constexpr double kAnew = 1e-9;                          // at each approach: whatever was told before is wrong
constexpr double kWalks_nats = 10, kUsualOff = 0.05;

Belief LikelihoodOf(const Approach& approach) {
  Belief likelihood;
  likelihood.fill(kTellNothing / (kScales * kScaleStep));
  if (approach.Scale() <= 0) return likelihood;
  const double at = std::log(approach.Scale()), sd = std::hypot(approach.sd, kLeastScaleSd);
  const double density = (1 - kTellNothing) / (sd * std::sqrt(2 * std::numbers::pi));
  for (std::size_t k = 0; k < kScales; ++k)
    likelihood[k] += density * std::exp(-Square((LogOf(k) - at) / sd) / 2);
  return likelihood;
}

// After a walk with such a standard deviation.
Belief Spread(const Belief& belief, double sd) {
  const int reach = std::min(kScaleReach, static_cast<int>(std::ceil(4 * sd / kScaleStep)));
  std::array<double, kScales> share;  // of what moves so many steps to either side
  double all = 0;
  for (int by = 0; by <= reach; ++by) {
    share[static_cast<std::size_t>(by)] = by == 0 ? 1 : std::exp(-Square(by * kScaleStep / sd) / 2);
    all += (by == 0 ? 1 : 2) * share[static_cast<std::size_t>(by)];
  }
  Belief spread;
  spread.fill(kAnew / kScales);
  for (int k = 0; k < static_cast<int>(kScales); ++k)
    for (int from = std::max(0, k - reach); from <= std::min(2 * kScaleReach, k + reach); ++from)
      spread[static_cast<std::size_t>(k)] +=
          share[static_cast<std::size_t>(std::abs(k - from))] / all * belief[static_cast<std::size_t>(from)];
  return spread;
}

// Times the likelihood, normalized; what it was before that.
double Reweigh(const Belief& likelihood, Belief* belief) {
  double all = 0;
  for (std::size_t k = 0; k < kScales; ++k) all += (*belief)[k] *= likelihood[k];
  for (double& share : *belief) share /= all;
  return all;
}

struct ScalesSoFar {
  double nats = 0;
  std::vector<Belief> at;  // by the approaches up to each
};

class ScaleFilter {
 public:
  ScaleFilter(std::span<const Approach> approaches, const std::vector<MetreAt>& places) : places_(places) {
    for (const Approach& approach : approaches) likelihood_.push_back(LikelihoodOf(approach));
  }

  ScalesSoFar Filter(double walk) const {
    ScalesSoFar filtered;
    Belief belief;
    belief.fill(1.0 / kScales);
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (i > 0) belief = Spread(belief, Sd(walk, i));
      filtered.nats += std::log(Reweigh(likelihood_[i], &belief));
      filtered.at.push_back(belief);
    }
    return filtered;
  }
  // By all of them; the mean of the logarithm.
  std::vector<double> Smoothed(const ScalesSoFar& filtered, double walk) const {
    std::vector<double> means(places_.size());
    Belief later;
    later.fill(1);
    for (std::size_t i = places_.size(); i-- > 0;) {
      Belief belief = later;
      Reweigh(filtered.at[i], &belief);
      for (std::size_t k = 0; k < kScales; ++k) means[i] += LogOf(k) * belief[k];
      Reweigh(likelihood_[i], &later);
      if (i > 0) later = Spread(later, Sd(walk, i));
    }
    return means;
  }

 private:
  double Sd(double walk, std::size_t i) const {
    return walk * std::sqrt(places_[i].path_m - places_[i - 1].path_m);
  }

  const std::vector<MetreAt>& places_;
  std::vector<Belief> likelihood_;
};

}  // namespace

std::vector<MetreAt> TrackScale(std::vector<Approach> approaches, const std::vector<Scan>& scans) {
  if (approaches.size() < kFewApproaches) return {};
  std::ranges::stable_sort(approaches, {}, &Approach::scan);
  std::vector<MetreAt> places;
  for (const Approach& approach : approaches) {
    const Scan& scan = scans.at(static_cast<std::size_t>(approach.scan));
    places.push_back({.time_s = scan.time_s, .path_m = scan.path_m});
  }
  const ScaleFilter track(approaches, places);
  const ScalesSoFar steady = track.Filter(0);
  ScalesSoFar likeliest = steady;
  double walk = 0;
  for (const double other : kWalks) {
    ScalesSoFar filtered = track.Filter(other);
    if (filtered.nats - steady.nats < kWalks_nats || filtered.nats <= likeliest.nats) continue;
    likeliest = std::move(filtered);
    walk = other;
  }
  const std::vector<double> means = track.Smoothed(likeliest, walk);
  if (walk == 0 && std::abs(means.front()) < kUsualOff) return {};
  std::size_t agree = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    places[i].scale = std::exp(means[i]);
    agree += std::abs(approaches[i].Scale() / places[i].scale - 1) < kAgrees;
  }
  if (agree < std::max(kFewApproaches, places.size() / 2)) return {};
  return places;
}

namespace {

// Between its places by the way from one to the next.
double ScaleAt(const std::vector<MetreAt>& track, double path_m) {
  const auto next = std::ranges::upper_bound(track, path_m, {}, &MetreAt::path_m);
  const MetreAt &from = next == track.begin() ? *next : *(next - 1),
                &to = next == track.end() ? *(next - 1) : *next;
  const double share = to.path_m > from.path_m ? (path_m - from.path_m) / (to.path_m - from.path_m) : 0;
  return std::lerp(from.scale, to.scale, share);
}

}  // namespace

bool IsBorneOut(const std::vector<MetreAt>& track, const std::vector<WayFit>& ways,
                const std::vector<Scan>& scans) {
  constexpr double kFew = 10, kGain = 0.01, kSigmas = 3;
  double sum = 0, sum2 = 0;
  const auto count = static_cast<double>(ways.size());
  for (const WayFit& fit : ways) {
    const double scale = ScaleAt(track, scans.at(static_cast<std::size_t>(fit.scan)).path_m);
    const double gain = fit.share[NearestWayScale(scale)] - fit.share[NearestWayScale(1)];
    sum += gain;
    sum2 += gain * gain;
  }
  if (count < kFew) return false;
  const double mean = sum / count, sd = std::sqrt(std::max(0.0, sum2 / count - mean * mean) / count);
  return mean > std::max(kGain, kSigmas * sd);
}

void Rescale(const std::vector<MetreAt>& track, std::vector<Scan>* scans) {
  Scan before, at;
  for (std::size_t s = 0; s < scans->size(); ++s) {
    Scan& scan = (*scans)[s];
    const double scale = ScaleAt(track, scan.path_m);
    if (s == 0) before = at = scan;
    at.pose.x_m += scale * (scan.pose.x_m - before.pose.x_m);
    at.pose.y_m += scale * (scan.pose.y_m - before.pose.y_m);
    at.path_m += scale * (scan.path_m - before.path_m);
    before = scan;
    scan.pose.x_m = at.pose.x_m;
    scan.pose.y_m = at.pose.y_m;
    scan.path_m = at.path_m;
  }
}

}  // namespace cairn::local_map
