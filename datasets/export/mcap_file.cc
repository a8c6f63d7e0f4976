#include "datasets/export/mcap_file.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <set>

#include "datasets/common/mcap_format.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr std::size_t kChunkBytes = std::size_t{1} << 20;  // of records; a message may be longer

template <class T>
void Put(std::string* out, T value) {
  out->append(reinterpret_cast<const char*>(&value), sizeof value);
}

// A text, bytes or a list, after its length.
void PutBlock(std::string* out, std::string_view block) {
  Put(out, static_cast<std::uint32_t>(block.size()));
  *out += block;
}

template <class Key, class Value>
void PutMap(std::string* out, const std::map<Key, Value>& map) {
  std::string entries;
  for (const auto& [key, value] : map) {
    if constexpr (std::is_same_v<Key, std::string>) {
      PutBlock(&entries, key);
      PutBlock(&entries, value);
    } else {
      Put(&entries, key);
      Put(&entries, value);
    }
  }
  PutBlock(out, entries);
}

void PutRecord(std::string* out, McapOp op, std::string_view contents) {
  *out += static_cast<char>(op);
  Put(out, static_cast<std::uint64_t>(contents.size()));
  *out += contents;
}

std::uint32_t Crc(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string Packed(const std::string& records) {
  std::string packed(ZSTD_compressBound(records.size()), '\0');
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), records.data(), records.size(), 3);
  CAIRN_DEMAND(ZSTD_isError(size) == 0, "zstd cannot pack in memory");
  packed.resize(size);
  return packed;
}

// With what it includes before it, as readers need it.
void AddFile(const google::protobuf::FileDescriptor& file, std::set<std::string>* there,
             google::protobuf::FileDescriptorSet* files) {
  if (!there->insert(file.name()).second) return;
  for (int i = 0; i < file.dependency_count(); ++i) AddFile(*file.dependency(i), there, files);
  file.CopyTo(files->add_file());
}

// The records of a chunk, and where in them each channel's messages are.
class Chunk {
 public:
  explicit Chunk(std::string definitions) : records_(std::move(definitions)) {}
  void Add(std::uint16_t channel, std::uint64_t time_ns, std::string_view message) {
    first_ns_ = entries_.empty() ? time_ns : first_ns_;
    last_ns_ = time_ns;
    Put(&entries_[channel], time_ns);
    Put(&entries_[channel], static_cast<std::uint64_t>(records_.size()));
    PutRecord(&records_, kMcapMessage, message);
  }
  std::size_t size() const { return records_.size(); }

  // The chunk and its indexes; the record for the summary.
  std::string WriteTo(std::string* out) const {
    const std::uint64_t chunk_at = out->size();
    const std::string packed = Packed(records_);
    std::string span;
    Put(&span, first_ns_);
    Put(&span, last_ns_);
    std::string chunk = span;
    Put(&chunk, static_cast<std::uint64_t>(records_.size()));
    Put(&chunk, Crc(records_));
    PutBlock(&chunk, "zstd");
    Put(&chunk, static_cast<std::uint64_t>(packed.size()));
    PutRecord(out, kMcapChunk, chunk + packed);
    const std::uint64_t indexes_at = out->size();
    std::map<std::uint16_t, std::uint64_t> index_at;
    for (const auto& [channel, entries] : entries_) {
      index_at[channel] = out->size();
      std::string index;
      Put(&index, channel);
      PutBlock(&index, entries);
      PutRecord(out, kMcapMessageIndex, index);
    }
    std::string index = span;
    Put(&index, chunk_at);
    Put(&index, indexes_at - chunk_at);
    PutMap(&index, index_at);
    Put(&index, static_cast<std::uint64_t>(out->size()) - indexes_at);
    PutBlock(&index, "zstd");
    Put(&index, static_cast<std::uint64_t>(packed.size()));
    Put(&index, static_cast<std::uint64_t>(records_.size()));
    std::string record;
    PutRecord(&record, kMcapChunkIndex, index);
    return record;
  }

 private:
  std::string records_;
  std::uint64_t first_ns_ = 0, last_ns_ = 0;
  std::map<std::uint16_t, std::string> entries_;  // by channel: time and offset of each message
};

// Returns the records for the summary.
std::string PutMetadata(std::string* out,
                        const std::map<std::string, std::map<std::string, std::string>>& metadata) {
  std::string indexes;
  for (const auto& [name, facts] : metadata) {
    const std::uint64_t at = out->size();
    std::string record, index;
    PutBlock(&record, name);
    PutMap(&record, facts);
    PutRecord(out, kMcapMetadata, record);
    Put(&index, at);
    Put(&index, static_cast<std::uint64_t>(out->size()) - at);
    PutBlock(&index, name);
    PutRecord(&indexes, kMcapMetadataIndex, index);
  }
  return indexes;
}

