#include "pipelines/common/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cairn::options_internal {
namespace {

std::string Number(double value) { return fmt::format("{:g}", value); }

std::string Allowed(const Option& option) {
  return "from " + Number(option.low) + " to " + Number(option.high) + (*option.unit ? " " : "") +
         option.unit;
}

[[noreturn]] void Refuse(const Option& option, const std::string& problem) {
  throw InputError("option " + std::string(option.name) + ": " + problem);
}

void CheckRange(const Option& option, double value) {
  if (!(value >= option.low && value <= option.high)) {
    Refuse(option, Number(value) + " is out of range; allowed: " + Allowed(option));
  }
}

std::string Join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace

const proto::Value* Parser::Find(const Option& option) {
  known_.emplace_back(option.name);
  const auto it = values_.find(option.name);
  return it == values_.end() ? nullptr : &it->second;
}

void Parser::operator()(const Option& option, double& field) {
  const proto::Value* value = Find(option);
  if (value == nullptr) return;
  if (value->kind_case() == proto::Value::kD)
    field = value->d();
  else if (value->kind_case() == proto::Value::kI)
    field = static_cast<double>(value->i());
  else
    Refuse(option, "a number is needed, " + Allowed(option));
  CheckRange(option, field);
}

void Parser::operator()(const Option& option, std::int64_t& field) {
  const proto::Value* value = Find(option);
  if (value == nullptr) return;
  if (value->kind_case() != proto::Value::kI) Refuse(option, "a whole number is needed, " + Allowed(option));
  field = value->i();
  CheckRange(option, static_cast<double>(field));
}

void Parser::operator()(const Option& option, bool& field) {
  const proto::Value* value = Find(option);
  if (value == nullptr) return;
  if (value->kind_case() != proto::Value::kB) Refuse(option, "true or false is needed");
  field = value->b();
}

void Parser::operator()(const Option& option, std::string& field) {
  const proto::Value* value = Find(option);
  if (value == nullptr) return;
  if (value->kind_case() != proto::Value::kS) Refuse(option, "a text is needed");
  field = value->s();
  if (!option.choices.empty() && std::ranges::find(option.choices, field) == option.choices.end()) {
    Refuse(option, "'" + field + "' is not known; allowed: " + Join(option.choices));
  }
}

void Parser::RequireKnownOptions() const {
  std::vector<std::string> unknown;
  for (const auto& [name, value] : values_) {
    if (std::ranges::find(known_, name) == known_.end()) unknown.push_back(name);
  }
  if (unknown.empty()) return;
  std::ranges::sort(unknown);
  throw InputError("unknown option " + Join(unknown) + "; known: " + Join(known_));
}

OptionInfo& Describer::Add(const Option& option, const char* type) {
  infos.push_back({option.name, type, option.unit, option.help, option.low, option.high, option.choices, {}});
  return infos.back();
}

void Describer::operator()(const Option& option, double& field) {
  Add(option, "real").default_value.set_d(field);
}
void Describer::operator()(const Option& option, std::int64_t& field) {
  Add(option, "integer").default_value.set_i(field);
}
void Describer::operator()(const Option& option, bool& field) {
  Add(option, "boolean").default_value.set_b(field);
}
void Describer::operator()(const Option& option, std::string& field) {
  Add(option, "text").default_value.set_s(field);
}

}  // namespace cairn::options_internal

namespace cairn {

std::vector<std::string> ByCommas(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t first = 0; first < text.size();) {
    const std::size_t end = std::min(text.find(',', first), text.size());
    std::string part = text.substr(first, end - first);
    part.erase(0, std::min(part.find_first_not_of(' '), part.size()));
    part.erase(part.find_last_not_of(' ') + 1);
    if (!part.empty()) parts.push_back(part);
    first = end + 1;
  }
  return parts;
}

}  // namespace cairn
