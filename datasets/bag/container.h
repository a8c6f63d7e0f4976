// What all containers of recorded messages have in common: channels, and messages of them, read one after the
// other. A file of any size takes as much memory as its largest chunk.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "datasets/bag/bytes.h"

namespace cairn::datasets::bag {

// How a message's fields became bytes.
enum class Wire { kRos1, kCdr, kOther };

// Messages of one topic and type; several publishers are one channel where their definitions are the same.
struct Channel {
  std::string topic, type;      // "nav_msgs/Odometry", of ROS 2 as well
  std::string_view definition;  // the type's text, which the container keeps; empty: the file has none
  Wire wire = Wire::kOther;
  std::string encoding;  // its name, for people
  std::uint64_t messages = 0;
};

struct Message {
  std::size_t channel = 0;
  std::uint64_t number = 0;     // of the channel's messages, from 1
  std::int64_t receive_ns = 0;  // when the recorder had it
  ByteSpan bytes;               // valid while the message is taken
};

class Container {
 public:
  using Take = std::function<void(const Message&)>;
  using Broken = std::function<void(const std::string& what)>;

  explicit Container(std::string path) : path_(std::move(path)) {}
  virtual ~Container() = default;
  Container(const Container&) = delete;
  Container& operator=(const Container&) = delete;

  const std::string& path() const { return path_; }
  // Of what can be read, with the number of messages.
  const std::vector<Channel>& channels() const { return channels_; }
  std::int64_t first_ns() const {
    return first_ns_;
  }  // of all messages; where there are none, more than last_ns
  std::int64_t last_ns() const { return last_ns_; }
  const std::vector<std::string>& remarks() const {
    return remarks_;
  }  // for people, such as that it has no index
  virtual std::string what() const = 0;  // "a ROS 1 bag"

  // Hands the messages of those channels that are `wanted` to `take`, in the order of the file; chunks that
  // an index says hold none of them are not read. `broken` hears of each part that cannot be read; where it
  // returns, what follows is read, as far as it can be found. Returns how many there were of each channel;
  // where that is not its `messages`, a remark says so.
  std::vector<std::uint64_t> Read(const std::vector<bool>& wanted, const Take& take, const Broken& broken);

 protected:
  // As Read; the messages' numbers are set by it.
  virtual void ReadMessages(const std::vector<bool>& wanted, const Take& take, const Broken& broken) = 0;
  // Throw InputError: a definition is of more than a megabyte, or all that is kept of names and definitions
  // of more than 64. Of equal texts one is kept.
  std::string_view Keep(std::string_view text);
  std::size_t FindOrAdd(Channel channel);  // whose definition Keep gave
  void Count(std::size_t channel, std::uint64_t messages) { channels_[channel].messages += messages; }
  void Cover(std::int64_t first_ns, std::int64_t last_ns);
  // For a file that is read anew.
  void ForgetChannels();
  std::vector<std::string> remarks_;

 private:
  void CountText(std::size_t bytes);
  std::string path_;
  std::set<std::string, std::less<>> texts_;
  std::size_t text_bytes_ = 0;
  std::vector<Channel> channels_;
  std::int64_t first_ns_ = std::numeric_limits<std::int64_t>::max();
  std::int64_t last_ns_ = std::numeric_limits<std::int64_t>::min();
};

// Throws InputError that names the file: it cannot be read, is no bag, is encrypted, of a version that is not
// known, or is damaged so that nothing of it can be read.
std::unique_ptr<Container> OpenContainer(const std::string& path);

// The bag files that a path names: itself, or those of a folder of rosbag2 (.db3, .mcap), in the order of
// their numbers. Throws InputError where a folder has none.
std::vector<std::string> BagFilesOf(const std::string& path);

// Those files, opened, and a folder's metadata.yaml held against them (rosbag2_folder.cc). Throws InputError
// as BagFilesOf and OpenContainer do.
struct OpenedBags {
  std::vector<std::unique_ptr<Container>> files;  // as BagFilesOf has them
  std::vector<std::string> missing;               // that metadata.yaml names, and that are not there
  std::vector<std::string> remarks;               // for people: what else is not as metadata.yaml says
};
OpenedBags OpenBags(const std::string& path);

// What SQLite files of rosbag2 begin with, and have in them.
std::unique_ptr<Container> OpenSqliteBag(const std::string& path);
std::unique_ptr<Container> OpenRos1Bag(const std::string& path);
std::unique_ptr<Container> OpenMcap(const std::string& path);

// Rounded once.
double SecondsOf(std::int64_t ns);

// "nav_msgs/msg/Odometry" as "nav_msgs/Odometry".
std::string TypeName(std::string type);

}  // namespace cairn::datasets::bag
