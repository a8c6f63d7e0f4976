// A stage's option as benchmarks take it from their arguments: key=value, read as a job file would read it.
#pragma once

#include <cstdlib>
#include <string>

#include "schema/error.h"
#include "schema/job.pb.h"

namespace cairn {

inline proto::Value ValueOf(const std::string& text) {
  proto::Value value;
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text == "true" || text == "false")
    value.set_b(text == "true");
  else if (end == text.c_str() || *end != '\0')
    value.set_s(text);
  else if (text.find_first_of(".e") == std::string::npos)
    value.set_i(std::atoll(text.c_str()));
  else
    value.set_d(number);
  return value;
}

// Throws InputError where `text` is not key=value.
inline void SetOption(const std::string& text, proto::Stage* stage) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) throw InputError("'" + text + "' is not key=value");
  (*stage->mutable_options())[text.substr(0, equals)] = ValueOf(text.substr(equals + 1));
}

}  // namespace cairn
