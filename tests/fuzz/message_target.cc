#include <algorithm>

#include "schema/wire/codec.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

std::vector<std::span<const std::byte>> CutIntoFrames(std::span<const std::byte> bytes) {
  std::vector<std::span<const std::byte>> frames;
  while (bytes.size() >= 2) {
    const std::size_t stated =
        std::to_integer<std::size_t>(bytes[0]) + 256 * std::to_integer<std::size_t>(bytes[1]);
    bytes = bytes.subspan(2);
    const std::size_t length = std::min(stated, bytes.size());
    frames.push_back(bytes.first(length));
    bytes = bytes.subspan(length);
  }
  return frames;
}

}  // namespace

Outcome FuzzMessage(std::span<const std::uint8_t> bytes) {
  const Result<wire::Message> read = wire::Decode(CutIntoFrames(std::as_bytes(bytes)));
  if (!read.ok()) return Outcome::kRefused;
  const wire::Frames frames = wire::Encode(read.value());
  std::vector<std::span<const std::byte>> views = {std::as_bytes(std::span(frames.envelope))};
  for (const Array& array : frames.arrays) views.push_back(array.bytes());
  const Result<wire::Message> again = wire::Decode(views);
  CAIRN_DEMAND(again.ok(), again.status().message());
  CAIRN_DEMAND(again.value().envelope.body_case() == read.value().envelope.body_case(),
               "the kind did not come back");
  CAIRN_DEMAND(again.value().blobs.size() == read.value().blobs.size(), "a blob did not come back");
  for (std::size_t i = 0; i < read.value().blobs.size(); ++i) {
    const wire::NamedBlob& named = again.value().blobs[i];
    CAIRN_DEMAND(named.hash == read.value().blobs[i].hash && named.blob->ContentHash() == named.hash,
                 "another blob came back");
  }
  return Outcome::kAccepted;
}

}  // namespace cairn::fuzz
