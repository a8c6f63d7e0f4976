// ROS 1 bags, version 2.0 (wiki.ros.org/Bags/Format/2.0): records of a header, which is fields NAME=value,
// and data, each after its length. Messages lie in chunks, the index behind them: connections, and for each
// chunk which connections it has messages of.
#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "datasets/bag/container.h"
#include "datasets/bag/unpack.h"
#include "datasets/bag/window_file.h"
#include "schema/error.h"
#include "schema/text.h"

namespace cairn::datasets::bag {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
enum Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7,
};
constexpr std::int64_t kSecond_ns = 1'000'000'000;

// Fields of a record's header; those of a connection too. There are few, and one is looked at once.
class RosFields {
 public:
  explicit RosFields(ByteSpan bytes) : bytes_(bytes) {}
  // Of several the first.
  std::string_view Text(std::string_view name) const {
    for (ByteReader in(bytes_, "a record's header"); in.left() > 0;) {
      const std::string_view field = AsText(in.Block());
      const std::size_t equals = field.find('=');
      if (equals == std::string_view::npos) throw Damage{"a record's header has a field without '='"};
      if (field.substr(0, equals) == name) return field.substr(equals + 1);
    }
    return {};
  }
  template <class T>
  T Number(std::string_view name) const {
    const std::string_view text = Text(name);
    T value{};
    if (text.size() != sizeof value)
      throw Damage{"a record's header without a field '" + std::string(name) + "'"};
    std::memcpy(&value, text.data(), sizeof value);
    return value;
  }
  std::int64_t Time(std::string_view name) const {
    const auto time = Number<std::uint64_t>(name);
    return static_cast<std::int64_t>(time & 0xFFFFFFFF) * kSecond_ns + static_cast<std::int64_t>(time >> 32);
  }

 private:
  ByteSpan bytes_;
};

struct ChunkAt {
  std::uint64_t at = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> messages;  // connection, how many; empty: not said
};

class Ros1Bag : public Container {
 public:
  explicit Ros1Bag(const std::string& path) : Container(path), file_(path) {
    const std::string_view magic =
        AsText(file_.View(0, std::min<std::uint64_t>(kMagic.size(), file_.size())));
    if (magic != kMagic)
      throw InputError(path + ": a bag of another version, '" + Printable(std::string(magic), 20) +
                       "'; known is 2.0 (`rosbag fix` makes one of it)");
    const std::uint64_t index_at = ReadBagHeader();
    if (index_at != 0 && ReadIndex(index_at)) return;
    ForgetChannels();
    chunks_.clear();
    connections_.clear();
    indexed_ = false;
    remarks_.emplace_back("it has no index, or a damaged one (the recorder was cut off?): read as a whole");
    Walk([](const Message&) {}, [](const std::string&) {}, true);
  }

  std::string what() const override { return "a ROS 1 bag"; }

  void ReadMessages(const std::vector<bool>& wanted, const Take& take, const Broken& broken) override {
    wanted_ = &wanted;
    if (!indexed_) return Walk(take, broken, false);
    for (const ChunkAt& chunk : chunks_) {
      const bool any = chunk.messages.empty() || std::ranges::any_of(chunk.messages, [&](const auto& some) {
                         const auto channel = connections_.find(some.first);
                         return channel == connections_.end() || wanted[channel->second];
                       });
      if (any) TryChunk(chunk.at, take, broken);
    }
  }

 private:
  // Of a record that begins at `at`, its header, and where its data lie.
  struct Record {
    std::uint64_t at = 0, data_at = 0, data_bytes = 0, end = 0;
  };
  // The fields are valid until the file is looked at again.
  std::pair<Record, RosFields> RecordAt(std::uint64_t at) {
    ByteReader length(file_.View(at, 4), "a record");
    const auto header_bytes = length.Take<std::uint32_t>();
    ByteReader in(file_.View(at + 4, std::uint64_t{header_bytes} + 4), "a record");
    const ByteSpan header = in.Bytes(header_bytes);
    Record record{at, at + 8 + header_bytes, in.Take<std::uint32_t>(), 0};
    record.end = record.data_at + record.data_bytes;
    return {record, RosFields(header)};
  }

