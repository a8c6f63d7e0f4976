// How long a stage will take yet, guessed from what its rounds took. For people; no result depends on it.
#pragma once

#include "coordinator/job.h"

namespace cairn::coordinator {

// Seconds until the stage under way is done; 0 where nobody can tell: the job does not run, its pipeline does
// not say how many rounds are left, or nothing is known of its pace yet.
double StageLeft_s(const Job& job, double now_s);

}  // namespace cairn::coordinator
