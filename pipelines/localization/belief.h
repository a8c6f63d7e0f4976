// Where the robot believes to be: [Thr98] table 1 on a set of positions, which are the training locations or
// the cells of a grid.
#pragma once

#include <vector>

#include "pipelines/localization/position_index.h"

namespace cairn::localization {

// P(xi | xi~, a): where the robot is after a displacement, a Gaussian around where it should be.
struct Motion {
  double sd_m = 0.1;            // an axis, of any displacement: errors of the positions' labels
  double sd_ratio = 0.1;        // an axis, a share of the displacement
  double least_sd_m = 0.0;      // positions are so far apart that less would fall between them
  double heading_sd_rad = 0.3;  // of a turn; of Drive alone
  double SdM(double displacement_m) const;
};

// Positions to believe in, and where the robot faces there; headings are empty where they do not count.
struct Poses {
  std::vector<Position> positions;
  std::vector<double> heading_rad;

  // Whether what was seen at one may be seen at the other: at most 90 degrees apart.
  bool FaceAlike(std::size_t a, std::size_t b) const;
};

// What a robot that does not know its heading knows of its motion: how far it got forward and to its left, as
// it faced at the beginning, and by how much it faces elsewhere at the end.
struct OwnMotion {
  Position moved;  // x_m: forward
  double turn_rad = 0.0;
  static void Fields(const auto& field) {
    field("moved", &OwnMotion::moved);
    field("turn_rad", &OwnMotion::turn_rad);
  }
};

// The positions and how much room each has to itself: positions may lie densely here and sparsely there, but
// a robot does not prefer to be where more was recorded.
class BeliefSpace {
 public:
  // `room`: [positions], any unit; see RoomOf.
  BeliefSpace(Poses poses, std::vector<double> room);

  const std::vector<Position>& positions() const { return poses_.positions; }

  // Bel_prior where nothing is known: by room, sums to 1.
  const std::vector<double>& Anywhere() const { return anywhere_; }

  // The same within `window_m` of a position.
  // Throws InputError where no position is.
  std::vector<double> Near(const Position& centre, double window_m) const;

  // [Thr98] eq. 19: Bel(xi) <- sum over xi~ of P(xi | xi~, a) Bel(xi~), normalised; `displacement` is a. Then
  // a share `lost` of the belief goes anywhere. What leaves the positions is lost; false where nothing
  // remains, and `belief` is then all zeros.
  [[nodiscard]] bool Move(const Position& displacement, const Motion& motion, double lost,
                          std::vector<double>* belief) const;

  // The same by a motion that starts, at each position, from the heading there, and ends at positions that
  // face accordingly: a Gaussian around the turn. There are headings.
  [[nodiscard]] bool Drive(const OwnMotion& own, const Motion& motion, double lost,
                           std::vector<double>* belief) const;

  // Nothing is left at positions that do not face like `heading_rad`; normalised. False, and nothing done,
  // where nothing would remain.
  [[nodiscard]] bool KeepFacing(double heading_rad, std::vector<double>* belief) const;

 private:
  // To the aim of each position, `weight(from, to)` times the Gaussian in place.
  template <class Aim, class Weight>
  bool Spread(double sd_m, double lost, const Aim& aim, const Weight& weight,
              std::vector<double>* belief) const;

  Poses poses_;
  PositionIndex index_;
  std::vector<double> room_, anywhere_;
};

// [Thr98] eqs 17 and 18: Bel(xi) <- P(f | xi) Bel(xi), normalised. False where the model holds f for
// impossible wherever the robot may be: the belief stays what it was.
[[nodiscard]] bool Sense(const std::vector<double>& likelihood, std::vector<double>* belief);

// The room of position number `at`: one over the density of positions around it that face alike, by a
// Gaussian kernel of `bandwidth_m`. `index`: of the positions.
double RoomOf(const PositionIndex& index, const Poses& poses, std::size_t at, double bandwidth_m);

// The mean distance from a position to the nearest other one that faces alike; 0 where none has one.
double SpacingM(const PositionIndex& index, const Poses& poses);

struct Estimate {
  Position mean, mode;
  double spread_m = 0.0;  // root of the mean squared distance from the mean
};
Estimate EstimateOf(const std::vector<Position>& positions, const std::vector<double>& belief);

}  // namespace cairn::localization
