// What networks are worth, by the run that was held out of their training.
#pragma once

#include "schema/kinds/learning.h"

namespace cairn {

// At the step of the least error on that run, whose weights are kept.
kinds::NetworksWorth WorthOf(const kinds::Networks& networks);

}  // namespace cairn
