#include "schema/wire/codec.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/message.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "schema/blob_part.h"

namespace cairn::wire {
namespace {

using RawFrames = std::vector<std::vector<std::byte>>;

NamedBlob SmallBlob(double first) {
  Blob blob;
  blob.PutVector<double>("a/x_m", {first, 2, 3});
  blob.PutScalar<std::int32_t>("b", 7);
  blob.Put("c", Array::Of<float>({2, 0, 3}, std::vector<float>{}));
  blob.Put("names", Array::Texts({"one", "three"}));
  return NameBlob(std::make_shared<const Blob>(std::move(blob)));
}

Message TwoBlobs() {
  Message message;
  Done& done = *message.envelope.mutable_done();
  done.mutable_key()->set_job("museum");
  done.mutable_key()->set_task(3);
  done.set_seconds(1.5);
  message.blobs = {SmallBlob(1), SmallBlob(-1)};
  return message;
}

RawFrames Raw(const Frames& frames) {
  const auto copy = [](std::span<const std::byte> bytes) { return std::vector(bytes.begin(), bytes.end()); };
  RawFrames raw = {copy(std::as_bytes(std::span(frames.envelope)))};
  for (const Array& array : frames.arrays) raw.push_back(copy(array.bytes()));
  return raw;
}

Result<Message> DecodeRaw(const RawFrames& raw, const Limits& limits = {}) {
  const std::vector<std::span<const std::byte>> views(raw.begin(), raw.end());
  return Decode(views, limits);
}

// The frames of a BlobData whose announcement `change` has tampered with.
template <class Change>
RawFrames Tampered(const Change& change) {
  Message message;
  message.envelope.mutable_blob();
  message.blobs = {SmallBlob(1)};
  Frames frames = Encode(message);
  Envelope envelope;
  EXPECT_TRUE(envelope.ParseFromString(frames.envelope));
  change(*envelope.mutable_blob()->mutable_blob());
  frames.envelope = envelope.SerializeAsString();
  return Raw(frames);
}

TEST(Codec, RoundTripKeepsEnvelopeAndBlobs) {
  const Result<Message> back = DecodeRaw(Raw(Encode(TwoBlobs())));
  ASSERT_TRUE(back.ok()) << back.status().message();
  EXPECT_EQ(back.value().envelope.SerializeAsString(), Encode(TwoBlobs()).envelope);
  ASSERT_EQ(back.value().blobs.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(back.value().blobs[i].hash, TwoBlobs().blobs[i].hash);
    EXPECT_EQ(back.value().blobs[i].blob->fields(), TwoBlobs().blobs[i].blob->fields());
  }
}

Message Head() {
  Message message;
  message.envelope.mutable_blob()->set_of(SmallBlob(1).hash.Binary());
  *message.envelope.mutable_blob()->mutable_part() = HeadPart("x_m");
  message.blobs = {NameBlob(CutPart(*SmallBlob(1).blob, HeadPart("x_m")).value())};
  return message;
}

TEST(Codec, OfAHeadAnArrayComesWithoutItsElements) {
  const RawFrames raw = Raw(Encode(Head()));
  const Result<Message> back = DecodeRaw(raw);
  ASSERT_TRUE(back.ok()) << back.status().message();
  EXPECT_EQ(back.value().blobs[0].blob->fields(), Head().blobs[0].blob->fields());
  EXPECT_TRUE(back.value().blobs[0].blob->at("a/x_m").is_form_alone());
  RawFrames more = raw;
  more[1].resize(24);
  EXPECT_EQ(DecodeRaw(more).status().code(), Code::kCorrupt) << "and with them";
}

TEST(Codec, NothingButAHeadHasArraysWithoutTheirElements) {
  Message done;
  done.envelope.mutable_done();
  done.blobs = Head().blobs;
  EXPECT_EQ(DecodeRaw(Raw(Encode(done))).status().code(), Code::kCorrupt);
  for (const proto::BlobPart& part : {proto::BlobPart(), RowsPart("a/x_m", 0, 3)}) {
    Message data = Head();
    *data.envelope.mutable_blob()->mutable_part() = part;
    EXPECT_EQ(DecodeRaw(Raw(Encode(data))).status().code(), Code::kCorrupt);
  }
  EXPECT_EQ(DecodeRaw(Tampered([](BlobMeta& meta) { meta.mutable_arrays(0)->set_form_alone(true); }))
                .status()
                .code(),
            Code::kCorrupt);
}

TEST(Codec, DecodedArraysAreAligned) {
  const Result<Message> back = DecodeRaw(Raw(Encode(TwoBlobs())));
  ASSERT_TRUE(back.ok());
  for (const auto& [name, array] : back.value().blobs[0].blob->fields()) {
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.bytes().data()) % 64, 0u) << name;
  }
}

