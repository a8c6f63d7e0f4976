#include "pipelines/pipeline.h"

namespace cairn {

std::string Step::Share(Blob blob) {
  auto shared = std::make_shared<const Blob>(std::move(blob));
  const std::string hash = shared->ContentHash().Binary();
  blobs.push_back(std::move(shared));
  return hash;
}

}  // namespace cairn
