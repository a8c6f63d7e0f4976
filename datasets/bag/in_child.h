// Bags of strangers, read in a child process with limits of processor time and memory
// (schema/store/guarded.h).
#pragma once

#include <functional>
#include <string>

#include "datasets/bag/import_bag.h"
#include "datasets/bag/inspect_bag.h"
#include "schema/error.h"

namespace cairn::datasets {

struct StoredImport {
  ImportReport report;
  std::string told;  // by `store`
};
// ImportBag, and `store` of the log that it makes, which stays in the child. What they throw is a Status of
// kRefused; others are those of `store`, of the folder's disk, and as InChild has them.
Result<StoredImport> ImportBagInChild(
    const BagImportOptions& options,
    const std::function<Result<std::string>(const Blob& log, const ImportReport& report)>& store);

// What `tell` makes of InspectBag, both in the child.
Result<std::string> InspectBagInChild(const std::string& path,
                                      const std::function<std::string(const BagInspection&)>& tell);

}  // namespace cairn::datasets
