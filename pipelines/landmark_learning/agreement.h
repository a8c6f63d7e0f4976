// Whether two series along a run go together by more than chance, however slowly they change.
#pragma once

#include <cstddef>
#include <vector>

namespace cairn::landmark_learning {

// By how many standard deviations of chance. `one`, `other`: [rows][columns], rows in the order of the run.
// Both are turned to the principal axes of `one`, so that columns that say the same count once, and taken
// apart into waves along the run (their discrete cosine transform but for the mean); c is what the two have
// in common of a wave on an axis. Of what is unrelated, drift included, a wave agrees as often as not, so
// that the sum of s = sign(c) sqrt|c| has the mean 0 and the variance sum s^2 whatever the waves' sizes: what
// few waves make up counts as little as they are many. The root lets shorter waves, of which there are more,
// count beside the longest. 0 where nothing changes, or of a single row.
double AgreementSigmas(const std::vector<double>& one, const std::vector<double>& other, std::size_t columns);

}  // namespace cairn::landmark_learning
