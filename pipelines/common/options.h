// Options of a pipeline: an aggregate whose fields all have defaults, and one function that visits them:
//
//   struct Options { double cell_m = 1; };
//   template <class V> void VisitOptions(V& visit, Options& o) {
//     visit(Option{"cell_m", "m", 0.01, 100, "edge of a map cell"}, o.cell_m);
//   }
//
// From that one list come strict parsing (ParseOptions) and the description for people (DescribeOptions).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "schema/error.h"
#include "schema/job.pb.h"

namespace cairn {

// One option, as a pipeline declares it. For texts and booleans the range is not looked at.
struct Option {
  const char* name;  // with its unit: cell_m
  const char* unit;  // "" where it has none
  double low = 0;    // inclusive
  double high = 0;   // inclusive
  const char* help;
  std::vector<std::string> choices = {};  // texts: what is allowed; empty: anything
};

struct OptionInfo {
  std::string name, type, unit, help;  // type: real, integer, boolean, text
  double low = 0, high = 0;
  std::vector<std::string> choices;
  proto::Value default_value;
};

using OptionValues = google::protobuf::Map<std::string, proto::Value>;

namespace options_internal {

class Parser {
 public:
  explicit Parser(const OptionValues& values) : values_(values) {}
  void operator()(const Option& option, double& field);
  void operator()(const Option& option, std::int64_t& field);
  void operator()(const Option& option, bool& field);
  void operator()(const Option& option, std::string& field);
  // Throws InputError that names the options that no call has asked for.
  void RequireKnownOptions() const;

 private:
  const proto::Value* Find(const Option& option);
  const OptionValues& values_;
  std::vector<std::string> known_;
};

class Describer {
 public:
  void operator()(const Option& option, double& field);
  void operator()(const Option& option, std::int64_t& field);
  void operator()(const Option& option, bool& field);
  void operator()(const Option& option, std::string& field);
  std::vector<OptionInfo> infos;

 private:
  OptionInfo& Add(const Option& option, const char* type);
};

}  // namespace options_internal

// An integer is taken where a real is asked for.
// Throws InputError that names the option, what it is and what is allowed, where
// - it is unknown;
// - its value is of another type;
// - its value is out of range, or none of the choices.
template <class Options>
Options ParseOptions(const OptionValues& values) {
  Options options;
  options_internal::Parser parser(values);
  VisitOptions(parser, options);
  parser.RequireKnownOptions();
  return options;
}

template <class Options>
std::vector<OptionInfo> DescribeOptions() {
  Options options;
  options_internal::Describer describer;
  VisitOptions(describer, options);
  return describer.infos;
}

// The parts of a text between commas, without the blanks around them; empty ones are passed over.
std::vector<std::string> ByCommas(const std::string& text);

}  // namespace cairn
