#include "coordinator/store/blob_pack.h"

#include <span>
#include <utility>

namespace cairn::coordinator {
namespace {

void Append(std::vector<std::uint8_t>& bytes, std::span<const std::byte> frame) {
  const auto* begin = reinterpret_cast<const std::uint8_t*>(frame.data());
  bytes.insert(bytes.end(), begin, begin + frame.size());
}

Result<std::vector<wire::NamedBlob>> Unpack(const Blob& pack) {
  const auto bytes = std::as_bytes(pack.Get<std::uint8_t>("bytes"));
  const auto ends = pack.Get<std::int64_t>("frame_ends");
  const Status damaged(Code::kCorrupt, "a pack of blobs is damaged");
  std::vector<wire::NamedBlob> blobs;
  std::size_t frame = 0;
  std::int64_t begin = 0;
  for (const std::int64_t count : pack.Get<std::int64_t>("frames")) {
    if (count < 1 || static_cast<std::size_t>(count) > ends.size() - frame) return damaged;
    std::vector<std::span<const std::byte>> frames;
    for (std::int64_t i = 0; i < count; ++i) {
      const std::int64_t end = ends[frame++];
      if (end < begin || end > static_cast<std::int64_t>(bytes.size())) return damaged;
      frames.push_back(bytes.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin)));
      begin = end;
    }
    Result<wire::Message> message = wire::Decode(frames);
    if (!message.ok()) return message.status();
    if (message.value().blobs.size() != 1) return damaged;
    blobs.push_back(std::move(message.value().blobs[0]));
  }
  if (frame != ends.size() || begin != static_cast<std::int64_t>(bytes.size())) return damaged;
  return blobs;
}

}  // namespace

Blob PackBlobs(const std::vector<wire::NamedBlob>& blobs) {
  std::vector<std::uint8_t> bytes;
  std::vector<std::int64_t> frame_ends, counts;
  for (const wire::NamedBlob& blob : blobs) {
    wire::Message message;
    message.envelope.mutable_blob();
    message.blobs = {blob};
    const wire::Frames frames = wire::Encode(std::move(message));
    Append(bytes, std::as_bytes(std::span(frames.envelope)));
    frame_ends.push_back(static_cast<std::int64_t>(bytes.size()));
    for (const Array& array : frames.arrays) {
      Append(bytes, array.bytes());
      frame_ends.push_back(static_cast<std::int64_t>(bytes.size()));
    }
    counts.push_back(1 + static_cast<std::int64_t>(frames.arrays.size()));
  }
  Blob pack;
  pack.PutVector("bytes", bytes);
  pack.PutVector("frame_ends", frame_ends);
  pack.PutVector("frames", counts);
  return pack;
}

Result<std::vector<wire::NamedBlob>> UnpackBlobs(const Blob& pack) {
  try {
    return Unpack(pack);
  } catch (const InputError& error) {
    return Status(Code::kCorrupt, error.what());
  }
}

}  // namespace cairn::coordinator
