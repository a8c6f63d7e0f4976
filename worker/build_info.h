// What this build is, for the handshake: workers of one fleet must agree, or their bits may not.
#pragma once

#include "schema/wire.pb.h"

namespace cairn::worker {

// Runs the numeric self-test; FixNumericsOfProcess and FixNumericsOfThread come before it.
wire::Build ThisBuild();

}  // namespace cairn::worker
