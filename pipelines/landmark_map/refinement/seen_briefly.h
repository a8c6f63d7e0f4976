// Landmarks of a short stay: EM looks at one image a frame where nothing has a name, and what one image alone
// shows is none to it.
#pragma once

#include <vector>

#include "pipelines/landmark_map/landmarks/summary.h"
#include "pipelines/landmark_map/refinement/placing.h"

namespace cairn::landmark_map {

// Of `type`, among the rows of all robots that have no name and are of no landmark: where three images or
// more show something, and that so many false observations fell together is much less likely; none where more
// than one row in fifty is of no landmark, for what comes by stands in one place, too. None within `apart_m`
// of `landmarks`. Rows of one landmark agree to `sigma_m` along either axis.
std::vector<Landmark> FindSeenBriefly(const std::vector<std::vector<PlacedRow>>& rows,
                                      const std::vector<Landmark>& landmarks, double sigma_m, double apart_m,
                                      int type);

}  // namespace cairn::landmark_map
