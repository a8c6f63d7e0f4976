// What an open HDF5 file holds, checked. Messages of a failed Status name the dataset, not the file. Nothing
// is taken from anywhere but the file: where one says that its data are in another (external storage, virtual
// datasets, external links), or asks for a filter that HDF5 does not bring, it is refused.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "schema/store/blob_file.h"

namespace cairn::store {

// The root attributes; kCorrupt where it is not a Cairn file, kVersion where it is of a newer format.
Status ReadRoot(hid_t file, std::int64_t* format, std::string* kind);

// Whether Cairn wrote the file, with a checksum trailer: other programs that change it leave the mark where
// it is.
bool IsMarkedWithTrailer(hid_t file);

// Full names of all datasets, sorted. Soft links are not followed.
Result<std::vector<std::string>> DatasetNames(hid_t file);

Result<DatasetInfo> DescribeDataset(hid_t file, const std::string& name);
// What the arrays of a file may take once they are unpacked: the larger of `usual_bytes` and a hundred times
// the file. A few megabytes of deflate are as many gigabytes as their maker likes; a copy that is not
// deflated may have any size.
std::uint64_t MostUnpacked(std::uint64_t file_bytes, std::uint64_t usual_bytes = std::uint64_t{2} << 30);
// kRefused where those arrays take more.
Status CheckUnpacked(hid_t file, const std::vector<std::string>& names, std::uint64_t most_bytes);
// kRefused also where texts of variable width, which may all be one and the same in the file, take more than
// `most_bytes` with what other arrays hold, kCorrupt where one of a list is longer than kMostTextBytes: at
// the first that is too long.
Result<Array> ReadDataset(hid_t file, const std::string& name,
                          std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max(),
                          std::uint64_t held_bytes = 0);
// Its elements, row-major, in parts of about a MiB, which `take` may refuse (kIo). Beside them memory holds
// as many chunks as such a part touches: of Cairn's own files a few MiB, of one that is a single chunk all of
// it.
Status ReadInParts(hid_t file, const std::string& name, std::uint64_t most_bytes,
                   const std::function<bool(std::span<const std::byte>)>& take);

}  // namespace cairn::store
