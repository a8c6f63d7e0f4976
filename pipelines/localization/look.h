// Where to look next: of several sensors (camera directions), the one after which the error that is expected
// is least ([Thr98] section 7, active sensing).
#pragma once

#include <cstddef>
#include <vector>

#include "pipelines/localization/position_index.h"

namespace cairn::localization {

// Columns of the features that one sensor gives: first <= i < end.
struct FeatureGroup {
  std::size_t first = 0, end = 0;
  std::size_t size() const { return end - first; }
  static void Fields(const auto& field) {
    field("first", &FeatureGroup::first);
    field("end", &FeatureGroup::end);
  }
};

// E_posterior of a robot that believes `belief` and senses the group's features next, the truth being as
// likely as it believes: the sum over xi* of Bel(xi*) times [Thr98] eq. 22, with e the distance. `map`: P(f_i
// = 1 | xi), [positions][features]. Positions below a thousandth of the most likely one's belief are left
// out. Costs positions^2 2^n of those that are left.
double ExpectedError(const std::vector<Position>& positions, const std::vector<double>& belief,
                     const std::vector<double>& map, std::size_t features, const FeatureGroup& group);

// Throws InputError where ExpectedError would weigh the outcomes of more than 12 features: 2^n of them, at
// each stop.
void RequireWeighable(const std::vector<FeatureGroup>& groups);

// The group with the least expected error; of equal ones the first.
std::size_t BestLook(const std::vector<Position>& positions, const std::vector<double>& belief,
                     const std::vector<double>& map, std::size_t features,
                     const std::vector<FeatureGroup>& groups);

}  // namespace cairn::localization