  // Where the index begins; 0: there is none.
  std::uint64_t ReadBagHeader() {
    const auto [record, fields] = RecordAt(kMagic.size());
    if (fields.Number<std::uint8_t>("op") != kBagHeader)
      throw Damage{"it does not begin with a bag's header"};
    if (const std::string_view encryptor = fields.Text("encryptor"); !encryptor.empty())
      throw InputError(path() + ": encrypted by '" + Printable(std::string(encryptor), 80) +
                       "'; decrypt it first, with whoever has the key (`rosbag decrypt`)");
    first_record_ = record.end;
    chunk_count_ = fields.Number<std::uint32_t>("chunk_count");
    const auto index_at = fields.Number<std::uint64_t>("index_pos");
    return index_at >= first_record_ && index_at <= file_.size() ? index_at : 0;
  }

  // False where it is not as it should be: then the bag is read without it.
  bool ReadIndex(std::uint64_t at) {
    try {
      while (at < file_.size()) {
        const auto [record, fields] = RecordAt(at);
        at = record.end;
        switch (fields.Number<std::uint8_t>("op")) {
          case kConnection:
            ReadConnection(record, fields);
            break;
          case kChunkInfo:
            ReadChunkInfo(record, fields);
            break;
          default:
            return false;
        }
      }
    } catch (const Damage&) {
      return false;
    }
    std::ranges::sort(chunks_, {}, &ChunkAt::at);
    const auto repeated = std::ranges::adjacent_find(chunks_, {}, &ChunkAt::at);
    if (chunks_.size() != chunk_count_ || repeated != chunks_.end()) return false;
    for (const ChunkAt& chunk : chunks_)
      for (const auto& [connection, count] : chunk.messages) {
        const auto channel = connections_.find(connection);
        if (channel == connections_.end()) return false;
        Count(channel->second, count);
      }
    return true;
  }

