// Whether two submaps stand rightly to one another where no name says so: by the landmarks that they have in
// common, and by those that one of them lacks though it looked there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "schema/geometry.h"

namespace cairn::landmark_map {

// An observation at a range and bearing, from where the robot then was.
struct PlacedRow {
  double time_s = 0;
  Pose from = {};
  double range_m = 0, bearing_rad = 0;
  std::int32_t landmark = -1;  // which it is of; -1: none
  bool told = true;            // by its name, where the landmark has one
};

// What some robots, or one for some time, saw.
struct Submap {
  struct Seen {
    double x_m, y_m;
    std::int32_t landmark;
    std::int64_t count;  // observations
    bool told = true;    // some of them by the name, where it has one
  };
  // How far and where a robot sees, by the ranges and bearings of what it saw.
  struct View {
    double reach_m, middle_rad, right_rad, left_rad;  // the last two from the middle
  };
  struct Look {
    Pose from;
    std::size_t view;
  };
  std::vector<Seen> landmarks;  // of which it has two observations at least, each where it alone sees it
  std::vector<Look> looks;      // 400 of each robot at most, evenly
  std::vector<View> views;
  double detected = 1;  // of what is in view; by its own landmarks
  double images_a_look = 1;
  double LooksAt(Point at) const;  // how many have a point in view
};

// `rows`: of each robot, by time.
Submap SubmapOf(const std::vector<std::span<const PlacedRow>>& rows);

struct Placing {
  Pose at = {};
  // How much likelier both submaps are so than if they had nothing in common, in nats: each landmark in
  // common is where it would be by chance alone once in an area; each that one side alone has seen, though
  // the other looked there, speaks against it, with three nats at most, for something may stand in between;
  // and the place and heading of one to the other must be told.
  double nats = -std::numeric_limits<double>::infinity();
  // The logarithm of the ratio of being so to having nothing in common, where the one may lie anywhere that
  // touches the other, and landmarks stand as densely as either sees them: by chance alone placings as likely
  // as this one number exp(-odds_nats) on average, at most.
  double odds_nats = -std::numeric_limits<double>::infinity();
  std::size_t contradicted = 0;                            // those that speak against it
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  // landmarks in common: of the one, of the other
};

struct Placings {
  Placing here;                  // as they stand
  std::optional<Placing> other;  // the best in which at most half of what is in common here is so, too

  // Over the best other one, to have nothing in common among them.
  double LeadNats() const { return here.nats - std::max(0.0, other ? other->nats : 0.0); }
  double OddsNats() const { return here.odds_nats - std::max(0.0, other ? other->odds_nats : 0.0); }
};

// Of `one` among `base`; landmarks of both agree to `sigma_m` along either axis. Without `other`.
Placing PlacingHere(const Submap& one, const Submap& base, double sigma_m);
// With it: each pair of landmarks of the one (40 at most, those most seen) is laid on each as long of the
// other, and the best are fitted.
Placings FindPlacings(const Submap& one, const Submap& base, double sigma_m);

}  // namespace cairn::landmark_map
