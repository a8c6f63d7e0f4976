// The same world seen from elsewhere: turned, shifted, its robots in another order, its names others. What a
// pipeline says of it must turn, shift and change places with it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn::conformance {

// A turn about the origin, then a shift. Quarter turns and shifts by whole cells move a grid onto itself.
struct Motion {
  double angle_rad = 0;  // on top of the quarter turns; a grid has no place in a blob that is turned so
  int quarters = 0;
  double x_m = 0, y_m = 0;
};

// All of a blob that is said in the world's frame (schema/FORMAT.md): positions, headings, covariances,
// grids. Headings come out in (-pi, pi]. What is said from a robot's or a trace's own frame stays as it is.
Blob Moved(const Blob& blob, const Motion& motion);

// robot/N/ (or run/N/) of the result is robot/order[N]/ of the blob, in the list of names too.
Blob Reordered(const Blob& blob, const std::string& group, const std::vector<std::size_t>& order);

// Of learned networks the samples of the map by run and way, for they lie in the order in which the method
// looked through space; anything else as it is.
Blob InOrder(const Blob& result);

// Paths as seen from where they begin.
Blob InItsOwnFrame(const Blob& result);

// The fields in which two blobs differ, a line each, with the largest difference; empty: they agree. Numbers
// may be `tolerance` apart, angles modulo a full turn. Not looked at: hashes of inputs, and names that
// `passed_over` takes.
std::string Differences(const Blob& a, const Blob& b, double tolerance,
                        const std::function<bool(const std::string&)>& passed_over = {});

}  // namespace cairn::conformance
