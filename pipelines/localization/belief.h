// Where the robot believes to be: [T98] table 1 (S. Thrun, Bayesian Landmark Learning for Mobile Robot
// Localization, Machine Learning 33, 1998) on a set of places, which are the training locations or the cells
// of a grid.
#pragma once

#include <vector>

#include "pipelines/localization/place_index.h"

namespace cairn::localization {

// P(xi | xi~, a): where the robot is after a displacement, a Gaussian around where it should be.
struct Motion {
  double sd_m = 0.1;        // an axis, of any displacement: errors of the places' labels
  double sd_ratio = 0.1;    // an axis, a share of the displacement
  double least_sd_m = 0.0;  // places are so far apart that less would fall between them
  double SdM(double displacement_m) const;
};

// The places and how much room each has to itself: places may lie densely here and sparsely there, but a
// robot does not prefer to be where more was recorded.
class BeliefSpace {
 public:
  // `room`: [places], any unit; see RoomOf.
  BeliefSpace(std::vector<Place> places, std::vector<double> room);

  const std::vector<Place>& places() const { return places_; }

  // Bel_prior where nothing is known: by room, sums to 1.
  const std::vector<double>& Anywhere() const { return anywhere_; }

  // The same within `window_m` of a place. Throws InputError where no place is.
  std::vector<double> Near(const Place& centre, double window_m) const;

  // Eq. 19: Bel(xi) <- sum over xi~ of P(xi | xi~, a) Bel(xi~), normalised; `displacement` is a. Then a share
  // `lost` of the belief goes anywhere. What leaves the places is lost; false where nothing remains, and
  // `belief` is then all zeros.
  [[nodiscard]] bool Move(const Place& displacement, const Motion& motion, double lost,
                          std::vector<double>* belief) const;

 private:
  std::vector<Place> places_;
  PlaceIndex index_;
  std::vector<double> room_, anywhere_;
};

// Eqs 17 and 18: Bel(xi) <- P(f | xi) Bel(xi), normalised. False where the model holds f for impossible
// wherever the robot may be: the belief stays what it was.
[[nodiscard]] bool Sense(const std::vector<double>& likelihood, std::vector<double>* belief);

// The room of a place: one over the density of places around it, by a Gaussian kernel of `bandwidth_m`.
double RoomOf(const PlaceIndex& index, const std::vector<Place>& places, const Place& at, double bandwidth_m);

// The mean distance from a place to the nearest other one; 0 with fewer than two.
double SpacingM(const PlaceIndex& index, const std::vector<Place>& places);

struct Estimate {
  Place mean, mode;
  double spread_m = 0.0;  // root of the mean squared distance from the mean
};
Estimate EstimateOf(const std::vector<Place>& places, const std::vector<double>& belief);

}  // namespace cairn::localization
