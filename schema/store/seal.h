// The seal at the end of every file that Cairn writes: 24 bytes behind HDF5's, "CAIRNSUM" and the XXH3-128 of
// all bytes before. HDF5 does not look there. It lets a store tell a damaged file before HDF5 has seen a byte
// of it: HDF5 1.10 can crash on one.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>

#include "schema/error.h"

namespace cairn::store {

inline constexpr std::size_t kSealBytes = 24;

std::array<std::byte, kSealBytes> SealOf(std::span<const std::byte> bytes);

// kCorrupt: no seal, or one of other bytes; kNotFound; kIo. The message names the file.
Status CheckSeal(const std::filesystem::path& path);
Status CheckSeal(std::span<const std::byte> image, const std::string& name);

// Whether there is a seal at all, right or wrong: files from before there were seals have none.
bool HasSeal(const std::filesystem::path& path);

}  // namespace cairn::store
