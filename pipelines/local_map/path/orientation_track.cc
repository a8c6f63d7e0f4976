#include "pipelines/local_map/path/orientation_track.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "schema/square.h"

namespace cairn::local_map {
namespace {

constexpr double kQuarter_rad = std::numbers::pi / 2;
constexpr double kNode_m = 0.3, kNode_rad = 0.2;  // how far apart places of the search are
constexpr int kStates = 180;
constexpr double kState_rad = kQuarter_rad / kStates;
constexpr double kNatsPerM = 1.5,
                 kMostEdges_m = 4;    // what edges say of an orientation, and the most they may
constexpr double kWidth_rad = 0.05;   // how exactly they say it
constexpr double kStill_rad = 0.005;  // sd of a step, whatever the way
constexpr double kJump_rad = 0.5;
constexpr double kLeastWalk = 0.004;  // rad a sqrt(m)
constexpr int kRepeats = 3;
constexpr double kFullSight_m = 3, kIndependent_m = 0.2;  // edges of a whole sight; sights closer are one

double ModuloQuarter(double angle_rad) { return std::remainder(angle_rad, kQuarter_rad); }
// A few scans at about one place.
struct SightNode {
  std::size_t first = 0, end = 0;  // sights
  std::array<double, kStates> nats{};
};

// Odometry's own errors, as they are known so far.
struct Drift {
  double per_m = 0, turn_scale = 0, walk = 0, turn_ratio = 0;
  double Of(const OrientationSight& from, const OrientationSight& to) const {
    return per_m * (to.path_m - from.path_m) + turn_scale * (to.heading_rad - from.heading_rad);
  }
  double Variance(const OrientationSight& from, const OrientationSight& to) const {
    return Square(walk) * (to.path_m - from.path_m) +
           Square(turn_ratio * (to.heading_rad - from.heading_rad)) + (to.begins ? Square(kJump_rad) : 0);
  }
};

void Weigh(const std::vector<OrientationSight>& sights, SightNode* node) {
  std::array<double, kBins> mean{};
  double all = 0;
  for (std::size_t s = node->first; s < node->end; ++s)
    for (std::size_t b = 0; b < kBins; ++b) mean[b] += sights[s].edges_m[b];
  for (double& metres : mean) all += metres /= static_cast<double>(node->end - node->first);
  const double share = all > kMostEdges_m ? kMostEdges_m / all : 1;
  for (int k = 0; k < kStates; ++k) {
    for (std::size_t b = 0; b < kBins; ++b) {
      if (mean[b] <= 0) continue;
      const double off = ModuloQuarter(k * kState_rad - static_cast<double>(b) * kBin_rad) / kWidth_rad;
      node->nats[static_cast<std::size_t>(k)] += kNatsPerM * share * mean[b] * std::exp(-off * off / 2);
    }
  }
}

std::vector<SightNode> SightNodesOf(const std::vector<OrientationSight>& sights) {
  std::vector<SightNode> nodes;
  for (std::size_t s = 0; s < sights.size(); ++s) {
    const bool apart = nodes.empty() || sights[s].begins ||
                       sights[s].path_m - sights[nodes.back().first].path_m >= kNode_m ||
                       std::abs(sights[s].heading_rad - sights[nodes.back().first].heading_rad) >= kNode_rad;
    if (apart) nodes.push_back({s, s, {}});
    nodes.back().end = s + 1;
  }
  for (SightNode& node : nodes) Weigh(sights, &node);
  return nodes;
}

// The most likely sequence of states; as angles that go on continuously.
std::vector<double> MostLikely(const std::vector<OrientationSight>& sights,
                               const std::vector<SightNode>& nodes, const Drift& drift) {
  std::vector<std::array<double, kStates>> best(nodes.size());
  std::vector<std::array<std::int16_t, kStates>> step(nodes.size());  // states by which it came here
  best[0] = nodes[0].nats;
  for (std::size_t n = 1; n < nodes.size(); ++n) {
    const OrientationSight &from = sights[nodes[n - 1].first], &to = sights[nodes[n].first];
    const double mean = drift.Of(from, to) / kState_rad;
    const double sd = std::sqrt(drift.Variance(from, to) + Square(kStill_rad)) / kState_rad;
    const int middle = static_cast<int>(std::lround(mean));
    const int reach = std::min(kStates / 2 - 1, static_cast<int>(std::ceil(4 * sd)));
    for (int k = 0; k < kStates; ++k) {
      double most = -std::numeric_limits<double>::infinity();
      for (int by = middle - reach; by <= middle + reach; ++by) {
        const int before = (((k - by) % kStates) + kStates) % kStates;
        const double nats = best[n - 1][static_cast<std::size_t>(before)] - Square((by - mean) / sd) / 2;
        if (nats <= most) continue;
        most = nats;
        step[n][static_cast<std::size_t>(k)] = static_cast<std::int16_t>(by);
      }
      best[n][static_cast<std::size_t>(k)] = most + nodes[n].nats[static_cast<std::size_t>(k)];
    }
  }
  auto state = static_cast<int>(std::ranges::max_element(best.back()) - best.back().begin());
  std::vector<double> angle(nodes.size());
  for (std::size_t n = nodes.size(); n-- > 0;) {
    angle[n] = state;
    const int by = step[n][static_cast<std::size_t>(state)];
    state = (((state - by) % kStates) + kStates) % kStates;
  }
  angle[0] = ModuloQuarter(angle[0] * kState_rad);
  for (std::size_t n = 1; n < nodes.size(); ++n) {
    const auto now = static_cast<std::size_t>(angle[n]);
    angle[n] = angle[n - 1] + step[n][now] * kState_rad;
  }
  return angle;
}

// Least squares of the steps over way and turn; and what is left, as a walk.
Drift Learn(const std::vector<OrientationSight>& sights, const std::vector<SightNode>& nodes,
            const std::vector<double>& angle, const OrientationOptions& options) {
  double ww = 1e-3, wt = 0, tt = 1e-3, wa = 0, ta = 0;  // as if a little of either had shown none
  for (std::size_t n = 1; n < nodes.size(); ++n) {
    const OrientationSight &from = sights[nodes[n - 1].first], &to = sights[nodes[n].first];
    if (to.begins) continue;
    const double travelled = to.path_m - from.path_m, turn = to.heading_rad - from.heading_rad;
    const double weight = 1 / (travelled + Square(turn) + 0.01), by = angle[n] - angle[n - 1];
    ww += weight * travelled * travelled;
    wt += weight * travelled * turn;
    tt += weight * turn * turn;
    wa += weight * travelled * by;
    ta += weight * turn * by;
  }
  Drift drift;
  const double determinant = ww * tt - wt * wt;
  drift.per_m = (wa * tt - ta * wt) / determinant;
  drift.turn_scale = (ta * ww - wa * wt) / determinant;
  double squares = 0, travelled = 0;
  for (std::size_t n = 1; n < nodes.size(); ++n) {
    const OrientationSight &from = sights[nodes[n - 1].first], &to = sights[nodes[n].first];
    if (to.begins) continue;
    squares += Square(angle[n] - angle[n - 1] - drift.Of(from, to));
    travelled += to.path_m - from.path_m;
  }
  drift.walk =
      std::clamp(travelled > 0 ? std::sqrt(squares / travelled) : 0, kLeastWalk, options.walk_rad_per_sqrt_m);
  drift.turn_ratio = options.turn_ratio / 2;
  return drift;
}

// The search's angle at each sight: odometry's known errors, and what they leave spread over the way.
std::vector<double> AtSights(const std::vector<OrientationSight>& sights, const std::vector<SightNode>& nodes,
                             const std::vector<double>& angle, const Drift& drift) {
  std::vector<double> at(sights.size());
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const OrientationSight& from = sights[nodes[n].first];
    const bool last = n + 1 == nodes.size() || sights[nodes[n + 1].first].begins;
    const double left = last ? 0 : angle[n + 1] - angle[n] - drift.Of(from, sights[nodes[n + 1].first]);
    const auto count = static_cast<double>(nodes[n].end - nodes[n].first);
    for (std::size_t s = nodes[n].first; s < nodes[n].end; ++s)
      at[s] = angle[n] + drift.Of(from, sights[s]) + left * static_cast<double>(s - nodes[n].first) / count;
  }
  return at;
}

struct Centre {
  double off_rad = 0, length_m = 0, all_m = 0;
};

// Of the edges within `other_rad` of an angle.
Centre CentreOf(const EdgeHistogram& edges, double angle_rad, double other_rad) {
  Centre centre;
  for (std::size_t b = 0; b < kBins; ++b) {
    if (edges[b] <= 0) continue;
    centre.all_m += edges[b];
    const double off = ModuloQuarter(static_cast<double>(b) * kBin_rad - angle_rad);
    if (std::abs(off) > other_rad) continue;
    centre.length_m += edges[b];
    centre.off_rad += edges[b] * off;
  }
  if (centre.length_m > 0) centre.off_rad /= centre.length_m;
  return centre;
}

struct Filtered {
  double off = 0, variance = 0;      // after the sight
  double predicted = 0, before = 0;  // and its variance before
};

}  // namespace

