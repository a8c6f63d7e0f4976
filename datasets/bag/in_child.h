// Bags of strangers, read in a child process with limits of processor time and memory
// (schema/store/guarded.h).
#pragma once

#include <functional>
#include <string>

#include "datasets/bag/import_bag.h"
#include "datasets/bag/inspect_bag.h"
#include "schema/error.h"

namespace cairn::datasets {

// ImportBag. What it throws is a Status of kRefused; others are as InChild has them.
Result<ImportReport> ImportBagInChild(const BagImportOptions& options, Blob* log);

// What `tell` makes of InspectBag, both in the child.
Result<std::string> InspectBagInChild(const std::string& path,
                                      const std::function<std::string(const BagInspection&)>& tell);

}  // namespace cairn::datasets
