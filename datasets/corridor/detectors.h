// Detectors of doors and of ceiling lights, as an engineer would write them who has seen the corridor: they
// look at nothing but the image and the sonars.
#pragma once

#include <span>

#include "datasets/corridor/band_features.h"

namespace cairn::datasets::corridor {

// The camera points at a wall. `side_range_m`: of the sonar that points the same way.
bool DetectDoor(const RgbImage& image, double side_range_m);

// The camera points at the ceiling.
bool DetectLight(const RgbImage& image);

}  // namespace cairn::datasets::corridor
