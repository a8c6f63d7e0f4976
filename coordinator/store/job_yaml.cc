#include "coordinator/store/job_yaml.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <map>

#include "schema/hash.h"

namespace cairn::coordinator {
namespace {

// Double-quoted YAML, whatever is in the text.
std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted += std::string("\\") + c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      quoted += fmt::format("\\x{:02x}", static_cast<unsigned>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

// The shortest digits that give the same double again, never mistaken for an integer.
std::string Real(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  std::string text(digits.data(), end.ptr);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string ValueText(const proto::Value& value) {
  switch (value.kind_case()) {
    case proto::Value::kI:
      return std::to_string(value.i());
    case proto::Value::kD:
      return Real(value.d());
    case proto::Value::kB:
      return value.b() ? "true" : "false";
    default:
      return Quoted(value.s());
  }
}

std::string InputsText(const proto::Job& job) {
  const std::map<std::string, std::string> hashes(job.input_blobs().begin(), job.input_blobs().end());
  const std::map<std::string, std::string> paths(job.inputs().begin(), job.inputs().end());
  std::string text;
  for (const auto& [name, path] : paths) {
    const auto hash = hashes.find(name);
    const Result<Hash> content = Hash::FromBinary(hash == hashes.end() ? "" : hash->second);
    text += "  " + name + ": " + Quoted(path) + (content.ok() ? "  # content " + content.value().Hex() : "") +
            "\n";
  }
  return text.empty() ? "" : "inputs:\n" + text;
}

std::string StageText(const proto::Stage& stage) {
  std::string text =
      "  - name: " + Quoted(stage.name()) + "\n    pipeline: " + Quoted(stage.pipeline()) + "\n";
  for (const auto& [name, source] :
       std::map<std::string, std::string>(stage.inputs().begin(), stage.inputs().end()))
    text += "    " + name + ": " + Quoted(source) + "\n";
  std::string options;
  for (const auto& [name, value] :
       std::map<std::string, proto::Value>(stage.options().begin(), stage.options().end()))
    options += "      " + name + ": " + ValueText(value) + "\n";
  return text + (options.empty() ? "" : "    options:\n" + options);
}

}  // namespace

std::string JobAsYaml(const proto::Job& job) {
  std::string text =
      "name: " + Quoted(job.name()) + "\nseed: " + std::to_string(job.seed()) + "\n" + InputsText(job);
  text += "stages:\n";
  for (const proto::Stage& stage : job.stages()) text += StageText(stage);
  return text;
}

}  // namespace cairn::coordinator
