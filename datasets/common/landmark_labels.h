// What the landmarks of a landmark_map are called where people read of them.
#pragma once

#include <string>
#include <vector>

#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {

// `names`: of the log's landmarks. Of each landmark of the map: its name, and of one without a name its row
// in `map/` after a `#` ("#7"). That is nobody's name: where a landmark of the log is called so all have one
// `#` more ("##7"). As long as `map/landmark_x_m`.
std::vector<std::string> LandmarkLabels(const kinds::LandmarkMap::Map& map,
                                        const std::vector<std::string>& names);

}  // namespace cairn::datasets