TEST(Codec, EveryKindOfMessageSurvives) {
  const google::protobuf::Descriptor* type = Envelope::descriptor();
  ASSERT_GE(type->field_count(), 16);
  for (int i = 0; i < type->field_count(); ++i) {
    Message message;
    const google::protobuf::Reflection* reflection = message.envelope.GetReflection();
    reflection->MutableMessage(&message.envelope, type->field(i));
    if (message.envelope.has_blob()) message.blobs = {SmallBlob(1)};
    const Result<Message> back = DecodeRaw(Raw(Encode(message)));
    ASSERT_TRUE(back.ok()) << type->field(i)->name() << ": " << back.status().message();
    EXPECT_EQ(back.value().envelope.body_case(), message.envelope.body_case());
    EXPECT_EQ(KindName(back.value().envelope), type->field(i)->name());
  }
}

TEST(Codec, RefusesTruncationAtEveryByteOfEveryFrame) {
  const RawFrames whole = Raw(Encode(TwoBlobs()));
  for (std::size_t frame = 0; frame < whole.size(); ++frame) {
    for (std::size_t length = 0; length < whole[frame].size(); ++length) {
      RawFrames cut = whole;
      cut[frame].resize(length);
      EXPECT_FALSE(DecodeRaw(cut).ok()) << "frame " << frame << " cut to " << length;
    }
  }
}

TEST(Codec, RefusesAFlippedBitInAnyArray) {
  const RawFrames whole = Raw(Encode(TwoBlobs()));
  for (std::size_t frame = 1; frame < whole.size(); ++frame) {
    for (std::size_t bit = 0; bit < 8 * whole[frame].size(); ++bit) {
      RawFrames flipped = whole;
      flipped[frame][bit / 8] ^= std::byte{1} << (bit % 8);
      const Result<Message> back = DecodeRaw(flipped);
      ASSERT_FALSE(back.ok());
      EXPECT_EQ(back.status().code(), Code::kCorrupt);
    }
  }
}

// A flip in the envelope may give another valid envelope; what it announces must still hash to what it says.
TEST(Codec, AFlippedBitInTheEnvelopeNeverGivesAWrongBlob) {
  const RawFrames whole = Raw(Encode(TwoBlobs()));
  int refused = 0;
  for (std::size_t bit = 0; bit < 8 * whole[0].size(); ++bit) {
    RawFrames flipped = whole;
    flipped[0][bit / 8] ^= std::byte{1} << (bit % 8);
    const Result<Message> back = DecodeRaw(flipped);
    if (!back.ok()) {
      ++refused;
      continue;
    }
    for (const NamedBlob& named : back.value().blobs) EXPECT_EQ(named.blob->ContentHash(), named.hash);
  }
  EXPECT_GT(refused, 1000);
}

TEST(Codec, RefusesMissingExtraAndSwappedFrames) {
  const RawFrames whole = Raw(Encode(TwoBlobs()));
  for (std::size_t frame = 0; frame < whole.size(); ++frame) {
    RawFrames less = whole;
    less.erase(less.begin() + static_cast<std::ptrdiff_t>(frame));
    EXPECT_FALSE(DecodeRaw(less).ok()) << "without frame " << frame;
    RawFrames more = whole;
    more.insert(more.begin() + static_cast<std::ptrdiff_t>(frame) + 1, {std::byte{0}});
    EXPECT_FALSE(DecodeRaw(more).ok()) << "one more after frame " << frame;
  }
  RawFrames swapped = whole;
  std::swap(swapped[1], swapped[5]);
  EXPECT_FALSE(DecodeRaw(swapped).ok());
  EXPECT_FALSE(DecodeRaw({}).ok());
}

