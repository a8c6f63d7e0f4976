// Reading a file of anybody, in this process: what runs in the children of guarded.h.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "schema/store/guarded.h"

namespace cairn::store {

// As ReadBlobFile says.
Result<FileContents> ReadChecked(const std::filesystem::path& path, const ReadOptions& options);

// The bytes of these arrays, one after the other, in parts (decode.h, ReadInParts). Of checksum trailers
// nothing is asked.
Status ReadArraysInParts(const std::filesystem::path& path, const std::vector<std::string>& names,
                         const std::function<bool(std::span<const std::byte>)>& take);

}  // namespace cairn::store
