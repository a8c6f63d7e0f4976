// A probability grid as the bytes of a PNG file.
#pragma once

#include <string>

#include "datasets/report/scene.h"

namespace cairn::datasets::report {

double HighestProbability(const Grid& grid);

// One colour whose opacity is the root of probability / highest, so that it lies well on light and dark
// paper; north up, a cell a pixel. Grids of more than 1,500 cells along an axis are thinned, each pixel the
// largest of its cells.
std::string GridPng(const Grid& grid, double highest);

// The scale of the above as a column of `height` pixels, the highest on top.
std::string KeyPng(int height);

}  // namespace cairn::datasets::report
