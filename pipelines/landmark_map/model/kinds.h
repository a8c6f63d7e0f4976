// Landmarks without identity that come in kinds: what a landmark seemed to be may be wrong, but tells
// something ([TBF98] section 2.2: the robot might misjudge the type of a landmark).
#pragma once

#include <vector>

#include "pipelines/common/layered_grid.h"

namespace cairn::landmark_map {

// The kinds' layers begin after those of the identified landmarks: of the counts and the perception by what
// was seen, of the map by what is there.
struct KindRules {
  int count = 1;                       // kinds; 1: all look alike
  std::vector<double> confusion{1.0};  // [count][count]: P(seems of the column's kind | is of the row's)

  double Seems(int as, int is) const { return confusion[static_cast<std::size_t>(is * count + as)]; }
};

// The sum of layers [first, first + weights.size()), each times its weight.
Layer WeightedSum(const LayeredGrid& grid, int first, const std::vector<double>& weights);

// Counts of all kinds together.
Layer CountsOfAllKinds(const LayeredGrid& counts, int first, const KindRules& rules);

// P(kind | c_j observations seemed of kind j), no kind being likelier before: proportional to the product
// over j of P(seems j | kind)^c_j. A landmark is of one kind.
std::vector<double> KindPosterior(const std::vector<double>& seemed, const KindRules& rules);

// `map`, which says where landmarks are, split among the kinds by the observations within `radius_cells` of
// each cell.
std::vector<Layer> SplitAmongKinds(const Layer& map, const LayeredGrid& counts, int first,
                                   double radius_cells, const KindRules& rules);

}  // namespace cairn::landmark_map
