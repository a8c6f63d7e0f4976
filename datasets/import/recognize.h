// What a file or a folder that is not Cairn's looks like, so that a person learns which command reads it.
#pragma once

#include <optional>
#include <string>

namespace cairn::datasets {

struct Recognized {
  std::string what;     // "a folder of MR.CLAM logs"
  std::string command;  // "cairn import mrclam FOLDER OUT.h5", with the path for FOLDER
};

// By names of files and the beginning of a text. Nothing where it looks like nothing that Cairn reads; it
// never fails.
std::optional<Recognized> Recognize(const std::string& path);

}  // namespace cairn::datasets
