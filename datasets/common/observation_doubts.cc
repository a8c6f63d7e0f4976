#include "datasets/common/observation_doubts.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "schema/kinds/constant_observations.h"
#include "schema/kinds/log.h"
#include "schema/text.h"

namespace cairn::datasets {
namespace {

std::string SharedNames(const kinds::Log& log) {
  const std::vector<std::string>& robots = log.robots.OrNone();
  const std::set<std::string> landmarks(log.landmarks.OrNone().begin(), log.landmarks.OrNone().end());
  std::vector<std::string> shared;
  for (const std::string& robot : robots)
    if (landmarks.contains(robot)) shared.push_back(robot);
  if (shared.empty()) return {};
  return "robots and landmarks have names in common: " + NameList(shared) +
         ". Were the robots themselves observed? They drive, and a map holds landmarks to stand still: leave "
         "such observations out. Where landmarks only happen to be called so, nothing is wrong";
}

// Of an observation with one of both only.
std::size_t HalvesOf(const kinds::Log::Observations& seen) {
  const auto range = seen.range_m.OrNone(), bearing = seen.bearing_rad.OrNone();
  const std::size_t all = std::max(range.size(), bearing.size());
  const auto is_there = [](std::span<const double> column, std::size_t i) {
    return i < column.size() && !std::isnan(column[i]);
  };
  std::size_t halves = 0;
  for (std::size_t i = 0; i < all; ++i) halves += is_there(range, i) != is_there(bearing, i) ? 1 : 0;
  return halves;
}

std::string HalfObservations(const kinds::Log& log) {
  const std::vector<std::string>& robots = log.robots.OrNone();
  std::vector<std::string> of;
  std::size_t halves = 0;
  for (std::size_t r = 0; r < std::min(robots.size(), log.robot.size()); ++r) {
    const std::size_t here = HalvesOf(log.robot[r].observations);
    if (here > 0) of.push_back(robots[r]);
    halves += here;
  }
  if (halves == 0) return {};
  return std::to_string(halves) + " observation" + (halves == 1 ? " has" : "s have") +
         " a range without a bearing, or a bearing without a range (of robot" +
         (of.size() == 1 ? " " : "s ") + NameList(of) +
         "): landmark_map needs both, or neither where the robot stands at the landmark";
}

}  // namespace

std::vector<std::string> ObservationDoubtsOf(const Blob& log) {
  const auto parts = Read<kinds::Log>(log);
  std::vector<std::string> doubts;
  for (std::string& doubt : std::vector<std::string>{SharedNames(parts), HalfObservations(parts)})
    if (!doubt.empty()) doubts.push_back(std::move(doubt));
  for (std::string& doubt : ConstantObservationsOf(log)) doubts.push_back(std::move(doubt));
  return doubts;
}

}  // namespace cairn::datasets
