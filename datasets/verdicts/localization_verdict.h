// How far a localization can be trusted.
#pragma once

#include "datasets/verdicts/verdict.h"
#include "schema/blob.h"

namespace cairn::datasets {

// Of a localization, by what its robots say of themselves: how many end sure of their place (a spread of at
// most a quarter of that of positions anywhere), and whether the features were foretold as well as the
// beliefs say they should be; and by whether those that are sure are as near to where the samples were
// labelled. Low: fewer than half are sure, or they were foretold less well, as on a map of another place, or
// fewer than two thirds of the sure ones, or than half of all, are there, to within that or twice their own
// spread, or the networks' own verdict is low. Else fair. Not known
// of a file that does not tell how well they were foretold.
Verdict LocalizationVerdict(const Blob& result);

}  // namespace cairn::datasets
