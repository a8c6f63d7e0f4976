// Landmarks without identity that come in classes: what a landmark seemed to be may be wrong, but tells
// something ([TBF98] section 2.2: the robot might misjudge the type of a landmark).
#pragma once

#include <vector>

#include "pipelines/common/layered_grid.h"

namespace cairn::landmark_map {

// The classes' layers begin after those of the identified landmarks: of the counts and the perception by what
// was seen, of the map by what is there.
struct ClassRules {
  int count = 1;                       // classes; 1: all look alike
  std::vector<double> confusion{1.0};  // [count][count]: P(seems of the column's class | is of the row's)

  double Confusion(int as, int is) const { return confusion[static_cast<std::size_t>(is * count + as)]; }
};

// The sum of layers [first, first + weights.size()), each times its weight.
Layer WeightedSum(const LayeredGrid& grid, int first, const std::vector<double>& weights);

// Counts of all classes together.
Layer CountsOfAllClasses(const LayeredGrid& counts, int first, const ClassRules& rules);

// P(class | c_j observations seemed of class j), no class being likelier before: proportional to the product
// over j of P(seems j | class)^c_j. A landmark is of one class.
std::vector<double> ClassPosterior(const std::vector<double>& seemed, const ClassRules& rules);

// `map`, which says where landmarks are, split among the classes by the observations within `radius_cells` of
// each cell.
std::vector<Layer> SplitAmongClasses(const Layer& map, const LayeredGrid& counts, int first,
                                     double radius_cells, const ClassRules& rules);

}  // namespace cairn::landmark_map
