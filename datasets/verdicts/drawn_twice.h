// Whether a local_map draws walls twice, which its loops do not tell.
#pragma once

#include "datasets/verdicts/verdict.h"
#include "schema/kinds/local_map.h"

namespace cairn::datasets {

// Where two lasers of a robot see the same walls in different places each wall stands twice: low.
void JudgeLasers(const kinds::LocalMap& map, Verdict* verdict);

// Where a loop is closed wrongly, or missed, all others may close: but scans of other passes see through the
// walls. Low where they are a seventh of those that were compared, fair at most from half of that on.
void JudgePasses(const kinds::LocalMap& map, Verdict* verdict);

}  // namespace cairn::datasets
