// An MCAP file (mcap.dev/spec) of protobuf messages: chunks packed by zstd, an index of each, a summary.
#pragma once

#include <google/protobuf/message.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace cairn::datasets {

class McapFile {
 public:
  // All messages of a topic are of one type. `time_ns`: when it was "received", by which players order them.
  void Add(const std::string& topic, std::uint64_t time_ns, const google::protobuf::Message& message);
  // Facts about the whole file, under a name of their own.
  void AddMetadata(std::string name, std::map<std::string, std::string> facts) {
    metadata_[std::move(name)] = std::move(facts);
  }
  // All of it, messages in order of time.
  std::string Bytes() const;

 private:
  struct Channel {
    std::uint16_t id = 0, schema = 0;
    std::uint32_t messages = 0;
  };
  struct Message {
    std::uint64_t time_ns = 0;
    std::uint16_t channel = 0;
    std::uint32_t number = 0;  // of the channel's
    std::string bytes;
  };
  std::uint16_t SchemaOf(const google::protobuf::Descriptor& type);
  std::string Statistics(const std::vector<const Message*>& ordered, std::uint32_t chunks) const;

  std::map<std::string, Channel> channels_;  // by topic
  std::map<std::string, std::uint16_t> schema_ids_;
  std::string schema_records_, channel_records_;
  std::vector<Message> messages_;
  std::map<std::string, std::map<std::string, std::string>> metadata_;
};

}  // namespace cairn::datasets
