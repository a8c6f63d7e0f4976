// The checksum trailer at the end of every file that Cairn writes: 24 bytes behind HDF5's, "CAIRNSUM" and the
// XXH3-128 of all bytes before. HDF5 does not look there, and cuts it off where a program changes the file
// through HDF5. A store looks at it before HDF5 has seen a byte (HDF5 1.10 can crash on a damaged file); of
// files that people name it sees what Fletcher-32 does not, which takes 0x0000 and 0xFFFF for the same.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>

#include "schema/error.h"
#include "schema/store/regular_file.h"

namespace cairn::store {

inline constexpr std::size_t kTrailerBytes = 24;

std::array<std::byte, kTrailerBytes> TrailerOf(std::span<const std::byte> bytes);

// Cuts off what stands behind the end of an HDF5 file, and puts the checksum trailer there. Returns errno, or
// 0.
int EndWithTrailer(const std::filesystem::path& path);

// kCorrupt: no checksum trailer, or one of other bytes; kNotFound; kIo. The message names the file.
Status CheckTrailer(const std::filesystem::path& path);
Status CheckTrailer(std::span<const std::byte> image, const std::string& name);

// Whether there is a checksum trailer at all, right or wrong: files from before there were checksum trailers
// have none, and those of other programs.
bool HasTrailer(const RegularFile& file);
bool HasTrailer(const std::filesystem::path& path);
Status CheckTrailer(const RegularFile& file, const std::string& name);

}  // namespace cairn::store
