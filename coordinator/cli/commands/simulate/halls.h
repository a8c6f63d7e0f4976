// `cairn simulate hallway`, `narrow-doors`, `smooth-wall`: sonar logs for occupancy maps; `office`: for local
// ones.
#pragma once

#include "coordinator/cli/common/invocation.h"

namespace cairn::cli {

void AddSimulateHalls(Command simulate, Invocation& call);
void AddSimulateOffice(Command simulate, Invocation& call);

}  // namespace cairn::cli
