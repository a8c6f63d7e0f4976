#include "schema/wire/codec.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/message.h>
#include <google/protobuf/stubs/logging.h>
#include <google/protobuf/wire_format_lite.h>

#include <utility>

#include "schema/flat_blob.h"

namespace cairn::wire {
namespace {

using BlobMetas = google::protobuf::RepeatedPtrField<BlobMeta>;

// The metas of those bodies that carry a list of blobs; null for the others.
BlobMetas* MetaList(Envelope& envelope) {
  switch (envelope.body_case()) {
    case Envelope::kDone:
      return envelope.mutable_done()->mutable_blobs();
    case Envelope::kReply:
      return envelope.mutable_reply()->mutable_blobs();
    default:
      return nullptr;
  }
}

void WriteMetas(Message& message) {
  Envelope& envelope = message.envelope;
  if (envelope.body_case() == Envelope::kBlob) {
    CAIRN_DEMAND(message.blobs.size() == 1, "a BlobData carries one blob");
    *envelope.mutable_blob()->mutable_blob() = MetaOf(message.blobs[0]);
    return;
  }
  BlobMetas* list = MetaList(envelope);
  CAIRN_DEMAND(list != nullptr || message.blobs.empty(), "this kind of message carries no blobs");
  if (list == nullptr) return;
  list->Clear();
  for (const NamedBlob& named : message.blobs) *list->Add() = MetaOf(named);
}

std::vector<const BlobMeta*> ListMetas(Envelope& envelope) {
  std::vector<const BlobMeta*> metas;
  if (envelope.body_case() == Envelope::kBlob) {
    metas.push_back(&envelope.blob().blob());
  } else if (const BlobMetas* list = MetaList(envelope)) {
    for (const BlobMeta& meta : *list) metas.push_back(&meta);
  }
  return metas;
}

Status Corrupt(const std::string& why) { return {Code::kCorrupt, "malformed message: " + why}; }
Status OverLimit(const std::string& limit) {
  return {Code::kRefused, "a message over the limit of " + limit};
}

// Of a message without fields.
std::size_t EmptyBytes(const google::protobuf::Descriptor& type) {
  constexpr std::size_t kMapEntry = 128;
  if (type.options().map_entry()) return kMapEntry;
  const auto* message = google::protobuf::MessageFactory::generated_factory()->GetPrototype(&type);
  return message == nullptr ? kMapEntry : message->SpaceUsedLong();
}

// Takes from `left` about what the fields of a message in `in` take in memory once they are parsed, and says
// whether there was so much: two bytes may stand for an empty message of hundreds.
bool TakeParsedBytes(const google::protobuf::Descriptor& type, google::protobuf::io::CodedInputStream* in,
                     int depth, std::size_t* left) {
  using google::protobuf::internal::WireFormatLite;
  constexpr std::size_t kPointerAndText = 48;
  constexpr int kDeepest = 100;
  const auto take = [left](std::size_t bytes) {
    if (bytes > *left) return false;
    *left -= bytes;
    return true;
  };
  while (const std::uint32_t tag = in->ReadTag()) {
    const auto* field = type.FindFieldByNumber(WireFormatLite::GetTagFieldNumber(tag));
    std::uint32_t length = 0;
    if (WireFormatLite::GetTagWireType(tag) != WireFormatLite::WIRETYPE_LENGTH_DELIMITED) {
      if (!take(sizeof(std::uint64_t)) || !WireFormatLite::SkipField(in, tag)) return false;
      continue;
    }
    if (!in->ReadVarint32(&length) || !take(kPointerAndText)) return false;
    if (field == nullptr || field->message_type() == nullptr) {
      // Of packed numbers each byte may be one.
      const std::size_t most = field != nullptr && field->is_packable() ? sizeof(std::uint64_t) : 1;
      if (!take(most * length) || !in->Skip(static_cast<int>(length))) return false;
      continue;
    }
    const google::protobuf::Descriptor& of = *field->message_type();
    if (depth == kDeepest || !take(EmptyBytes(of))) return false;
    const auto limit = in->PushLimit(static_cast<int>(length));
    if (!TakeParsedBytes(of, in, depth + 1, left) || in->BytesUntilLimit() != 0) return false;
    in->PopLimit(limit);
  }
  return true;
}

// Only what a task has computed may be large.
bool IsDone(std::span<const std::byte> envelope) {
  using google::protobuf::internal::WireFormatLite;
  google::protobuf::io::CodedInputStream in(reinterpret_cast<const std::uint8_t*>(envelope.data()),
                                            static_cast<int>(envelope.size()));
  bool is_done = true;
  while (const std::uint32_t tag = in.ReadTag())
    is_done = WireFormatLite::SkipField(&in, tag) &&
              WireFormatLite::GetTagFieldNumber(tag) == Envelope::kDoneFieldNumber && is_done;
  return is_done;
}

// False also of what cannot be parsed.
bool IsSmallOnceParsed(std::span<const std::byte> envelope, std::size_t most) {
  google::protobuf::io::CodedInputStream in(reinterpret_cast<const std::uint8_t*>(envelope.data()),
                                            static_cast<int>(envelope.size()));
  return TakeParsedBytes(*Envelope::descriptor(), &in, 0, &most) && in.ConsumedEntireMessage();
}

Status CheckSizes(std::span<const std::span<const std::byte>> frames, const Limits& limits) {
  if (frames.empty()) return Corrupt("no envelope");
  if (frames.size() > limits.frames) return OverLimit(std::to_string(limits.frames) + " frames");
  if (frames[0].size() > limits.envelope_bytes)
    return OverLimit(std::to_string(limits.envelope_bytes) + " bytes of an envelope");
  std::size_t left = limits.message_bytes;
  for (const auto& frame : frames) {
    if (frame.size() > left) return OverLimit(std::to_string(limits.message_bytes) + " bytes");
    left -= frame.size();
  }
  return Status::Ok();
}

}  // namespace

NamedBlob NameBlob(BlobPtr blob) {
  const Hash hash = blob->ContentHash();
  return {hash, std::move(blob)};
}

BlobMeta MetaOf(const NamedBlob& named) { return cairn::MetaOf(named.hash, *named.blob); }

Result<NamedBlob> DecodeBlob(const BlobMeta& meta, std::span<const std::span<const std::byte>> frames,
                             const std::shared_ptr<const void>& owner, bool forms_too) {
  CAIRN_DEMAND(frames.size() == static_cast<std::size_t>(meta.arrays_size()), "a frame an array");
  const Result<Hash> hash = Hash::FromBinary(meta.hash());
  if (!hash.ok()) return Corrupt(hash.status().message());
  Blob::Fields fields;
  for (int i = 0; i < meta.arrays_size(); ++i) {
    const ArrayMeta& a = meta.arrays(i);
    // Strictly ascending: a name given twice would shadow the first, and the hash runs in this order.
    if (i > 0 && a.name() <= meta.arrays(i - 1).name()) return Corrupt("array names out of order");
    if (a.type() > static_cast<std::uint32_t>(DType::kText)) return Corrupt("an array of an unknown type");
    const auto type = static_cast<DType>(a.type());
    const Shape shape(a.shape().begin(), a.shape().end());
    if (a.form_alone() && !(forms_too && frames[i].empty())) return Corrupt("an array without its elements");
    Result<Array> array = a.form_alone()     ? Array::FormAlone(type, a.item_bytes(), shape)
                          : owner == nullptr ? Array::FromBytes(type, a.item_bytes(), shape, frames[i])
                                             : Array::Over(type, a.item_bytes(), shape, frames[i], owner);
    if (!array.ok()) return Corrupt("'" + a.name() + "': " + array.status().message());
    fields.emplace(a.name(), std::move(array).value());
  }
  NamedBlob named = NameBlob(std::make_shared<const Blob>(std::move(fields)));
  if (named.hash != hash.value())
    return Corrupt("a blob's bytes do not match its hash " + hash.value().Hex());
  return named;
}

Frames Encode(Message message) {
  WriteMetas(message);
  Frames frames;
  frames.envelope = message.envelope.SerializeAsString();
  for (const NamedBlob& named : message.blobs) {
    for (const auto& [name, array] : named.blob->fields()) frames.arrays.push_back(array);
  }
  return frames;
}

Result<Message> Decode(std::span<const std::span<const std::byte>> frames, const Limits& limits) {
  if (Status sizes = CheckSizes(frames, limits); !sizes.ok()) return sizes;
  Message message;
  const bool must_look = frames[0].size() > limits.parsed_bytes / 8 / kMostParsedBytesOfOne;
  const std::size_t most = must_look && IsDone(frames[0]) ? limits.parsed_bytes : limits.parsed_bytes / 8;
  if (must_look && !IsSmallOnceParsed(frames[0], most))
    return Corrupt("the envelope cannot be parsed, or takes more than " + std::to_string(most) +
                   " bytes in memory");
  const google::protobuf::LogSilencer quiet;  // a peer must not fill our log with protobuf's complaints
  if (!message.envelope.ParseFromArray(frames[0].data(), static_cast<int>(frames[0].size()))) {
    return Corrupt("the envelope cannot be parsed");
  }
  if (message.envelope.body_case() == Envelope::BODY_NOT_SET) {
    return Status(Code::kVersion, "a message of an unknown kind: the peer's version differs");
  }
  std::span<const std::span<const std::byte>> rest = frames.subspan(1);
  const bool forms_too = !message.envelope.blob().part().but().empty();
  for (const BlobMeta* meta : ListMetas(message.envelope)) {
    const auto count = static_cast<std::size_t>(meta->arrays_size());
    if (count > rest.size()) return Corrupt("fewer frames than arrays announced");
    Result<NamedBlob> blob = DecodeBlob(*meta, rest.first(count), nullptr, forms_too);
    if (!blob.ok()) return blob.status();
    message.blobs.push_back(std::move(blob).value());
    rest = rest.subspan(count);
  }
  if (!rest.empty()) return Corrupt("more frames than arrays announced");
  return message;
}

const char* KindName(const Envelope& envelope) {
  const auto* field = Envelope::descriptor()->FindFieldByNumber(static_cast<int>(envelope.body_case()));
  return field == nullptr ? "nothing" : field->name().c_str();
}

}  // namespace cairn::wire
