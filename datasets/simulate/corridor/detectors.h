// Detectors of doors and of ceiling lights, as an engineer would write them who has seen the corridor: they
// look at nothing but the image and the sonars.
#pragma once

#include <span>

#include "datasets/simulate/corridor/camera.h"

namespace cairn::datasets::corridor {

// The camera points at a wall. `side_ranges_m`: of the sonars that point the same way.
bool DetectDoor(const RgbImage& image, std::span<const float> side_ranges_m);

// The camera points at the ceiling.
bool DetectLight(const RgbImage& image);

}  // namespace cairn::datasets::corridor
