#include "tests/layering/folders.h"

#include <algorithm>
#include <fstream>

#include "tests/layering/include_rules.h"

namespace cairn::layering {
namespace {

namespace fs = std::filesystem;

std::string FolderOf(const std::string& file) {
  if (file.starts_with("pipelines/registry.")) return "pipelines/registry";
  return fs::path(file).parent_path().string();
}

// Walks on from the last folder of `path`; true: `path` ends with a folder that stands on it already.
bool FindsCircle(const Folders& folders, std::vector<std::string>* path, std::set<std::string>* done) {
  const auto from = folders.includes.find(path->back());
  if (from == folders.includes.end()) return false;
  for (const std::string& to : from->second) {
    if (done->contains(to)) continue;
    const bool again = std::ranges::find(*path, to) != path->end();
    path->push_back(to);
    if (again || FindsCircle(folders, path, done)) return true;
    path->pop_back();
  }
  done->insert(path->back());
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
    std::vector<std::string> path = {folder};
    if (done.contains(folder) || !FindsCircle(folders, &path, &done)) continue;
    path.erase(path.begin(), std::ranges::find(path, path.back()));
    return path;
  }
  return {};
}

}  // namespace cairn::layering
