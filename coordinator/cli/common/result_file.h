// What a person means by RESULT: a result file, or the folder that a run left.
#pragma once

#include <string>
#include <vector>

#include "coordinator/cli/common/invocation.h"
#include "schema/command_line/command.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {

// The Cairn files right in the folder, by name.
// Throws InputError where it is no folder.
std::vector<std::string> FilesOf(const std::string& folder);

// The one result of `kind` that `path` names: itself, or in its folder.
// Throws InputError where there is none or are several.
std::string ResultPath(const std::string& path, const std::string& kind);

// Of evaluate, report and export: what they say of a result would be taken for Cairn's.
void AddChangedFlag(Command command, bool* changed_too);

// Reads it whole, and checks the arrays of its kind (schema/kinds/kind.h): throws InputError where they do
// not fit. Where another program has changed what Cairn wrote, it says so on stderr; throws InputError of a
// result (not a log, not samples, which are people's own to change) unless `changed_too`.
BlobFile ReadFile(const std::string& path, bool changed_too = false);
BlobFile ReadResult(const std::string& path, const std::string& kind, bool changed_too = false);

// A file of any kind; of a folder the one result of the first of these kinds that there is, else of the
// first.
BlobFile ReadFirstOf(const std::string& path, const std::vector<std::string>& kinds,
                     bool changed_too = false);

// Says on stderr that it is so.
void WarnOfChanged(const std::string& path);

}  // namespace cairn::cli
