// The M-step ([TBF98] eqs 19 to 21): expected counts to a map, and the map to what the next
// E-step looks up.
#pragma once

#include <vector>

#include "pipelines/common/layered_grid.h"
#include "pipelines/landmark_map/model/landmark_classes.h"
#include "pipelines/landmark_map/model/perception.h"

namespace cairn::landmark_map {

struct MapRules {
  GridSpec grid;
  int types = 0;       // identities; the layers from `types` on hold the landmarks without one
  ClassRules classes;  // of landmarks without one
  // Some observations have an identity and some have none: the last layers are then of all landmarks, for one
  // without may be of any.
  bool partly_named = false;
  bool named_later = false;    // and the first robot's have none
  double observation_m = 0.3;  // sd of where an observed landmark stands relative to the robot, an axis
  double radius_m = 10.0;      // perceptual radius of landmarks without identity
  double core_m = 2.0;         // landmarks nearer than this to each other are one: no no-landmark evidence
  double prior_count = 0.0;    // expected observations of nothing, in every cell before the first one
  double no_landmark = 0.5;    // lambda: weight of the no-landmark evidence
  double false_rate_per_m2 = 1e-3;  // probability that an observation is false, per area in which it may lie
  bool exact = false;               // Bernoulli cells, P(contact) = m_xi * product over the radius of (1 - m)

  int layers() const { return types + classes.count; }
};

// No observation so far: a layer for each type.
LayeredGrid NoCounts(const MapRules& rules);

// P(m_xy = l) for each layer. Identified landmarks: c / sum of c, each stands in one place. Others: c / (c +
// c* + prior_count), c* the counts within the perceptual radius except the cell's own: times something was
// observed there, of any class, and split among the classes; where observations are partly named, of any
// landmark, for what has no name may be one that others name. Boxes end where the map says less than a
// thousandth of what a false observation says: else a robot that may start anywhere would search, and so
// fill, a larger box every round.
LayeredGrid MapFromCounts(const LayeredGrid& counts, const MapRules& rules);

// P(o | xi, m) for each layer, as `Observe` looks it up.
Perception MakePerception(const LayeredGrid& map, const MapRules& rules);

}  // namespace cairn::landmark_map
