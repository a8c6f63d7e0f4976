#include "schema/store/blob_file.h"
#include "schema/store/encode.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

Outcome Run(std::span<const std::uint8_t> bytes) {
  const Result<BlobFile> read = ReadBlobImage(std::as_bytes(bytes), "fuzz");
  if (!read.ok()) return Outcome::kRefused;
  const Result<store::FileImage> image = store::EncodeBlob(read.value().kind, read.value().blob);
  CAIRN_DEMAND(image.ok(), image.status().message());
  const Result<BlobFile> again = ReadBlobImage(image.value().bytes(), "again");
  CAIRN_DEMAND(again.ok(), again.status().message());
  CAIRN_DEMAND(again.value().kind == read.value().kind, "the kind did not come back");
  CAIRN_DEMAND(again.value().blob.ContentHash() == read.value().blob.ContentHash(),
               "the blob did not come back");
  return Outcome::kAccepted;
}

Bytes FileOf(const Blob& blob) {
  const store::FileImage image = store::EncodeBlob("log", blob).value();
  const auto* data = reinterpret_cast<const std::uint8_t*>(image.data.get());
  return {data, data + image.size};
}

std::vector<Bytes> Seeds() {
  Blob small, large;
  small.PutScalar<double>("x_m", 1);
  for (int i = 0; i < 20; ++i) {
    const std::string robot = "robot/" + std::to_string(i) + "/";
    large.PutVector<double>(robot + "time_s", std::vector<double>(static_cast<std::size_t>(i), 0.1));
    large.Put(robot + "name", Array::Texts({"a", "Grüße"}));
    large.Put(robot + "grid", Array::Of<float>({2, 3}, std::vector<float>(6, 0.5F)));
  }
  large.PutVector<std::uint8_t>("zeros", std::vector<std::uint8_t>(70000));
  return {FileOf(small), FileOf(large)};
}

}  // namespace

Target BlobFileTarget() { return {"blob_file", Run, Seeds, 2000}; }

}  // namespace cairn::fuzz
