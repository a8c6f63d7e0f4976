// Linked into faults-worker-old in place of schema/build_info.cc: a worker of another version.
#include "schema/build_info.h"

namespace cairn {

wire::Build ThisBuild() {
  wire::Build build;
  build.set_version("0.0.1");
  return build;
}

}  // namespace cairn
