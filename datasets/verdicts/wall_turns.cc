#include "datasets/verdicts/wall_turns.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "schema/square.h"

namespace cairn::datasets {
namespace {

constexpr double kNode_m = 0.5;
constexpr std::size_t kWindow = 4;  // nodes

// Where walls were seen, half a metre apart.
struct TurnNode {
  Pose pose;
  double travelled_m = 0;
  double walls_rad = 0;    // their direction by odometry, continuous: what the path turns against it
  double heading_rad = 0;  // of the path, continuous
};

// Whether odometry is known to have missed a turn then, or shortly before or after.
bool IsMissed(const kinds::LocalMap::Fit& fit, double time_s) {
  constexpr double kMissed_rad = std::numbers::pi / 6, kAround_s = 2;
  for (std::size_t i = 0; i < fit.from_s.OrNone().size(); ++i)
    if (std::abs(fit.scans_turn_rad[i] - fit.odometry_turn_rad[i]) > kMissed_rad &&
        time_s > fit.from_s[i] - kAround_s && time_s < fit.until_s[i] + kAround_s)
      return true;
  return false;
}

// Turns that odometry is known to have missed are taken out.
std::vector<TurnNode> NodesAlong(const kinds::LocalMap::Robot& robot) {
  const auto angle = robot.walls.angle_rad.OrNone();
  const auto x = robot.poses.x_m.OrNone(), y = robot.poses.y_m.OrNone(),
             heading = robot.poses.heading_rad.OrNone();
  std::vector<TurnNode> nodes;
  if (x.size() != angle.size()) return nodes;
  TurnNode now;
  bool any = false;
  double missed_rad = 0, missed_heading_rad = 0;
  for (std::size_t i = 0; i < angle.size(); ++i) {
    if (!std::isfinite(angle[i])) continue;
    const Pose pose{x[i], y[i], heading[i]};
    if (any && IsMissed(robot.fit, robot.walls.time_s[i])) {
      missed_rad += std::remainder(angle[i] - missed_rad - now.walls_rad, std::numbers::pi / 2);
      missed_heading_rad += WrapAngle(heading[i] - missed_heading_rad - now.heading_rad);
    } else if (any) {
      now.travelled_m += std::hypot(x[i] - now.pose.x_m, y[i] - now.pose.y_m);
      now.walls_rad += std::remainder(angle[i] - missed_rad - now.walls_rad, std::numbers::pi / 2);
      now.heading_rad += WrapAngle(heading[i] - missed_heading_rad - now.heading_rad);
    } else {
      now.walls_rad = angle[i];
      now.heading_rad = heading[i];
    }
    now.pose = pose;
    if (!any || now.travelled_m - nodes.back().travelled_m >= kNode_m) nodes.push_back(now);
    any = true;
  }
  return nodes;
}

struct Rates {
  double per_m = 0, scale = 0;
};

// Least squares of the walls' turns over the way and, `scaled`, over odometry's turns.
Rates Fit(const std::vector<TurnNode>& nodes, bool scaled) {
  double ww = 1e-3, wt = 0, tt = 1e-3, wa = 0, ta = 0;
  for (std::size_t n = 1; n < nodes.size(); ++n) {
    const double way = nodes[n].travelled_m - nodes[n - 1].travelled_m,
                 by = nodes[n].walls_rad - nodes[n - 1].walls_rad,
                 turn = nodes[n].heading_rad - nodes[n - 1].heading_rad + by,
                 weight = 1 / (way + turn * turn);
    ww += weight * way * way;
    wt += weight * way * turn;
    tt += weight * turn * turn;
    wa += weight * way * by;
    ta += weight * turn * by;
  }
  if (!scaled) return {.per_m = wa / ww};
  const double determinant = ww * tt - wt * wt;
  return {(wa * tt - ta * wt) / determinant, (ta * ww - wa * wt) / determinant};
}

// Whether turns of the path tell a scale: they outweigh what such rates leave. Of a robot that hardly turns
// odometry's drift alone is left, which looks like turns that are all too large.
bool TurnsTell(const std::vector<TurnNode>& nodes, const Rates& rates) {
  constexpr double kOutweigh = 10;
  double turned = 0, left = 0;
  for (std::size_t n = 1; n < nodes.size(); ++n) {
    const double way = nodes[n].travelled_m - nodes[n - 1].travelled_m,
                 by = nodes[n].walls_rad - nodes[n - 1].walls_rad,
                 of_path = nodes[n].heading_rad - nodes[n - 1].heading_rad, turn = of_path + by,
                 weight = 1 / (way + turn * turn);
    turned += weight * of_path * of_path;
    left += weight * Square(by - rates.per_m * way - rates.scale * turn);
  }
  return turned > kOutweigh * left;
}

// What is left over each window.
std::vector<double> Left(const std::vector<TurnNode>& nodes, const Rates& rates) {
  std::vector<double> left;
  for (std::size_t n = 0; n + kWindow < nodes.size(); ++n) {
    const TurnNode &from = nodes[n], &to = nodes[n + kWindow];
    const double by = to.walls_rad - from.walls_rad;
    left.push_back(by - rates.per_m * (to.travelled_m - from.travelled_m) -
                   rates.scale * (to.heading_rad - from.heading_rad + by));
  }
  return left;
}

// 1.48 medians of the magnitudes: the standard deviation of a Gaussian.
double RobustSd(std::vector<double> values) {
  if (values.empty()) return 0;
  for (double& value : values) value = std::abs(value);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return 1.4826 * *middle;
}

// Less what most are off by: where places stand out to one side, they have drawn the drift to it.
void TakeMedianOff(std::vector<double>* left) {
  std::vector<double> sorted = *left;
  std::ranges::sort(sorted);
  for (double& turn : *left) turn -= sorted[sorted.size() / 2];  // a mean would have the places in it
}

// Stretches of windows that stand out from the rest, to one side each.
void CountPlaces(std::vector<double> left, WallTurns* turns) {
  constexpr double kLeast_rad = 5 * std::numbers::pi / 180, kSds = 4;
  if (left.empty()) return;
  TakeMedianOff(&left);
  const double least_rad = std::max(kLeast_rad, kSds * RobustSd(left));
  std::vector<double> most_rad;  // of each place
  double before = 0;
  for (const double turn : left) {
    const double now = std::abs(turn) > least_rad ? turn : 0;
    if (now != 0 && now * before <= 0) most_rad.push_back(0);
    if (now != 0) most_rad.back() = std::max(most_rad.back(), std::abs(now));
    before = now;
  }
  turns->places = most_rad.size();
  if (most_rad.empty()) return;
  std::ranges::sort(most_rad);
  turns->place_rad = most_rad[most_rad.size() / 2];
}

// Of all pairs of passes of about one place, that go the same way or come back.
void Compare(const std::vector<TurnNode>& nodes, const std::vector<double>& left, WallTurns* turns) {
  constexpr double kPlace_m = 0.8, kApart_m = 8, kParallel = 0.8;
  std::map<std::pair<int, int>, std::vector<std::size_t>> cells;
  const auto cell_of = [](double m) { return static_cast<int>(std::floor(m / kPlace_m)); };
  const auto middle = [&](std::size_t n) -> const TurnNode& { return nodes[n + kWindow / 2]; };
  double products = 0, squares = 0;
  for (std::size_t n = 0; n < left.size(); ++n) {
    const TurnNode& now = middle(n);
    const int column = cell_of(now.pose.x_m), row = cell_of(now.pose.y_m);
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto found = cells.find({column + dx, row + dy});
        if (found == cells.end()) continue;
        for (const std::size_t m : found->second) {
          const TurnNode& before = middle(m);
          const double along = std::cos(now.pose.heading_rad - before.pose.heading_rad);
          if (std::abs(along) < kParallel || now.travelled_m - before.travelled_m < kApart_m ||
              std::hypot(now.pose.x_m - before.pose.x_m, now.pose.y_m - before.pose.y_m) > kPlace_m)
            continue;
          ++turns->pairs;
          products += std::copysign(1.0, along) * left[n] * left[m];
          squares += (left[n] * left[n] + left[m] * left[m]) / 2;
        }
      }
    }
    cells[{column, row}].push_back(n);
  }
  if (!(products > 0)) return;
  turns->alike = products / squares;
  turns->alike_rad = std::sqrt(products / static_cast<double>(turns->pairs));
}

}  // namespace

WallTurns FindWallTurns(const kinds::LocalMap::Robot& robot) {
  WallTurns turns;
  const std::vector<TurnNode> nodes = NodesAlong(robot);
  if (nodes.size() <= kWindow) return turns;
  turns.path_m = nodes.back().travelled_m;
  const Rates drift = Fit(nodes, false), scaled = Fit(nodes, true),
              rates = TurnsTell(nodes, scaled) ? scaled : drift;
  turns.turn_scale = rates.scale;
  std::vector<double> left = Left(nodes, rates);
  TakeMedianOff(&left);
  double squares = 0;
  for (const double turn : left) squares += turn * turn;
  turns.rms_rad = std::sqrt(squares / static_cast<double>(left.size()));
  turns.sd_rad = RobustSd(left);
  turns.drift_rad = drift.per_m * turns.path_m;
  const std::vector<double> unscaled = Left(nodes, drift);
  CountPlaces(unscaled, &turns);
  Compare(nodes, unscaled, &turns);
  double others = 0;
  for (const std::uint8_t other : robot.walls.other_area.OrNone()) others += other;
  turns.other_share = others / static_cast<double>(robot.walls.other_area.OrNone().size());
  return turns;
}

}  // namespace cairn::datasets
