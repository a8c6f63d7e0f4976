#include "datasets/evaluate/landmarks.h"

#include <cmath>
#include <map>
#include <string>

#include "schema/error.h"

namespace cairn::datasets {
namespace {

// Index into truth/landmarks of each of the log's (or result's) landmark names; kNoTruth where truth lacks
// it.
std::vector<std::int32_t> TruthOfNames(const std::vector<std::string>& names, const Blob& log) {
  std::map<std::string, std::int32_t> index;
  if (log.Has("truth/landmarks/name")) {
    std::int32_t next = 0;
    for (const std::string& name : log.Texts("truth/landmarks/name")) index.emplace(name, next++);
  }
  std::vector<std::int32_t> truth;
  for (const std::string& name : names) {
    const auto it = index.find(name);
    truth.push_back(it == index.end() ? kNoTruth : it->second);
  }
  return truth;
}

// Marks what the log's own identities tell of robot `r`; false where one is unknown.
bool MarkByIdentity(const Blob& log, std::size_t r, const std::vector<std::int32_t>& truth_of,
                    std::vector<bool>& observed) {
  const std::string name = "robot/" + std::to_string(r) + "/observations/landmark";
  if (!log.Has(name)) return true;
  for (const std::int32_t landmark : log.Get<std::int32_t>(name)) {
    if (landmark < 0) return false;
    const std::int32_t truth = truth_of[static_cast<std::size_t>(landmark)];
    if (truth != kNoTruth) observed[static_cast<std::size_t>(truth)] = true;
  }
  return true;
}

}  // namespace

std::vector<Point> ReadPoints(const Blob& blob, const std::string& x_name, const std::string& y_name) {
  const auto x = blob.Get<double>(x_name);
  const auto y = blob.Get<double>(y_name);
  std::vector<Point> points;
  for (std::size_t i = 0; i < x.size(); ++i) {
    points.push_back({x[i], y[i]});
  }
  return points;
}

std::vector<bool> ObservedLandmarks(const Blob& log, std::size_t landmarks) {
  std::vector<bool> observed(landmarks, false);
  const std::vector<std::int32_t> truth_of = TruthOfNames(log.Texts("landmarks"), log);
  for (std::size_t r = 0; r < log.Texts("robots").size(); ++r) {
    const std::string name = "truth/robot/" + std::to_string(r) + "/observations/landmark";
    if (log.Has(name)) {
      for (const std::int32_t landmark : log.Get<std::int32_t>(name)) {
        if (landmark >= 0) observed[static_cast<std::size_t>(landmark)] = true;
      }
    } else if (!MarkByIdentity(log, r, truth_of, observed)) {
      return std::vector<bool>(landmarks, true);
    }
  }
  return observed;
}

std::vector<std::int32_t> MapIdentities(const Blob& result, const Blob& log, std::size_t landmarks) {
  std::vector<std::int32_t> truth(landmarks, kNoTruth);
  if (!result.Has("map/landmark_identity")) return truth;
  const auto identity = result.Get<std::int32_t>("map/landmark_identity");
  const std::vector<std::int32_t> truth_of = TruthOfNames(result.Texts("landmarks"), log);
  for (std::size_t k = 0; k < landmarks; ++k) {
    if (identity[k] < 0) continue;
    truth[k] = truth_of[static_cast<std::size_t>(identity[k])];
  }
  return truth;
}

}  // namespace cairn::datasets
