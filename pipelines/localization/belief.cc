#include "pipelines/localization/belief.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "schema/error.h"
#include "schema/headings.h"

namespace cairn::localization {
namespace {

constexpr double kReach = 4.0;       // standard deviations, beyond which a Gaussian counts as nothing
constexpr double kForgotten = 1e-6;  // share of the largest belief, below which a place is not moved on from

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
    : poses_(std::move(poses)), index_(poses_.places), room_(std::move(room)), anywhere_(room_) {
  CAIRN_DEMAND(room_.size() == places().size() && Normalise(&anywhere_), "each place has some room");
  CAIRN_DEMAND(poses_.heading_rad.empty() || poses_.heading_rad.size() == room_.size(), "each has a heading");
}

std::vector<double> BeliefSpace::Near(const Place& centre, double window_m) const {
  std::vector<double> belief(places().size(), 0.0);
  for (const std::size_t place : index_.Within(centre, window_m)) belief[place] = anywhere_[place];
  if (Normalise(&belief)) return belief;
  char text[160];
  std::snprintf(text, sizeof text, "window_m = %g m reaches no place of the map from (%g, %g) m", window_m,
                centre.x_m, centre.y_m);
  throw InputError(text);
}

template <class Aim, class Weight>
bool BeliefSpace::Spread(double sd_m, double lost, const Aim& aim, const Weight& weight,
                         std::vector<double>* belief) const {
  const double least = kForgotten * *std::ranges::max_element(*belief);
  std::vector<double> moved(belief->size(), 0.0);
  for (std::size_t from = 0; from < moved.size(); ++from) {
    if ((*belief)[from] <= least) continue;
    index_.VisitWithin(aim(from), kReach * sd_m, [&](std::size_t place, double distance_m) {
      moved[place] += (*belief)[from] * weight(from, place) * Gaussian(distance_m, sd_m);
    });
  }
  for (std::size_t place = 0; place < moved.size(); ++place) moved[place] *= room_[place];
  *belief = std::move(moved);
  const bool remains = Normalise(belief);
  for (std::size_t place = 0; place < belief->size(); ++place)
    (*belief)[place] = (1.0 - lost) * (*belief)[place] + lost * anywhere_[place];
  return remains || Normalise(belief);
}

bool BeliefSpace::Move(const Place& displacement, const Motion& motion, double lost,
                       std::vector<double>* belief) const {
  return Spread(
      motion.SdM(std::hypot(displacement.x_m, displacement.y_m)), lost,
      [&](std::size_t from) {
        return Place{places()[from].x_m + displacement.x_m, places()[from].y_m + displacement.y_m};
      },
      [](std::size_t, std::size_t) { return 1.0; }, belief);
}

bool BeliefSpace::Drive(const OwnMotion& own, const Motion& motion, double lost,
                        std::vector<double>* belief) const {
  const std::vector<double>& heading = poses_.heading_rad;
  CAIRN_DEMAND(!heading.empty(), "who drives by its heading has one at each place");
  return Spread(
      motion.SdM(std::hypot(own.moved.x_m, own.moved.y_m)), lost,
      [&](std::size_t from) {
        const double c = std::cos(heading[from]), s = std::sin(heading[from]);
        return Place{places()[from].x_m + c * own.moved.x_m - s * own.moved.y_m,
                     places()[from].y_m + s * own.moved.x_m + c * own.moved.y_m};
      },
      [&](std::size_t from, std::size_t to) {
        return Gaussian(TurnBetween(heading[to], heading[from] + own.turn_rad), motion.heading_sd_rad);
      },
      belief);
}

bool BeliefSpace::KeepFacing(double heading_rad, std::vector<double>* belief) const {
  std::vector<double> kept = *belief;
  for (std::size_t place = 0; place < kept.size(); ++place) {
    if (!FaceAlike(poses_.heading_rad[place], heading_rad)) kept[place] = 0.0;
  }
  if (!Normalise(&kept)) return false;
  *belief = std::move(kept);
  return true;
}

bool Sense(const std::vector<double>& likelihood, std::vector<double>* belief) {
  std::vector<double> sensed(belief->size());
  for (std::size_t place = 0; place < sensed.size(); ++place)
    sensed[place] = likelihood[place] * (*belief)[place];
  if (!Normalise(&sensed)) return false;
  *belief = std::move(sensed);
  return true;
}

double RoomOf(const PlaceIndex& index, const Poses& poses, std::size_t at, double bandwidth_m) {
  double density = 0.0;
  for (const std::size_t place : index.Within(poses.places[at], kReach * bandwidth_m)) {
    if (poses.FaceAlike(place, at))
      density += Gaussian(DistanceM(poses.places[place], poses.places[at]), bandwidth_m);
  }
  return 1.0 / density;
}

double SpacingM(const PlaceIndex& index, const Poses& poses) {
  double sum_m = 0.0, count = 0.0;
  for (std::size_t k = 0; k < poses.places.size(); ++k) {
    const auto two =
        index.NearestOf(poses.places[k], 2, [&](std::size_t p) { return poses.FaceAlike(p, k); });
    if (two.size() < 2) continue;
    sum_m += DistanceM(poses.places[two[1]], poses.places[k]);
    count += 1.0;
  }
  return count > 0.0 ? sum_m / count : 0.0;
}

Estimate EstimateOf(const std::vector<Place>& places, const std::vector<double>& belief) {
  Estimate estimate;
  for (std::size_t k = 0; k < places.size(); ++k) {
    estimate.mean.x_m += belief[k] * places[k].x_m;
    estimate.mean.y_m += belief[k] * places[k].y_m;
  }
  double squares = 0.0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double distance_m = DistanceM(places[k], estimate.mean);
    squares += belief[k] * distance_m * distance_m;
  }
  estimate.spread_m = std::sqrt(squares);
  estimate.mode = places[static_cast<std::size_t>(std::ranges::max_element(belief) - belief.begin())];
  return estimate;
}

}  // namespace cairn::localization
