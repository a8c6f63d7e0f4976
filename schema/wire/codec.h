// Envelope and blobs <-> the frames of one message: an Envelope, then the raw bytes of each array, a frame an
// array. No sockets in here. Decoding trusts nothing: number of frames, each length, the order of names,
// total size and content hash are checked before anyone sees a blob.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/wire.pb.h"
#include "schema/wire/limits.h"

namespace cairn::wire {

// Hello.protocol, Submit.protocol. Raised when an old peer could no longer make sense of what a new one says.
inline constexpr std::uint32_t kProtocol = 3;

// A blob with its content hash, so that nobody hashes the same bytes twice.
struct NamedBlob {
  Hash hash;
  BlobPtr blob;
};
NamedBlob NameBlob(BlobPtr blob);  // costs one pass over the bytes

// A blob apart: what is announced of it, and the bytes of its arrays.
BlobMeta MetaOf(const NamedBlob& named);
// Of as many frames as `meta` has arrays; kCorrupt as Decode below. Copies, or, where `owner` is not null,
// shares the bytes, as Array::Over says. `forms_too`: arrays may come without their elements.
Result<NamedBlob> DecodeBlob(const BlobMeta& meta, std::span<const std::span<const std::byte>> frames,
                             const std::shared_ptr<const void>& owner = nullptr, bool forms_too = false);

// What is sent and received. Encode writes the envelope's BlobMetas from `blobs`; those of a received one
// agree.
struct Message {
  Envelope envelope;
  std::vector<NamedBlob> blobs;  // of Done, BlobData (exactly one) or Reply; else empty
};

// A message as it travels. The arrays share the memory of the blobs that they came from.
struct Frames {
  std::string envelope;
  std::vector<Array> arrays;
};

Frames Encode(Message message);

// What one byte of an envelope may take in memory once it is parsed, at most: two are an empty message.
inline constexpr std::size_t kMostParsedBytesOfOne = 512;

// kCorrupt: truncated, a frame too many or too few, bytes that do not match their hash. kRefused: over a
// limit. kVersion: an envelope that holds no kind of message known here.
Result<Message> Decode(std::span<const std::span<const std::byte>> frames, const Limits& limits = {});

// One line for logs: "done", "blob", …
const char* KindName(const Envelope& envelope);

}  // namespace cairn::wire
