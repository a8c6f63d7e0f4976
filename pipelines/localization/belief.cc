#include "pipelines/localization/belief.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "schema/error.h"
#include "schema/headings.h"

namespace cairn::localization {
namespace {

constexpr double kReach = 4.0;       // standard deviations, beyond which a Gaussian counts as nothing
constexpr double kForgotten = 1e-6;  // share of the largest belief, below which none is moved on

// False, and nothing done, where there is nothing to normalise.
bool Normalise(std::vector<double>* belief) {
  double sum = 0.0;
  for (const double b : *belief) sum += b;
  if (!(sum > 0.0)) return false;
  for (double& b : *belief) b /= sum;
  return true;
}

double Gaussian(double distance_m, double sd_m) {
  const double z = distance_m / sd_m;
  return std::exp(-0.5 * z * z);
}

}  // namespace

double Motion::SdM(double displacement_m) const {
  return std::max(least_sd_m, std::hypot(sd_m, sd_ratio * displacement_m));
}

bool Poses::FaceAlike(std::size_t a, std::size_t b) const {
  return heading_rad.empty() || cairn::FaceAlike(heading_rad[a], heading_rad[b]);
}

BeliefSpace::BeliefSpace(Poses poses, std::vector<double> room)
    : poses_(std::move(poses)), index_(poses_.positions), room_(std::move(room)), anywhere_(room_) {
  CAIRN_DEMAND(room_.size() == positions().size() && Normalise(&anywhere_), "each position has some room");
  CAIRN_DEMAND(poses_.heading_rad.empty() || poses_.heading_rad.size() == room_.size(), "each has a heading");
}

std::vector<double> BeliefSpace::Near(const Position& centre, double window_m) const {
  std::vector<double> belief(positions().size(), 0.0);
  // [Thr98] section 5.1.7: uniform around where the robot is
  for (const std::size_t position : index_.Within(centre, window_m)) belief[position] = anywhere_[position];
  if (Normalise(&belief)) return belief;
  throw InputError(fmt::format("window_m = {:g} m reaches no position of the map from ({:g}, {:g}) m",
                               window_m, centre.x_m, centre.y_m));
}

template <class Aim, class Weight>
bool BeliefSpace::Spread(double sd_m, double lost, const Aim& aim, const Weight& weight,
                         std::vector<double>* belief) const {
  const double least = kForgotten * *std::ranges::max_element(*belief);
  std::vector<double> moved(belief->size(), 0.0);
  for (std::size_t from = 0; from < moved.size(); ++from) {
    if ((*belief)[from] <= least) continue;
    index_.VisitWithin(aim(from), kReach * sd_m, [&](std::size_t position, double distance_m) {
      // [Thr98] eqs 2, 16, 19
      moved[position] += (*belief)[from] * weight(from, position) * Gaussian(distance_m, sd_m);
    });
  }
  for (std::size_t position = 0; position < moved.size(); ++position) moved[position] *= room_[position];
  *belief = std::move(moved);
  const bool remains = Normalise(belief);
  for (std::size_t position = 0; position < belief->size(); ++position)
    (*belief)[position] = (1.0 - lost) * (*belief)[position] + lost * anywhere_[position];
  return remains || Normalise(belief);
}

bool BeliefSpace::Move(const Position& displacement, const Motion& motion, double lost,
                       std::vector<double>* belief) const {
  return Spread(
      motion.SdM(std::hypot(displacement.x_m, displacement.y_m)), lost,
      [&](std::size_t from) {
        return Position{positions()[from].x_m + displacement.x_m, positions()[from].y_m + displacement.y_m};
      },
      [](std::size_t, std::size_t) { return 1.0; }, belief);
}

bool BeliefSpace::Drive(const OwnMotion& own, const Motion& motion, double lost,
                        std::vector<double>* belief) const {
  const std::vector<double>& heading = poses_.heading_rad;
  CAIRN_DEMAND(!heading.empty(), "who drives by its heading has one at each position");
  return Spread(
      motion.SdM(std::hypot(own.moved.x_m, own.moved.y_m)), lost,
      [&](std::size_t from) {
        const double c = std::cos(heading[from]), s = std::sin(heading[from]);
        return Position{positions()[from].x_m + c * own.moved.x_m - s * own.moved.y_m,
                        positions()[from].y_m + s * own.moved.x_m + c * own.moved.y_m};
      },
      [&](std::size_t from, std::size_t to) {
        return Gaussian(TurnBetween(heading[to], heading[from] + own.turn_rad), motion.heading_sd_rad);
      },
      belief);
}

bool BeliefSpace::KeepFacing(double heading_rad, std::vector<double>* belief) const {
  std::vector<double> kept = *belief;
  for (std::size_t position = 0; position < kept.size(); ++position) {
    if (!FaceAlike(poses_.heading_rad[position], heading_rad)) kept[position] = 0.0;
  }
  if (!Normalise(&kept)) return false;
  *belief = std::move(kept);
  return true;
}

bool Sense(const std::vector<double>& likelihood, std::vector<double>* belief) {
  std::vector<double> sensed(belief->size());
  for (std::size_t position = 0; position < sensed.size(); ++position)
    // [Thr98] eqs 11, 17
    sensed[position] = likelihood[position] * (*belief)[position];
  // [Thr98] eqs 12, 18
  if (!Normalise(&sensed)) return false;
  *belief = std::move(sensed);
  return true;
}

double RoomOf(const PositionIndex& index, const Poses& poses, std::size_t at, double bandwidth_m) {
  double density = 0.0;
  for (const std::size_t position : index.Within(poses.positions[at], kReach * bandwidth_m)) {
    if (poses.FaceAlike(position, at))
      density += Gaussian(DistanceM(poses.positions[position], poses.positions[at]), bandwidth_m);
  }
  return 1.0 / density;
}

double SpacingM(const PositionIndex& index, const Poses& poses) {
  double sum_m = 0.0, count = 0.0;
  for (std::size_t k = 0; k < poses.positions.size(); ++k) {
    const auto two =
        index.NearestOf(poses.positions[k], 2, [&](std::size_t p) { return poses.FaceAlike(p, k); });
    if (two.size() < 2) continue;
    sum_m += DistanceM(poses.positions[two[1]], poses.positions[k]);
    count += 1.0;
  }
  return count > 0.0 ? sum_m / count : 0.0;
}

Estimate EstimateOf(const std::vector<Position>& positions, const std::vector<double>& belief) {
  Estimate estimate;
  for (std::size_t k = 0; k < positions.size(); ++k) {
    estimate.mean.x_m += belief[k] * positions[k].x_m;
    estimate.mean.y_m += belief[k] * positions[k].y_m;
  }
  double squares = 0.0;
  for (std::size_t k = 0; k < positions.size(); ++k) {
    const double distance_m = DistanceM(positions[k], estimate.mean);
    squares += belief[k] * distance_m * distance_m;
  }
  estimate.spread_m = std::sqrt(squares);
  estimate.mode = positions[static_cast<std::size_t>(std::ranges::max_element(belief) - belief.begin())];
  return estimate;
}

}  // namespace cairn::localization