// The summary, of records grouped by their opcode, and the end of the file. The checksum is of the summary
// and of the footer up to the checksum itself.
void PutSummary(std::string* out, std::string summary) {
  constexpr std::uint64_t kFooterBytes = 8 + 8 + 4;
  const std::uint64_t summary_at = out->size();
  summary += static_cast<char>(kMcapFooter);
  Put(&summary, kFooterBytes);
  Put(&summary, summary_at);
  Put(&summary, std::uint64_t{0});  // it is read whole: nothing says where its groups begin
  Put(&summary, Crc(summary));
  *out += summary;
  *out += kMcapMagic;
}

}  // namespace

std::uint16_t McapFile::SchemaOf(const google::protobuf::Descriptor& type) {
  const auto [known, is_new] =
      schema_ids_.try_emplace(type.full_name(), static_cast<std::uint16_t>(schema_ids_.size() + 1));
  if (!is_new) return known->second;
  google::protobuf::FileDescriptorSet files;
  std::set<std::string> there;
  AddFile(*type.file(), &there, &files);
  std::string schema;
  Put(&schema, known->second);
  PutBlock(&schema, type.full_name());
  PutBlock(&schema, "protobuf");
  PutBlock(&schema, files.SerializeAsString());
  PutRecord(&schema_records_, kMcapSchema, schema);
  return known->second;
}

void McapFile::Add(const std::string& topic, std::uint64_t time_ns,
                   const google::protobuf::Message& message) {
  const std::uint16_t schema = SchemaOf(*message.GetDescriptor());
  const auto [known, is_new] =
      channels_.try_emplace(topic, Channel{static_cast<std::uint16_t>(channels_.size() + 1), schema});
  Channel& channel = known->second;
  CAIRN_DEMAND(channel.schema == schema, "two types of messages on " + topic);
  if (is_new) {
    std::string record;
    Put(&record, channel.id);
    Put(&record, channel.schema);
    PutBlock(&record, topic);
    PutBlock(&record, "protobuf");
    PutMap(&record, std::map<std::string, std::string>());
    PutRecord(&channel_records_, kMcapChannel, record);
  }
  messages_.push_back({time_ns, channel.id, channel.messages++, message.SerializeAsString()});
}

std::string McapFile::Statistics(const std::vector<const Message*>& ordered, std::uint32_t chunks) const {
  std::string statistics, record;
  Put(&statistics, static_cast<std::uint64_t>(ordered.size()));
  Put(&statistics, static_cast<std::uint16_t>(schema_ids_.size()));
  Put(&statistics, static_cast<std::uint32_t>(channels_.size()));
  Put(&statistics, std::uint32_t{0});  // attachments
  Put(&statistics, static_cast<std::uint32_t>(metadata_.size()));
  Put(&statistics, chunks);
  Put(&statistics, ordered.empty() ? std::uint64_t{0} : ordered.front()->time_ns);
  Put(&statistics, ordered.empty() ? std::uint64_t{0} : ordered.back()->time_ns);
  std::map<std::uint16_t, std::uint64_t> counts;
  for (const auto& [topic, channel] : channels_) counts[channel.id] = channel.messages;
  PutMap(&statistics, counts);
  PutRecord(&record, kMcapStatistics, statistics);
  return record;
}

std::string McapFile::Bytes() const {
  std::vector<const Message*> ordered;
  for (const Message& message : messages_) ordered.push_back(&message);
  std::ranges::stable_sort(ordered, {}, &Message::time_ns);
  std::string out(kMcapMagic), header;
  PutBlock(&header, "");  // no profile
  PutBlock(&header, "cairn " CAIRN_VERSION);
  PutRecord(&out, kMcapHeader, header);

  std::string chunk_indexes;
  std::uint32_t chunks = 0;
  Chunk chunk(schema_records_ + channel_records_);
  for (const Message* message : ordered) {
    std::string record;
    Put(&record, message->channel);
    Put(&record, message->number);
    Put(&record, message->time_ns);
    Put(&record, message->time_ns);
    chunk.Add(message->channel, message->time_ns, record + message->bytes);
    if (chunk.size() < kChunkBytes && message != ordered.back()) continue;
    chunk_indexes += chunk.WriteTo(&out);
    chunk = Chunk("");
    ++chunks;
  }
  const std::string metadata_indexes = PutMetadata(&out, metadata_);
  std::string data_end;
  Put(&data_end, Crc(out));
  PutRecord(&out, kMcapDataEnd, data_end);
  PutSummary(&out, schema_records_ + channel_records_ + Statistics(ordered, chunks) + chunk_indexes +
                       metadata_indexes);
  return out;
}

}  // namespace cairn::datasets
