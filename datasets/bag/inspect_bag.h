// What bags hold: topics, and what of them Cairn can use.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace cairn::datasets {

struct BagTopic {
  std::string name, type;
  std::uint64_t messages = 0;
  double rate_hz = 0;  // over the time of the bag; 0 of less than two messages
  // Of topics that Cairn can use alone: the rest are not read, nor are clouds of points.
  std::string as;                   // as what
  std::optional<double> gap_s;      // the longest between two messages, as the recorder had them
  std::vector<std::string> frames;  // of its headers, or, of tf, "odom > base_link"; ten at the most
};

struct BagInspection {
  std::string what;  // "a ROS 1 bag"
  std::size_t files = 0;
  double first_s = 0, length_s = 0;  // first_s: Unix time
  std::vector<BagTopic> topics;      // in the order of their names
  std::vector<std::string> remarks;  // what is wrong with it
  std::string command;               // that reads it in, for whoever says how the path is quoted
};

// Of a file, or a folder of rosbag2. Throws InputError as ImportBag does where nothing of it can be read;
// what is damaged within it is a remark.
BagInspection InspectBag(const std::string& path);

// Whether something in it says how a robot moved, without which there is no log.
bool MakesALog(const BagInspection& inspection);

std::string BagText(const BagInspection& inspection);

}  // namespace cairn::datasets