void AddEdge(double angle_rad, double length_m, EdgeHistogram* histogram) {
  double at = ModuloQuarter(angle_rad) / kBin_rad;
  if (at < 0) at += kBins;
  const double low = std::floor(at), part = at - low;
  const std::size_t bin = static_cast<std::size_t>(low) % kBins;
  (*histogram)[bin] += static_cast<float>((1 - part) * length_m);
  (*histogram)[(bin + 1) % kBins] += static_cast<float>(part * length_m);
}

EdgeHistogram Turned(const EdgeHistogram& histogram, double angle_rad) {
  EdgeHistogram turned{};
  for (std::size_t b = 0; b < kBins; ++b)
    if (histogram[b] > 0) AddEdge(static_cast<double>(b) * kBin_rad + angle_rad, histogram[b], &turned);
  return turned;
}

OrientationTrack TrackOrientation(const std::vector<OrientationSight>& sights,
                                  const OrientationOptions& options) {
  OrientationTrack track;
  track.at.resize(sights.size());
  if (sights.empty()) return track;
  const std::vector<SightNode> nodes = SightNodesOf(sights);
  Drift drift{
      .per_m = 0, .turn_scale = 0, .walk = options.walk_rad_per_sqrt_m, .turn_ratio = options.turn_ratio};
  std::vector<double> angle;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    // [DM98] section 3.2: drifts of odometry show in the dominant wall orientation.
    angle = MostLikely(sights, nodes, drift);
    drift = Learn(sights, nodes, angle, options);
  }
  const std::vector<double> guess = AtSights(sights, nodes, angle, drift);
  std::vector<Filtered> filtered(sights.size());
  double off = 0, variance = Square(options.other_rad);
  for (std::size_t s = 0; s < sights.size(); ++s) {
    double independent = 1;
    if (s > 0) {
      variance += drift.Variance(sights[s - 1], sights[s]);
      const double travelled = sights[s].path_m - sights[s - 1].path_m +
                               std::abs(sights[s].heading_rad - sights[s - 1].heading_rad);
      independent = std::min(1.0, travelled / kIndependent_m);
    }
    Filtered& now = filtered[s];
    now.predicted = off;
    now.before = variance;
    const Centre centre = CentreOf(sights[s].edges_m, guess[s] + off, options.other_rad);
    const double weight = independent * std::min(1.0, centre.length_m / kFullSight_m);
    if (weight > 0) {
      const double gain = variance / (variance + Square(options.seen_rad) / weight);
      off += gain * centre.off_rad;
      variance *= 1 - gain;
    }
    track.seen |= centre.length_m > 0;
    track.at[s].strength = centre.all_m > 0 ? centre.length_m / centre.all_m : 0;
    track.at[s].other = centre.all_m > 0 && centre.length_m < centre.all_m / 2;
    now.off = off;
    now.variance = variance;
  }
  for (std::size_t s = sights.size(); s-- > 0;) {
    const Filtered& now = filtered[s];
    double smoothed = now.off, left = now.variance;
    if (s + 1 < sights.size()) {
      const Filtered& next = filtered[s + 1];
      const double gain = next.before > 0 ? now.variance / next.before : 1;
      smoothed += gain * (track.at[s + 1].angle_rad - guess[s + 1] - next.predicted);
      left += gain * gain * (Square(track.at[s + 1].sd_rad) - next.before);
    }
    track.at[s].angle_rad = guess[s] + smoothed;
    track.at[s].sd_rad = std::sqrt(std::max(left, 0.0));
  }
  track.drift_rad_per_m = drift.per_m;
  track.turn_scale = drift.turn_scale;
  track.walk_rad_per_sqrt_m = drift.walk;
  return track;
}

void Correct(const OrientationTrack& walls, double scale, std::vector<Scan>* scans) {
  Pose before, corrected;
  for (std::size_t s = 0; s < scans->size(); ++s) {
    const Pose now = (*scans)[s].pose;
    const double angle = walls.at[s].angle_rad;
    if (s > 0) {
      const double turn = -(walls.at[s - 1].angle_rad + angle) / 2;
      const double dx = scale * (now.x_m - before.x_m), dy = scale * (now.y_m - before.y_m);
      corrected.x_m += std::cos(turn) * dx - std::sin(turn) * dy;
      corrected.y_m += std::sin(turn) * dx + std::cos(turn) * dy;
    }
    corrected.heading_rad = now.heading_rad - angle;
    before = now;
    (*scans)[s].pose = corrected;
  }
}

}  // namespace cairn::local_map
