#include "tests/fuzz/targets.h"

namespace cairn::fuzz {

std::vector<Target> AllTargets() {
  return {CsvTarget(),      MrclamTarget(),   JobFileTarget(),      KeysTarget(),       MessageTarget(),
          WorkerTarget(),   BlobFileTarget(), StoredFileTarget(),   CheckpointTarget(), CoordinatorTarget(),
          JobTableTarget(), LogTarget(),      ResultTarget(),       VectorsTarget(),    CarmenTarget(),
          RangesTarget(),   BagTarget(),      BagContainerTarget(), BagMessageTarget()};
}

}  // namespace cairn::fuzz
