// The graph of folders that their #include lines draw, tests left out.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace cairn::layering {

struct Folders {
  std::map<std::string, std::set<std::string>> includes;  // of each folder those whose headers it includes
  std::map<std::string, int> sources;                     // .cc files right in it
};

// pipelines/registry stands for itself: it names every method, and lies where the methods' interface does.
Folders ReadFolders(const std::filesystem::path& root);

// Folders that include each other in a circle, the first one again at the end; empty where there is none.
std::vector<std::string> CircleIn(const Folders& folders);

}  // namespace cairn::layering