  void ReadChunkInfo(const Record& record, const RosFields& fields) {
    ChunkAt chunk{fields.Number<std::uint64_t>("chunk_pos"), {}};
    Cover(fields.Time("start_time"), fields.Time("end_time"));
    const auto count = fields.Number<std::uint32_t>("count");
    ByteReader in(file_.View(record.data_at, record.data_bytes), "the index");
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto connection = in.Take<std::uint32_t>();
      chunk.messages.emplace_back(connection, in.Take<std::uint32_t>());
    }
    chunks_.push_back(std::move(chunk));
  }

  void ReadConnection(const Record& record, const RosFields& fields) {
    const auto connection = fields.Number<std::uint32_t>("conn");
    std::string topic(fields.Text("topic"));
    AddConnection(connection, std::move(topic), file_.View(record.data_at, record.data_bytes));
  }

  void AddConnection(std::uint32_t connection, std::string topic, ByteSpan data) {
    if (connections_.contains(connection)) return;
    const RosFields fields(data);
    Channel channel;
    channel.topic = std::move(topic);
    channel.type = fields.Text("type");
    channel.definition = Keep(fields.Text("message_definition"));
    channel.wire = Wire::kRos1;
    channel.encoding = "ros1";
    if (connections_.size() == kMostConnections) throw Damage{"more than 100,000 connections"};
    connections_[connection] = FindOrAdd(std::move(channel));
  }

  // All records after the header. `count`: nobody has counted them yet.
  void Walk(const Take& take, const Broken& broken, bool count) {
    counts_ = count;
    std::uint64_t at = first_record_;
    while (at < file_.size()) {
      std::uint64_t next = 0;  // of the record behind it, where that is known
      try {
        const auto [record, fields] = RecordAt(at);
        next = record.end;
        if (record.end > file_.size()) {
          next = 0;
          ReadBeforeTheEnd(record, fields, take);
          throw Damage{"the file ends within it"};
        }
        ReadRecord(record, fields, take);
      } catch (const Damage& damage) {
        broken("byte " + std::to_string(at) + ": " + damage.what);
        if (next == 0) break;
      }
      at = next;
    }
    counts_ = false;
  }

  void TryChunk(std::uint64_t at, const Take& take, const Broken& broken) {
    try {
      const auto [record, fields] = RecordAt(at);
      if (fields.Number<std::uint8_t>("op") != kChunk)
        throw Damage{"no chunk, where the index says that one is"};
      ReadRecord(record, fields, take);
    } catch (const Damage& damage) {
      broken("byte " + std::to_string(at) + ": " + damage.what);
    }
  }

  void ReadRecord(const Record& record, const RosFields& fields, const Take& take) {
    switch (fields.Number<std::uint8_t>("op")) {
      case kChunk: {
        const std::string how(fields.Text("compression"));
        const auto size = fields.Number<std::uint32_t>("size");
        if (IsPlain(how)) return ReadPlainChunk(record, take);
        const ByteSpan packed = file_.View(record.data_at, record.data_bytes);
        ReadChunk(unpacker_.Unpack(how, packed, size), take);
        break;
      }
      case kMessage: {
        const auto connection = fields.Number<std::uint32_t>("conn");
        const std::int64_t time_ns = fields.Time("time");
        TakeMessage(connection, time_ns, [&] { return file_.View(record.data_at, record.data_bytes); }, take);
        break;
      }
      case kConnection:
        ReadConnection(record, fields);
        break;
      default:
        break;
    }
  }

  // Of messages that are not wanted no more than the headers.
  void ReadPlainChunk(const Record& chunk, const Take& take) {
    for (std::uint64_t at = chunk.data_at; at < chunk.end;) {
      const auto [record, fields] = RecordAt(at);
      if (record.end > chunk.end) throw Damage{"cut short: a record of a chunk"};
      const auto op = fields.Number<std::uint8_t>("op");
      if (op != kConnection && op != kMessage) throw Damage{"a record that no chunk has"};
      ReadRecord(record, fields, take);
      at = record.end;
    }
  }

  // What is whole of a plain chunk that the file ends within.
  void ReadBeforeTheEnd(const Record& record, const RosFields& fields, const Take& take) {
    if (fields.Number<std::uint8_t>("op") != kChunk || !IsPlain(std::string(fields.Text("compression"))))
      return;
    Record there = record;
    there.end = file_.size();
    try {
      ReadPlainChunk(there, take);
    } catch (const Damage&) {  // the file's end, which is told
    }
  }

  void ReadChunk(ByteSpan chunk, const Take& take) {
    for (ByteReader in(chunk, "a record of a chunk"); in.left() > 0;) {
      const RosFields fields(in.Block());
      const ByteSpan data = in.Block();
      const auto op = fields.Number<std::uint8_t>("op");
      if (op == kConnection)
        AddConnection(fields.Number<std::uint32_t>("conn"), std::string(fields.Text("topic")), data);
      else if (op == kMessage)
        TakeMessage(fields.Number<std::uint32_t>("conn"), fields.Time("time"), [&] { return data; }, take);
      else
        throw Damage{"a record that no chunk has"};
    }
  }

  template <class Bytes>
  void TakeMessage(std::uint32_t connection, std::int64_t time_ns, const Bytes& bytes, const Take& take) {
    const auto channel = connections_.find(connection);
    if (channel == connections_.end()) throw Damage{"a message of a connection that is not there"};
    if (counts_) {
      Count(channel->second, 1);
      Cover(time_ns, time_ns);
    } else if (channel->second < wanted_->size() && (*wanted_)[channel->second]) {
      take({channel->second, 0, time_ns, bytes()});
    }
  }

  static constexpr std::size_t kMostConnections = 100'000;
  WindowFile file_;
  Unpacker unpacker_;
  std::uint64_t first_record_ = 0, chunk_count_ = 0;
  std::map<std::uint32_t, std::size_t> connections_;  // their channels
  std::vector<ChunkAt> chunks_;
  bool indexed_ = true, counts_ = false;
  const std::vector<bool>* wanted_ = nullptr;
};

}  // namespace

std::unique_ptr<Container> OpenRos1Bag(const std::string& path) { return std::make_unique<Ros1Bag>(path); }

}  // namespace cairn::datasets::bag
