#include "schema/kinds/constant_observations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "schema/kinds/log.h"

namespace cairn {
namespace {

constexpr std::size_t kFewObservations = 20;

// That all of a column's numbers are; none where they differ, or are few.
std::optional<double> Constant(std::span<const double> column) {
  std::vector<double> numbers;
  std::ranges::copy_if(column, std::back_inserter(numbers), [](double value) { return !std::isnan(value); });
  if (numbers.size() < kFewObservations || std::ranges::count(numbers, numbers[0]) != std::ssize(numbers))
    return std::nullopt;
  return numbers[0];
}

}  // namespace

std::vector<std::string> ConstantObservationsOf(const Blob& blob) {
  const auto log = Read<kinds::Log>(blob);
  std::vector<std::string> doubts;
  for (std::size_t r = 0; r < std::min(log.robot.size(), log.robots.OrNone().size()); ++r) {
    const kinds::Log::Observations& seen = log.robot[r].observations;
    const auto add = [&](const char* what, const char* unit, std::span<const double> column) {
      if (const auto value = Constant(column))
        doubts.push_back(
            fmt::format("robot '{}': all {} of its observations of landmarks are {:.4g} {}: was "
                        "the column filled in, or another one written there?",
                        log.robots[r], what, *value, unit));
    };
    add("bearings", "rad", seen.bearing_rad.OrNone());
    add("ranges", "m", seen.range_m.OrNone());
  }
  return doubts;
}

}  // namespace cairn
