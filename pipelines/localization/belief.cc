#include "pipelines/localization/belief.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "schema/error.h"

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

BeliefSpace::BeliefSpace(std::vector<Place> places, std::vector<double> room)
    : places_(std::move(places)), index_(places_), room_(std::move(room)), anywhere_(room_) {
  CAIRN_DEMAND(room_.size() == places_.size() && Normalise(&anywhere_), "each place has some room");
}

std::vector<double> BeliefSpace::Near(const Place& centre, double window_m) const {
  std::vector<double> belief(places_.size(), 0.0);
  for (const std::size_t place : index_.Within(centre, window_m)) belief[place] = anywhere_[place];
  if (Normalise(&belief)) return belief;
  char text[160];
  std::snprintf(text, sizeof text, "window_m = %g m reaches no place of the map from (%g, %g) m", window_m,
                centre.x_m, centre.y_m);
  throw InputError(text);
}

bool BeliefSpace::Move(const Place& displacement, const Motion& motion, double lost,
                       std::vector<double>* belief) const {
  const double sd_m = motion.SdM(std::hypot(displacement.x_m, displacement.y_m));
  const double least = kForgotten * *std::ranges::max_element(*belief);
  std::vector<double> moved(places_.size(), 0.0);
  for (std::size_t from = 0; from < places_.size(); ++from) {
    if ((*belief)[from] <= least) continue;
    const Place to{places_[from].x_m + displacement.x_m, places_[from].y_m + displacement.y_m};
    index_.VisitWithin(to, kReach * sd_m, [&](std::size_t place, double distance_m) {
      moved[place] += (*belief)[from] * Gaussian(distance_m, sd_m);
    });
  }
  for (std::size_t place = 0; place < moved.size(); ++place) moved[place] *= room_[place];
  *belief = std::move(moved);
  const bool remains = Normalise(belief);
  for (std::size_t place = 0; place < belief->size(); ++place)
    (*belief)[place] = (1.0 - lost) * (*belief)[place] + lost * anywhere_[place];
  return remains || Normalise(belief);
}

bool Sense(const std::vector<double>& likelihood, std::vector<double>* belief) {
  std::vector<double> sensed(belief->size());
  for (std::size_t place = 0; place < sensed.size(); ++place)
    sensed[place] = likelihood[place] * (*belief)[place];
  if (!Normalise(&sensed)) return false;
  *belief = std::move(sensed);
  return true;
}

double RoomOf(const PlaceIndex& index, const std::vector<Place>& places, const Place& at,
              double bandwidth_m) {
  double density = 0.0;
  for (const std::size_t place : index.Within(at, kReach * bandwidth_m))
    density += Gaussian(DistanceM(places[place], at), bandwidth_m);
  return 1.0 / density;
}

double SpacingM(const PlaceIndex& index, const std::vector<Place>& places) {
  if (places.size() < 2) return 0.0;
  double sum_m = 0.0;
  for (const Place& place : places) sum_m += DistanceM(places[index.Nearest(place, 2)[1]], place);
  return sum_m / static_cast<double>(places.size());
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
