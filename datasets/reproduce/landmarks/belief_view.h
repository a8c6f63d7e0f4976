// The beliefs in a landmark_map result (schema/FORMAT.md, robot/N/beliefs), step by step.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "datasets/report/scene.h"
#include "schema/blob.h"

namespace cairn::datasets {

class BeliefView {
 public:
  // Throws InputError where the result holds no beliefs of this robot, or columns that do not fit.
  BeliefView(const Blob& result, std::size_t robot);

  std::size_t size() const { return time_s_.size(); }
  // The last step not after `time_s`; the first where there is none.
  std::size_t StepAt(double time_s) const;
  report::Grid At(std::size_t step) const;

 private:
  std::vector<double> time_s_;
  std::vector<std::int32_t> box_;   // [S][4]
  std::vector<std::size_t> first_;  // of each step's values
  std::vector<double> value_;
  double cell_m_ = 1.0;
};

// The centre of a cell, counted row by row.
Point CentreOf(const report::Grid& grid, std::size_t cell);

// Root of the mean squared distance from the mean; NaN where the grid is empty.
double SpreadM(const report::Grid& grid);

// The share of a grid's mass within `radius_m` of a point; 0 where the grid is empty.
double ShareWithin(const report::Grid& grid, Point centre, double radius_m);

// How many separate places hold at least `share` of a grid's mass each: the most likely cell with all that
// lies within `radius_m` of it is one place, then the most likely of what is left, and so on.
int PlacesWithShare(report::Grid grid, double radius_m, double share);

// The centre of the cell that holds most.
Point MostLikely(const report::Grid& grid);

}  // namespace cairn::datasets
