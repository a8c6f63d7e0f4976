// The report's page about learned networks: how training went, and what the networks see along the way.
#pragma once

#include <string>

#include "schema/blob.h"

namespace cairn::datasets::report {

// The page's parts between title and footer. `result`: of kind `networks`. Throws InputError where its arrays
// do not fit each other.
std::string NetworksHtml(const Blob& result);

}  // namespace cairn::datasets::report
