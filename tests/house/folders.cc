#include "tests/house/folders.h"

#include <algorithm>
#include <fstream>

#include "tests/house/include_rules.h"

namespace cairn::house {
namespace {

namespace fs = std::filesystem;

std::string FolderOf(const std::string& file) {
  if (file.starts_with("pipelines/registry.")) return "pipelines/registry";
  return fs::path(file).parent_path().string();
}

// Walks on from the last folder of `way`; true: `way` ends with a folder that stands on it already.
bool FindsCircle(const Folders& folders, std::vector<std::string>* way, std::set<std::string>* done) {
  const auto from = folders.includes.find(way->back());
  if (from == folders.includes.end()) return false;
  for (const std::string& to : from->second) {
    if (done->contains(to)) continue;
    const bool again = std::ranges::find(*way, to) != way->end();
    way->push_back(to);
    if (again || FindsCircle(folders, way, done)) return true;
    way->pop_back();
  }
  done->insert(way->back());
  return false;
}

}  // namespace

Folders ReadFolders(const fs::path& root) {
  Folders folders;
  for (const std::string& file : SourcesBelow(root)) {
    if (IsTest(file)) continue;
    const std::string folder = FolderOf(file);
    folders.sources[folder] += file.ends_with(".cc") ? 1 : 0;
    std::ifstream in(root / file);
    for (std::string line; std::getline(in, line);) {
      constexpr std::string_view kInclude = "#include \"";
      if (!line.starts_with(kInclude)) continue;
      const std::string to = FolderOf(line.substr(kInclude.size(), line.rfind('"') - kInclude.size()));
      if (to != folder) folders.includes[folder].insert(to);
    }
  }
  return folders;
}

std::vector<std::string> CircleIn(const Folders& folders) {
  std::set<std::string> done;
  for (const auto& [folder, includes] : folders.includes) {
    std::vector<std::string> way = {folder};
    if (done.contains(folder) || !FindsCircle(folders, &way, &done)) continue;
    way.erase(way.begin(), std::ranges::find(way, way.back()));
    return way;
  }
  return {};
}

}  // namespace cairn::house
