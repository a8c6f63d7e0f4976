// What was refused, counted by kind, and told to the log at a rate that nobody can flood it with.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "coordinator/store/log.h"
#include "schema/wire/refusal.h"

namespace cairn::coordinator {

class Refusals {
 public:
  explicit Refusals(LogSink log) : log_(std::move(log)) {}
  // Logs the first of a kind at once; those that follow within kQuiet_s are only counted, and told with the
  // next.
  void Add(const wire::Refusal& refusal, double now_s);
  std::uint64_t count(wire::RefusalKind kind) const;
  // By the kinds' names.
  std::map<std::string, std::uint64_t> Counts() const;

 private:
  static constexpr double kQuiet_s = 5;
  struct Kind {
    std::uint64_t count = 0;
    std::uint64_t untold = 0;
    double told_s = 0;
  };
  LogSink log_;
  std::map<wire::RefusalKind, Kind> kinds_;
};

}  // namespace cairn::coordinator
