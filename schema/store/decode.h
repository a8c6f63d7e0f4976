// What an open HDF5 file holds, checked. Messages of a failed Status name the dataset, not the file. Nothing
// is taken from anywhere but the file: where one says that its data are in another (external storage, virtual
// datasets, external links), or asks for a filter that HDF5 does not bring, it is refused.
#pragma once

#include <hdf5.h>

#include <functional>
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
Result<Array> ReadDataset(hid_t file, const std::string& name);
// Its elements, row-major, in parts of about a MiB, which `take` may refuse (kIo). Beside them memory holds
// as many chunks as such a part touches: of Cairn's own files a few MiB, of one that is a single chunk all of
// it.
Status ReadInParts(hid_t file, const std::string& name,
                   const std::function<bool(std::span<const std::byte>)>& take);

}  // namespace cairn::store
