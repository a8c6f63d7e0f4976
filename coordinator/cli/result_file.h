// What a person means by RESULT: a result file, or the folder that a run left.
#pragma once

#include <string>
#include <vector>

#include "schema/store/blob_file.h"

namespace cairn::cli {

// The Cairn files right in the folder, by name. Throws InputError where it is no folder.
std::vector<std::string> FilesOf(const std::string& folder);

// The one result of `kind` that `path` names: itself, or in its folder. Throws InputError where there is none
// or are several.
std::string ResultPath(const std::string& path, const std::string& kind);

// Reads it whole.
BlobFile ReadResult(const std::string& path, const std::string& kind);

}  // namespace cairn::cli
