// Where a command writes to.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "schema/blob.h"

namespace cairn::cli {

// Throws InputError where `path` is one of `inputs`, by whatever name: not even force may replace what is
// read.
void CheckOutputIsNoInput(const std::string& path, const std::vector<std::string>& inputs);

// The same for a folder of third-party data: its own files are .dat and .txt, plain or gzipped; a log may lie
// among them.
void CheckOutputIsNotInDataset(const std::string& path, const std::string& folder);

// Throws InputError where `path` is there already and `force` is not given, or its folder is not there: said
// before the work is done.
void CheckOverwrite(const std::string& path, bool force);

// Throws the same InputError where another has come to be there meanwhile, and `force` is not given.
void WriteOutput(const std::string& path, const std::string& kind, const Blob& blob, bool force);

// The same of the bytes of a file.
void WriteOutput(const std::string& path, std::string_view bytes, bool force);

}  // namespace cairn::cli
