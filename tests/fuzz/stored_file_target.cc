#include "schema/store/blob_file.h"
#include "schema/store/encode.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

Blob SeedBlob() {
  Blob blob;
  blob.PutScalar<double>("x_m", 1);
  blob.Put("name", Array::Texts({"a", "b"}));
  return blob;
}

Bytes File() {
  const store::FileImage image = store::EncodeBlob("blob", SeedBlob()).value();
  const auto* data = reinterpret_cast<const std::uint8_t*>(image.data.get());
  return {data, data + image.size};
}

// What HDF5 does with damaged bytes is none of the store's business: it does not get them.
Outcome Run(std::span<const std::uint8_t> bytes) {
  static const Bytes good = File();
  static const ScratchFolder folder;
  folder.Put("blob.h5", AsText(bytes));
  const Result<BlobFile> read = ReadStoredFile(folder.path() / "blob.h5");
  const bool same = std::equal(bytes.begin(), bytes.end(), good.begin(), good.end());
  if (same) CAIRN_DEMAND(read.ok(), read.status().message());
  if (!same && !read.ok()) CAIRN_DEMAND(read.status().code() == Code::kCorrupt, read.status().message());
  return read.ok() ? Outcome::kAccepted : Outcome::kRefused;
}

std::vector<Bytes> Seeds() { return {File()}; }

}  // namespace

Target StoredFileTarget() { return {"stored_file", Run, Seeds, 3000}; }

}  // namespace cairn::fuzz
