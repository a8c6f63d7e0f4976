// Linked into faults-worker-old in place of worker/build_info.cc: a worker of another version.
#include "worker/build_info.h"

namespace cairn::worker {

wire::Build ThisBuild() {
  wire::Build build;
  build.set_version("0.0.1");
  return build;
}

}  // namespace cairn::worker
