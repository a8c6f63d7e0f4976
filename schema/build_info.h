// What this build is, for the handshake: a coordinator and its workers must agree, or their bits may not.
#pragma once

#include "schema/wire.pb.h"

namespace cairn {

// A hash of the sources of schema and pipelines, their tests aside, in hexadecimal digits.
const char* SourcesOfThisBuild();

// Runs the numeric self-test; FixNumericsOfProcess and FixNumericsOfThread come before it.
wire::Build ThisBuild();

}  // namespace cairn
