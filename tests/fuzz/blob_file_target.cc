#include "schema/store/blob_file.h"
#include "schema/store/encode.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {

Outcome FuzzBlobFile(std::span<const std::uint8_t> bytes) {
  const Result<BlobFile> read = ReadBlobImage(std::as_bytes(bytes), "fuzz");
  if (!read.ok()) return Outcome::kRefused;
  const Result<store::Image> image = store::EncodeBlob(read.value().kind, read.value().blob);
  CAIRN_DEMAND(image.ok(), image.status().message());
  const Result<BlobFile> again = ReadBlobImage(image.value().bytes(), "again");
  CAIRN_DEMAND(again.ok(), again.status().message());
  CAIRN_DEMAND(again.value().kind == read.value().kind, "the kind did not come back");
  CAIRN_DEMAND(again.value().blob.ContentHash() == read.value().blob.ContentHash(),
               "the blob did not come back");
  return Outcome::kAccepted;
}

}  // namespace cairn::fuzz
