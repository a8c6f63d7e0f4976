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

// The truth's columns and indices come from a file, and need not fit together.
void Mark(std::int32_t landmark, const std::string& name, std::vector<bool>& observed) {
  if (landmark >= static_cast<std::int64_t>(observed.size()))
    throw InputError("'" + name + "': landmark " + std::to_string(landmark) + " of " +
                     std::to_string(observed.size()));
  observed[static_cast<std::size_t>(landmark)] = true;
}

// Marks what the log's own identities tell of robot `r`; false where one is unknown.
bool MarkByIdentity(const Blob& log, std::size_t r, const std::vector<std::int32_t>& truth_of,
                    std::vector<bool>& observed) {
  const std::string name = "robot/" + std::to_string(r) + "/observations/landmark";
  if (!log.Has(name)) return true;
  for (const std::int32_t landmark : log.Get<std::int32_t>(name)) {
    if (landmark < 0 || landmark >= static_cast<std::int64_t>(truth_of.size())) return false;
    const std::int32_t truth = truth_of[static_cast<std::size_t>(landmark)];
    if (truth != kNoTruth) Mark(truth, name, observed);
  }
  return true;
}

}  // namespace

std::vector<Point> ReadPoints(const Blob& blob, const std::string& x_name, const std::string& y_name) {
  const auto x = blob.Get<double>(x_name);
  const auto y = blob.Get<double>(y_name);
  if (x.size() != y.size()) throw InputError("'" + x_name + "' and '" + y_name + "' differ in length");
  std::vector<Point> points;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i] + y[i])) {
      throw InputError("'" + x_name + "', row " + std::to_string(i) + ": the position is not finite");
    }
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
        if (landmark >= 0) Mark(landmark, name, observed);
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
  if (identity.size() != landmarks) throw InputError("'map/landmark_identity' has a length of its own");
  for (std::size_t k = 0; k < landmarks; ++k) {
    if (identity[k] < 0) continue;
    if (identity[k] >= static_cast<std::int64_t>(truth_of.size())) {
      throw InputError("'map/landmark_identity', row " + std::to_string(k) + ": there is no landmark " +
                       std::to_string(identity[k]));
    }
    truth[k] = truth_of[static_cast<std::size_t>(identity[k])];
  }
  return truth;
}

}  // namespace cairn::datasets
