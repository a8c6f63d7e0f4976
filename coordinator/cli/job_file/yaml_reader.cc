#include "coordinator/cli/job_file/yaml_reader.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>

#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/job_file/yaml_look.h"
#include "schema/error.h"

namespace cairn::cli {
namespace {

constexpr std::size_t kMostBytes = 1 << 20;

bool IsName(const std::string& name) {
  if (name.empty() || name.size() > 64 || name[0] == '.') return false;
  return std::ranges::all_of(name, [](unsigned char c) {
    return (c < 128 && std::isalnum(c) != 0) || c == '_' || c == '-' || c == '.';
  });
}

}  // namespace

YAML::Node YamlReader::Load(const std::string& path) const {
  std::ifstream in(path, std::ios::binary);
  std::string text(kMostBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (in.bad() || text.empty())
    throw InputError(file_ + ": there is no such job file, or it cannot be read or is empty");
  if (text.size() > kMostBytes) throw InputError(file_ + ": larger than 1 MB: this is no job file");
  try {
    const YamlLook look = LookThroughYaml(text);
    if (!look.problem.empty()) Refuse(look.line, look.problem);
    if (look.documents == 0) Refuse(1, "the file is empty");
    if (look.documents > 1) Refuse(look.second_line, "a second document: a file holds one job");
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    Refuse(std::max(1, error.mark.line + 1), "not YAML: " + error.msg);
  }
}

std::vector<YamlEntry> YamlReader::Map(const YAML::Node& node, const std::string& what, int line) const {
  if (!node.IsMap()) Refuse(line, what + ": a map of `key: value` is needed");
  std::vector<YamlEntry> entries;
  std::map<std::string, int> seen;
  for (const auto& pair : node) {
    if (!pair.first.IsScalar()) Refuse(Line(pair.first), what + ": a key must be a single word");
    const YamlEntry entry{pair.first.Scalar(), pair.second, Line(pair.first),
                          pair.second.IsNull() ? Line(pair.first) : Line(pair.second)};
    const auto [it, fresh] = seen.emplace(entry.key, entry.key_line);
    if (!fresh)
      Refuse(entry.key_line, "'" + entry.key + "' was given already, at line " + std::to_string(it->second));
    entries.push_back(entry);
  }
  return entries;
}

std::vector<YAML::Node> YamlReader::Sequence(const YamlEntry& entry) const {
  if (!entry.value.IsSequence()) Refuse(entry.line, entry.key + ": a list is needed, its items after '- '");
  return {entry.value.begin(), entry.value.end()};
}

std::string YamlReader::Text(const YamlEntry& entry) const {
  const YAML::Node& node = entry.value;
  if (!node.IsScalar()) Refuse(entry.line, entry.key + ": a text is needed");
  const std::string& text = node.Scalar();
  const bool typed = ToReal(text).has_value() || ToBoolean(text).has_value();
  if (!IsQuoted(node) && typed)
    Refuse(entry.line, entry.key + ": a text is needed; write '" + text + "' in quotes");
  if (text.empty()) Refuse(entry.line, entry.key + ": is empty; a text is needed");
  if (text.find('\0') != std::string::npos)
    Refuse(entry.line, entry.key + ": has a NUL, at which a file's name would end");
  return text;
}

std::uint64_t YamlReader::Unsigned(const YamlEntry& entry) const {
  std::optional<std::uint64_t> value;
  if (entry.value.IsScalar() && !IsQuoted(entry.value)) value = ToUnsigned(entry.value.Scalar());
  if (!value) Refuse(entry.line, entry.key + ": a whole number from 0 to 18446744073709551615 is needed");
  return *value;
}

std::string YamlReader::Name(const YamlEntry& entry) const {
  const std::string name = Text(entry);
  CheckName(name, entry.line, entry.key);
  return name;
}

void YamlReader::CheckName(const std::string& name, int line, const std::string& what) const {
  if (IsName(name)) return;
  Refuse(line, what + ": '" + name +
                   "' is no name; allowed: up to 64 letters, digits, '_', '-', '.', not first a '.'");
}

void YamlReader::Refuse(int line, const std::string& problem) const {
  throw InputError(file_ + ":" + std::to_string(line) + ": " + problem);
}

}  // namespace cairn::cli
