// Where the robot believes to be: [T98] table 1 (S. Thrun, Bayesian Landmark Learning for Mobile Robot
// Localization, Machine Learning 33, 1998) on a set of places, which are the training locations or the cells
// of a grid.
#pragma once

#include <vector>

#include "pipelines/localization/place_index.h"

namespace cairn::localization {

// P(xi | xi~, a): where the robot is after a displacement, a Gaussian around where it should be.
struct Motion {
  double sd_m = 0.1;            // an axis, of any displacement: errors of the places' labels
  double sd_ratio = 0.1;        // an axis, a share of the displacement
  double least_sd_m = 0.0;      // places are so far apart that less would fall between them
  double heading_sd_rad = 0.3;  // of a turn; of Drive alone
  double SdM(double displacement_m) const;
};

// Places to believe in, and where the robot faces there; headings are empty where they do not count.
struct Poses {
  std::vector<Place> places;
  std::vector<double> heading_rad;

  // Whether what was seen at one may be seen at the other: at most 90 degrees apart.
  bool FaceAlike(std::size_t a, std::size_t b) const;
};

// What a robot that does not know its heading knows of its motion: how far it got forward and to its left, as
// it faced at the beginning, and by how much it faces elsewhere at the end.
struct OwnMotion {
  Place moved;  // x_m: forward
  double turn_rad = 0.0;
};

// The places and how much room each has to itself: places may lie densely here and sparsely there, but a
// robot does not prefer to be where more was recorded.
class BeliefSpace {
 public:
  // `room`: [places], any unit; see RoomOf.
  BeliefSpace(Poses poses, std::vector<double> room);

  const std::vector<Place>& places() const { return poses_.places; }

  // Bel_prior where nothing is known: by room, sums to 1.
  const std::vector<double>& Anywhere() const { return anywhere_; }

  // The same within `window_m` of a place. Throws InputError where no place is.
  std::vector<double> Near(const Place& centre, double window_m) const;

  // Eq. 19: Bel(xi) <- sum over xi~ of P(xi | xi~, a) Bel(xi~), normalised; `displacement` is a. Then a share
  // `lost` of the belief goes anywhere. What leaves the places is lost; false where nothing remains, and
  // `belief` is then all zeros.
  [[nodiscard]] bool Move(const Place& displacement, const Motion& motion, double lost,
                          std::vector<double>* belief) const;

  // The same by a motion that starts, at each place, from the heading there, and ends at places that face
  // accordingly: a Gaussian around the turn. There are headings.
  [[nodiscard]] bool Drive(const OwnMotion& own, const Motion& motion, double lost,
                           std::vector<double>* belief) const;

  // Nothing is left at places that do not face like `heading_rad`; normalised. False, and nothing done, where
  // nothing would remain.
  [[nodiscard]] bool KeepFacing(double heading_rad, std::vector<double>* belief) const;

 private:
  // To the aim of each place, `weight(from, to)` times the Gaussian in place.
  template <class Aim, class Weight>
  bool Spread(double sd_m, double lost, const Aim& aim, const Weight& weight,
              std::vector<double>* belief) const;

  Poses poses_;
  PlaceIndex index_;
  std::vector<double> room_, anywhere_;
};

// Eqs 17 and 18: Bel(xi) <- P(f | xi) Bel(xi), normalised. False where the model holds f for impossible
// wherever the robot may be: the belief stays what it was.
[[nodiscard]] bool Sense(const std::vector<double>& likelihood, std::vector<double>* belief);

// The room of place number `at`: one over the density of places around it that face alike, by a Gaussian
// kernel of `bandwidth_m`. `index`: of the places.
double RoomOf(const PlaceIndex& index, const Poses& poses, std::size_t at, double bandwidth_m);

// The mean distance from a place to the nearest other one that faces alike; 0 where none has one.
double SpacingM(const PlaceIndex& index, const Poses& poses);

struct Estimate {
  Place mean, mode;
  double spread_m = 0.0;  // root of the mean squared distance from the mean
};
Estimate EstimateOf(const std::vector<Place>& places, const std::vector<double>& belief);

}  // namespace cairn::localization
