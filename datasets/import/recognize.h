// What a file or a folder that is not Cairn's looks like, so that a person learns which command reads it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace cairn::datasets {

struct Recognized {
  std::string what;     // "a folder of MR.CLAM logs"
  std::string command;  // "cairn import mrclam FOLDER OUT.h5", with the path for FOLDER
};

// By names of files and the beginning of a text. Nothing where it looks like nothing that Cairn reads; it
// never fails.
std::optional<Recognized> Recognize(const std::string& path);

// What a file is whose first bytes, 16 or more, are these: "a ROS 1 bag", "an MCAP file", "a ROS 2 bag in
// SQLite"; nothing where it is no bag.
std::optional<std::string> BagName(std::string_view head);

}  // namespace cairn::datasets
