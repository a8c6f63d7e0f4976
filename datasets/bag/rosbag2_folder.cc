// Folders of rosbag2: files, and beside them a metadata.yaml that names them and counts their messages. A
// recorder that was cut off has left none.
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>

#include "datasets/bag/container.h"
#include "schema/store/regular_file.h"
#include "schema/text.h"

namespace cairn::datasets::bag {
namespace {

namespace fs = std::filesystem;

struct FolderMetadata {
  std::vector<std::string> files;
  std::uint64_t messages = 0;
};

// None where there is none; where it says nothing that is understood, a remark.
std::optional<FolderMetadata> ReadMetadata(const std::string& path, std::vector<std::string>* remarks) {
  constexpr std::size_t kMostBytes = 16 << 20;
  const Result<std::string> text = ReadSmallFile(path, kMostBytes);
  if (!text.ok() && text.status().code() == Code::kNotFound) return {};
  std::string why;
  try {
    if (!text.ok()) throw Damage{text.status().message()};
    const YAML::Node root = YAML::Load(text.value());
    const YAML::Node about = root["rosbag2_bagfile_information"];
    FolderMetadata metadata;
    for (const auto& name : about["relative_file_paths"])
      metadata.files.push_back(fs::path(name.as<std::string>()).filename());  // some write the folder too
    if (metadata.files.empty()) throw Damage{"it names no file"};
    metadata.messages = about["message_count"].as<std::uint64_t>();
    return metadata;
  } catch (const YAML::Exception& problem) {
    why = problem.what();
  } catch (const Damage& damage) {
    why = damage.what;
  }
  remarks->push_back("metadata.yaml is none of rosbag2's (" + Printable(why, 200) +
                     "): whether all is there is not known");
  return {};
}

// Which of `files` is meant by a name; rosbag2 packs files as a whole, and who unpacks them leaves the name.
std::vector<std::string>::const_iterator FindFile(const std::vector<std::string>& files,
                                                  const std::string& name) {
  constexpr std::string_view kPacked = ".zstd";
  const auto is_called = [](std::string_view wanted) {
    return [wanted](const std::string& file) { return fs::path(file).filename() == wanted; };
  };
  const auto found = std::ranges::find_if(files, is_called(name));
  if (found != files.end() || !name.ends_with(kPacked)) return found;
  return std::ranges::find_if(files,
                              is_called(std::string_view(name).substr(0, name.size() - kPacked.size())));
}

}  // namespace

OpenedBags OpenBags(const std::string& path) {
  OpenedBags bags;
  std::vector<std::string> files = BagFilesOf(path);
  std::optional<FolderMetadata> metadata;
  std::error_code error;
  if (fs::is_directory(path, error))
    metadata = ReadMetadata((fs::path(path) / "metadata.yaml").string(), &bags.remarks);
  std::vector<bool> is_named(files.size());
  if (metadata)
    for (const std::string& name : metadata->files) {
      const auto found = FindFile(files, name);
      const std::string there = (fs::path(path) / name).string();
      if (found != files.cend()) {
        is_named[static_cast<std::size_t>(found - files.cbegin())] = true;
      } else if (fs::exists(there, error)) {  // called as none of them, or packed: which opening it says
        files.push_back(there);
        is_named.push_back(true);
      } else {
        bags.missing.push_back(Printable(name, 200));
      }
    }
  std::uint64_t messages = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Container& file = *bags.files.emplace_back(OpenContainer(files[i]));
    if (!metadata) continue;
    if (!is_named[i])
      bags.remarks.push_back(fs::path(files[i]).filename().string() +
                             " is not in its metadata.yaml, and read");
    else
      for (const Channel& channel : file.channels()) messages += channel.messages;
  }
  if (metadata && bags.missing.empty() && messages < metadata->messages)
    bags.remarks.push_back("its metadata.yaml counts " + std::to_string(metadata->messages) +
                           " messages, and its files have " + std::to_string(messages) +
                           ": a part of the recording is missing");
  return bags;
}

}  // namespace cairn::datasets::bag
