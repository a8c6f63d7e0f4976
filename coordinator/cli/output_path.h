// Where a command writes to.
#pragma once

#include <string>

namespace cairn::cli {

// Throws InputError where `path` is there already and `force` is not given, or its folder is not there: said
// before the work is done.
void RefuseToOverwrite(const std::string& path, bool force);

}  // namespace cairn::cli
