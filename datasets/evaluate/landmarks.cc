#include "datasets/evaluate/landmarks.h"

#include <cmath>
#include <map>
#include <string>

namespace cairn::datasets {
namespace {

// Index into truth/landmarks of each of the log's (or result's) landmark names; kNoTruth where truth lacks
// it.
std::vector<std::int32_t> TruthOfNames(const std::vector<std::string>& names, const kinds::Log& log) {
  std::map<std::string, std::int32_t> index;
  std::int32_t next = 0;
  for (const std::string& name : log.truth.landmarks.name.OrNone()) index.emplace(name, next++);
  std::vector<std::int32_t> truth;
  for (const std::string& name : names) {
    const auto it = index.find(name);
    truth.push_back(it == index.end() ? kNoTruth : it->second);
  }
  return truth;
}

// Marks what a robot's own identities tell; false where one is unknown.
bool MarkByIdentity(const kinds::Log::Robot& robot, const std::vector<std::int32_t>& truth_of,
                    std::vector<bool>& observed) {
  for (const std::int32_t landmark : robot.observations.landmark.OrNone()) {
    if (landmark < 0) return false;
    const std::int32_t truth = truth_of[static_cast<std::size_t>(landmark)];
    if (truth != kNoTruth) observed[static_cast<std::size_t>(truth)] = true;
  }
  return true;
}

}  // namespace

std::vector<Point> PointsOf(std::span<const double> x_m, std::span<const double> y_m) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < x_m.size(); ++i) points.push_back({x_m[i], y_m[i]});
  return points;
}

std::vector<bool> ObservedLandmarks(const kinds::Log& log) {
  const std::size_t landmarks = log.truth.landmarks.x_m.size();
  std::vector<bool> observed(landmarks, false);
  const std::vector<std::int32_t> truth_of = TruthOfNames(log.landmarks, log);
  for (std::size_t r = 0; r < log.robot.size(); ++r) {
    if (r < log.truth.robot.size() && log.truth.robot[r].landmark) {
      for (const std::int32_t landmark : log.truth.robot[r].landmark) {
        if (landmark >= 0) observed[static_cast<std::size_t>(landmark)] = true;
      }
    } else if (!MarkByIdentity(log.robot[r], truth_of, observed)) {
      return std::vector<bool>(landmarks, true);
    }
  }
  return observed;
}

std::vector<std::int32_t> MapIdentities(const kinds::LandmarkMap& map, const kinds::Log& log) {
  std::vector<std::int32_t> truth(map.map.landmark_x_m.size(), kNoTruth);
  if (!map.map.landmark_identity) return truth;
  const std::vector<std::int32_t> truth_of = TruthOfNames(map.landmarks, log);
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const std::int32_t identity = map.map.landmark_identity[k];
    if (identity >= 0) truth[k] = truth_of[static_cast<std::size_t>(identity)];
  }
  return truth;
}

}  // namespace cairn::datasets
