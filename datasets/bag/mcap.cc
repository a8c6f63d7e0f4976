// MCAP (mcap.dev/spec): records of an opcode, a length in eight bytes and contents; messages by themselves or
// in chunks; behind them, where the writer came to an end, a summary: channels, and where each chunk lies.
#include <zlib.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <utility>

#include "datasets/bag/container.h"
#include "datasets/bag/unpack.h"
#include "datasets/bag/window_file.h"
#include "datasets/common/mcap_format.h"

namespace cairn::datasets::bag {
namespace {

constexpr std::uint64_t kRecordHead = 9, kMessageHead = 2 + 4 + 8 + 8, kFooterBytes = 20, kDataEndBytes = 4;

// Of what follows bytes whose CRC-32 is `before`.
std::uint32_t McapChecksum(std::uint32_t before, ByteSpan bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

struct Schema {
  std::string_view name, text;  // that are kept; of another encoding than ROS has no text
};

struct McapChunk {
  std::uint64_t at = 0;
  std::vector<std::uint16_t> channels;  // empty: not said
};

class Mcap : public Container {
 public:
  explicit Mcap(const std::string& path) : Container(path), file_(path) {
    if (AsText(file_.View(0, std::min<std::uint64_t>(kMcapMagic.size(), file_.size()))) != kMcapMagic)
      throw Damage{"an MCAP file of another version than 0"};
    if (ReadSummary()) return;
    ForgetChannels();
    schemas_.clear();
    ids_.clear();
    chunks_.clear();
    remarks_.emplace_back("it has no summary, or no index (the recorder was cut off?): read as a whole");
    Walk([](const Message&) {}, [](const std::string&) {}, true);
  }

  std::string what() const override { return "an MCAP file"; }

  void ReadMessages(const std::vector<bool>& wanted, const Take& take, const Broken& broken) override {
    wanted_ = &wanted;
    Walk(take, broken, false);
  }

 private:
  struct Record {
    std::uint8_t op = 0;
    std::uint64_t at = 0, bytes = 0, end = 0;
  };
  Record RecordAt(std::uint64_t at) {
    ByteReader in(file_.View(at, kRecordHead), "a record");
    Record record;
    record.op = in.Take<std::uint8_t>();
    record.bytes = in.Take<std::uint64_t>();
    record.at = at + kRecordHead;
    if (record.bytes > file_.size() - record.at) throw Damage{"the file ends within it"};
    record.end = record.at + record.bytes;
    return record;
  }

  // False where there is none, or it does not say all that is needed.
  bool ReadSummary() {
    constexpr std::uint64_t kTail = kRecordHead + kFooterBytes + 8;
    try {
      if (file_.size() < kMcapMagic.size() + kTail) return false;
      if (AsText(file_.View(file_.size() - 8, 8)) != kMcapMagic) return false;
      const std::uint64_t footer_at = file_.size() - kTail;
      const Record footer = RecordAt(footer_at);
      if (footer.op != kMcapFooter || footer.bytes != kFooterBytes) return false;
      ByteReader in(file_.View(footer.at, footer.bytes), "the footer");
      const auto summary_at = in.Take<std::uint64_t>();
      in.Bytes(8);                                     // where a table of the summary's records is
      const auto checksum = in.Take<std::uint32_t>();  // of all before it, from the summary on; 0: none
      if (summary_at < kMcapMagic.size() || summary_at >= footer_at) return false;
      if (checksum != 0 && checksum != ChecksumOf(summary_at, footer.end - 4 - summary_at)) return false;
      for (std::uint64_t at = summary_at; at < footer_at;) {
        const Record record = RecordAt(at);
        at = record.end;
        ReadSummaryRecord(record);
      }
    } catch (const Damage&) {
      return false;
    }
    std::ranges::sort(chunks_, {}, &McapChunk::at);
    const bool repeated = std::ranges::adjacent_find(chunks_, {}, &McapChunk::at) != chunks_.end();
    return !repeated && has_statistics_ && chunks_.size() == chunk_count_ &&
           message_counts_ == message_count_;
  }

  void ReadSummaryRecord(const Record& record) {
    switch (record.op) {
      case kMcapSchema:
      case kMcapChannel:
        ReadDefinition(record.op, file_.View(record.at, record.bytes));
        break;
      case kMcapChunkIndex: {
        ByteReader in(file_.View(record.at, record.bytes), "a chunk's index");
        in.Bytes(16);  // its first and last time
        McapChunk chunk{in.Take<std::uint64_t>(), {}};
        in.Bytes(8);
        for (ByteReader offsets(in.Block(), "a chunk's index"); offsets.left() > 0; offsets.Bytes(8))
          chunk.channels.push_back(offsets.Take<std::uint16_t>());
        chunks_.push_back(std::move(chunk));
        break;
      }
      case kMcapStatistics:
        ReadStatistics(file_.View(record.at, record.bytes));
        break;
      default:
        break;
    }
  }

  void ReadStatistics(ByteSpan bytes) {
    ByteReader in(bytes, "the statistics");
    message_count_ = in.Take<std::uint64_t>();
    in.Bytes(2 + 4 + 4 + 4);  // schemas, channels, attachments, metadata
    chunk_count_ = in.Take<std::uint32_t>();
    const auto first = in.Take<std::int64_t>();
    Cover(first, in.Take<std::int64_t>());
    for (ByteReader counts(in.Block(), "the statistics"); counts.left() > 0;) {
      const auto id = counts.Take<std::uint16_t>();
      const auto messages = counts.Take<std::uint64_t>();
      const auto channel = ids_.find(id);
      if (channel == ids_.end()) throw Damage{"statistics of a channel that is not there"};
      Count(channel->second, messages);
      message_counts_ += messages;
    }
    has_statistics_ = true;
  }

  void ReadDefinition(std::uint8_t op, ByteSpan bytes) {
    ByteReader in(bytes, op == kMcapSchema ? "a schema" : "a channel");
    const auto id = in.Take<std::uint16_t>();
    if (op == kMcapSchema) {
      Schema& schema = schemas_[id];
      schema.name = Keep(AsText(in.Block()));
      const std::string_view encoding = AsText(in.Block()), text = AsText(in.Block());
      schema.text = encoding == "ros1msg" || encoding == "ros2msg" ? Keep(text) : std::string_view();
      return;
    }
    if (ids_.contains(id)) return;
    const auto schema = schemas_.find(in.Take<std::uint16_t>());
    Channel channel;
    channel.topic = in.Text();
    channel.encoding = in.Text();
    channel.wire = channel.encoding == "cdr"    ? Wire::kCdr
                   : channel.encoding == "ros1" ? Wire::kRos1
                                                : Wire::kOther;
    if (schema != schemas_.end()) {
      channel.type = TypeName(std::string(schema->second.name));
      channel.definition = schema->second.text;
    }
    ids_[id] = FindOrAdd(std::move(channel));
  }

  // All records before the summary. Chunks that the index says hold nothing wanted are leapt over; where it
  // says that one begins, reading goes on behind what is damaged.
  void Walk(const Take& take, const Broken& broken, bool count) {
    counts_ = count;
    auto chunk = chunks_.begin();  // the first of the index that does not begin before `at`
    for (std::uint64_t at = kMcapMagic.size(); at < file_.size();) {
      const bool is_chunk = chunk != chunks_.end() && chunk->at == at;
      const auto behind = is_chunk ? std::next(chunk) : chunk;
      std::uint64_t next = behind == chunks_.end() ? file_.size() : behind->at;
      try {
        const Record record = RecordAt(at);
        if (is_chunk && record.op != kMcapChunk) throw Damage{"no chunk, where the index says that one is"};
        if (record.end > next) throw Damage{"it reaches into the next chunk of the index"};
        const bool is_end = record.op == kMcapDataEnd || record.op == kMcapFooter;
        if (is_end && behind == chunks_.end() &&
            record.bytes == (record.op == kMcapFooter ? kFooterBytes : kDataEndBytes))
          break;
        next = record.end;
        if (is_end) throw Damage{"an end of the messages, where there are more"};
        if (!is_chunk || IsWanted(*chunk)) ReadRecord(record, take);
      } catch (const Damage& damage) {
        broken("byte " + std::to_string(at) + ": " + damage.what);
      }
      at = next;
      if (is_chunk) ++chunk;
    }
    counts_ = false;
  }

  bool IsWanted(const McapChunk& chunk) const {
    return chunk.channels.empty() || std::ranges::any_of(chunk.channels, [&](std::uint16_t id) {
             const auto channel = ids_.find(id);
             return channel == ids_.end() || (*wanted_)[channel->second];
           });
  }

  void ReadRecord(const Record& record, const Take& take) {
    if (record.op == kMcapChunk)
      ReadChunk(record, take);
    else if (record.op == kMcapMessage)
      TakeMessage(
          file_.View(record.at, std::min(record.bytes, kMessageHead)),
          [&] { return file_.View(record.at, record.bytes).subspan(kMessageHead); }, take);
    else if (record.op == kMcapSchema || record.op == kMcapChannel)
      ReadDefinition(record.op, file_.View(record.at, record.bytes));
  }

  void ReadChunk(const Record& chunk, const Take& take) {
    constexpr std::uint64_t kMostHead = 256;
    const ByteSpan bytes = file_.View(chunk.at, std::min(chunk.bytes, kMostHead));
    ByteReader head(bytes, "a chunk");
    head.Bytes(16);  // its first and last time
    const auto size = head.Take<std::uint64_t>();
    const auto checksum = head.Take<std::uint32_t>();  // of what is packed; 0: none
    const std::string how = head.Text();
    const auto packed_bytes = head.Take<std::uint64_t>();
    const std::uint64_t begin = chunk.at + (bytes.size() - head.left());
    if (packed_bytes > chunk.end - begin) throw Damage{"cut short: a chunk"};
    if (IsPlain(how)) {
      if (checksum != 0) CheckChunk(checksum, ChecksumOf(begin, packed_bytes));
      return ReadPlainChunk(begin, begin + packed_bytes, take);
    }
    const ByteSpan records = unpacker_.Unpack(how, file_.View(begin, packed_bytes), size);
    if (checksum != 0) CheckChunk(checksum, McapChecksum(0, records));
    for (ByteReader in(records, "a record of a chunk"); in.left() > 0;) {
      const auto op = in.Take<std::uint8_t>();
      const ByteSpan record = in.Bytes(in.Take<std::uint64_t>());
      if (op == kMcapMessage)
        TakeMessage(record, [&] { return record.subspan(kMessageHead); }, take);
      else if (op == kMcapSchema || op == kMcapChannel)
        ReadDefinition(op, record);
    }
  }

  static void CheckChunk(std::uint32_t said, std::uint32_t is) {
    if (said != is)
      throw Damage{
          "a chunk whose checksum (CRC-32) is another: it is not as it was recorded; copy the file again"};
  }

  // In pieces, of which a chunk as recorders make them is one, so that it is read once.
  std::uint32_t ChecksumOf(std::uint64_t at, std::uint64_t bytes) {
    constexpr std::uint64_t kPiece = 1 << 22;
    std::uint32_t checksum = 0;
    for (const std::uint64_t end = at + bytes; at < end; at += std::min(kPiece, end - at))
      checksum = McapChecksum(checksum, file_.View(at, std::min(kPiece, end - at)));
    return checksum;
  }

  // Of messages that are not wanted no more than the heads.
  void ReadPlainChunk(std::uint64_t at, std::uint64_t end, const Take& take) {
    while (at < end) {
      const Record record = RecordAt(at);
      if (record.end > end) throw Damage{"cut short: a record of a chunk"};
      if (record.op != kMcapChunk) ReadRecord(record, take);
      at = record.end;
    }
  }

  template <class Bytes>
  void TakeMessage(ByteSpan head, const Bytes& bytes, const Take& take) {
    ByteReader in(head, "a message");
    const auto channel = ids_.find(in.Take<std::uint16_t>());
    if (channel == ids_.end()) throw Damage{"a message of a channel that is not there"};
    in.Bytes(4);  // its number
    const auto time_ns = in.Take<std::int64_t>();
    in.Bytes(8);  // when it was sent
    if (counts_) {
      Count(channel->second, 1);
      Cover(time_ns, time_ns);
    } else if (channel->second < wanted_->size() && (*wanted_)[channel->second]) {
      take({channel->second, 0, time_ns, bytes()});
    } else if (channel->second >= wanted_->size()) {
      throw Damage{"a message of a channel that the summary does not name"};
    }
  }

  WindowFile file_;
  Unpacker unpacker_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, std::size_t> ids_;  // their channels
  std::vector<McapChunk> chunks_;
  std::uint64_t message_count_ = 0, message_counts_ = 0, chunk_count_ = 0;
  bool has_statistics_ = false, counts_ = false;
  const std::vector<bool>* wanted_ = nullptr;
};

}  // namespace

std::unique_ptr<Container> OpenMcap(const std::string& path) { return std::make_unique<Mcap>(path); }

}  // namespace cairn::datasets::bag
