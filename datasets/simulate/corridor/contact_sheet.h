// The images of one run on a page, for people to look at.
#pragma once

#include <string>
#include <vector>

#include "datasets/simulate/corridor/camera.h"

namespace cairn::datasets::corridor {

// As PNG: `per_row` images in a row, each three times as large as it is. All of a size; at least one.
std::string ContactSheetPng(const std::vector<RgbImage>& images, int per_row);

}  // namespace cairn::datasets::corridor
