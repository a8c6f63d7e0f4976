// A strict view of a YAML map: every key is known and given once, every value has the type that is asked for.
// Every complaint carries file and line.
#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <string>
#include <vector>

namespace cairn::cli {

// Copied, never assigned: assignment to a YAML::Node changes the document that it points into.
struct YamlEntry {
  std::string key;
  YAML::Node value;
  int key_line = 0;
  int line = 0;  // of the value; both counted from 1
};

class YamlReader {
 public:
  explicit YamlReader(std::string file) : file_(std::move(file)) {}

  // The file's one document.
  // Throws InputError: not there, no YAML, several documents, over 1 MB, nested too deep, too many aliases.
  YAML::Node Load(const std::string& path) const;

  // The entries of a map in the order of the file. Throws, naming `what` and `line`, where it is no map, or
  // has a key twice. (A node that stands empty has a line of its own that is not the one where it is missed.)
  std::vector<YamlEntry> Map(const YAML::Node& node, const std::string& what, int line) const;
  std::vector<YAML::Node> Sequence(const YamlEntry& entry) const;
  std::string Text(const YamlEntry& entry) const;  // `7` and `true` need quotes
  std::uint64_t Unsigned(const YamlEntry& entry) const;
  // As Text, but a name that may stand in paths: letters, digits, '_', '-', '.'; not first a '.'.
  std::string Name(const YamlEntry& entry) const;
  void CheckName(const std::string& name, int line, const std::string& what) const;

  // Throws InputError "file:line: problem".
  [[noreturn]] void Refuse(int line, const std::string& problem) const;
  static int Line(const YAML::Node& node) { return node.Mark().line + 1; }
  static bool IsQuoted(const YAML::Node& node) { return node.Tag() == "!"; }

 private:
  std::string file_;  // as the person wrote it
};

}  // namespace cairn::cli