TEST(Codec, RefusesWhatABlobMayNotAnnounce) {
  EXPECT_TRUE(DecodeRaw(Tampered([](BlobMeta&) {})).ok());
  EXPECT_FALSE(DecodeRaw(Tampered([](BlobMeta& m) { m.set_hash("short"); })).ok());
  EXPECT_FALSE(DecodeRaw(Tampered([](BlobMeta& m) { m.mutable_arrays(0)->set_type(0); })).ok());
  // Would be a type again if it were cut to eight bits.
  EXPECT_FALSE(DecodeRaw(Tampered([](BlobMeta& m) { m.mutable_arrays(0)->set_type(256 + 5); })).ok());
  EXPECT_FALSE(DecodeRaw(Tampered([](BlobMeta& m) { m.mutable_arrays(0)->set_item_bytes(0); })).ok());
  EXPECT_FALSE(DecodeRaw(Tampered([](BlobMeta& m) { m.mutable_arrays(0)->set_shape(0, -3); })).ok());
  EXPECT_FALSE(DecodeRaw(Tampered([](BlobMeta& m) { m.mutable_arrays(0)->add_shape(INT64_MAX); })).ok());
  EXPECT_FALSE(DecodeRaw(Tampered([](BlobMeta& m) { m.mutable_arrays(1)->set_name("a/x_m"); })).ok());
  EXPECT_FALSE(DecodeRaw(Tampered([](BlobMeta& m) { m.mutable_arrays(0)->set_name("z"); })).ok());
}

TEST(Codec, RefusesWhatIsOverALimit) {
  const RawFrames whole = Raw(Encode(TwoBlobs()));
  std::size_t total = 0;
  for (const auto& frame : whole) total += frame.size();
  EXPECT_TRUE(DecodeRaw(whole, {.envelope_bytes = whole[0].size(), .message_bytes = total}).ok());
  EXPECT_FALSE(DecodeRaw(whole, {.envelope_bytes = whole[0].size() - 1, .message_bytes = total}).ok());
  EXPECT_FALSE(DecodeRaw(whole, {.envelope_bytes = whole[0].size(), .message_bytes = total - 1}).ok());
}

// Two bytes are an empty JobInfo, which takes hundreds once it is parsed.
TEST(Codec, RefusesWhatTakesMuchMoreMemoryThanItIsLong) {
  Message message;
  for (int i = 0; i < 1000; ++i) message.envelope.mutable_reply()->add_jobs();
  const RawFrames raw = Raw(Encode(message));
  ASSERT_LT(raw[0].size(), 2100U);
  EXPECT_TRUE(DecodeRaw(raw).ok());
  const std::size_t takes = message.envelope.SpaceUsedLong();
  EXPECT_TRUE(DecodeRaw(raw, {.parsed_bytes = 16 * takes}).ok());
  EXPECT_FALSE(DecodeRaw(raw, {.parsed_bytes = 4 * takes}).ok());
  // So with texts, and with what is known to nobody.
  Message texts;
  for (int i = 0; i < 1000; ++i) texts.envelope.mutable_have()->add_hashes();
  EXPECT_FALSE(DecodeRaw(Raw(Encode(texts)), {.parsed_bytes = 160'000}).ok());
  EXPECT_TRUE(DecodeRaw(Raw(Encode(texts)), {.parsed_bytes = 800'000}).ok());
}

// So a message that is short enough needs no look before it is parsed.
TEST(Codec, NoByteTakesMoreThanIsTakenOfEachOnceItIsParsed) {
  std::vector<const google::protobuf::Descriptor*> types = {Envelope::descriptor()};
  for (std::size_t i = 0; i < types.size(); ++i) {
    for (int k = 0; k < types[i]->field_count(); ++k) {
      const auto* type = types[i]->field(k)->message_type();
      if (type != nullptr && std::ranges::find(types, type) == types.end()) types.push_back(type);
    }
    if (types[i]->options().map_entry()) continue;
    const auto* message = google::protobuf::MessageFactory::generated_factory()->GetPrototype(types[i]);
    constexpr std::size_t kPointerAndAllocation = 48;
    EXPECT_LE(message->SpaceUsedLong() + kPointerAndAllocation, 2 * kMostParsedBytesOfOne)
        << types[i]->full_name() << " is two bytes where it is empty";
  }
  EXPECT_GT(types.size(), 30U);
}

TEST(Codec, AnUnknownKindIsAnotherVersion) {
  const Result<Message> empty = DecodeRaw({{}});
  ASSERT_FALSE(empty.ok());
  EXPECT_EQ(empty.status().code(), Code::kVersion);
  // Field 99, length 0.
  const Result<Message> later = DecodeRaw({{std::byte{0x9a}, std::byte{0x06}, std::byte{0}}});
  ASSERT_FALSE(later.ok());
  EXPECT_EQ(later.status().code(), Code::kVersion);
}

}  // namespace
}  // namespace cairn::wire
