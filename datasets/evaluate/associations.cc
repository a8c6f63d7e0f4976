#include "datasets/evaluate/associations.h"

#include <map>
#include <string>

namespace cairn::datasets {
namespace {

std::string ObservationsOf(std::size_t robot) { return "robot/" + std::to_string(robot) + "/observations/"; }

std::vector<std::int32_t> ReadIndices(const Blob& blob, const std::string& name, std::size_t rows,
                                      std::size_t landmarks) {
  const auto indices = blob.Get<std::int32_t>(name);
  if (indices.size() != rows) {
    throw InputError("'" + name + "' has " + std::to_string(indices.size()) + " rows; the log has " +
                     std::to_string(rows) + " observations of this robot: was it made from this log?");
  }
  for (std::size_t i = 0; i < rows; ++i) {
    if (indices[i] < -1 || indices[i] >= static_cast<std::int64_t>(landmarks)) {
      throw InputError("'" + name + "', row " + std::to_string(i) + ": landmark " +
                       std::to_string(indices[i]) + " of " + std::to_string(landmarks));
    }
  }
  return {indices.begin(), indices.end()};
}

std::size_t ObservationCount(const Blob& log, std::size_t robot) {
  const std::string name = ObservationsOf(robot) + "time_s";
  return log.Has(name) ? log.Get<double>(name).size() : 0;
}

}  // namespace

Associations ReadMapAssociations(const Blob& result, const Blob& log, std::size_t landmarks) {
  Associations associations(log.Texts("robots").size());
  for (std::size_t r = 0; r < associations.size(); ++r) {
    const std::size_t rows = ObservationCount(log, r);
    const std::string name = ObservationsOf(r) + "map_landmark";
    if (rows > 0 || result.Has(name)) associations[r] = ReadIndices(result, name, rows, landmarks);
  }
  return associations;
}

std::optional<Associations> ReadTrueAssociations(const Blob& log, std::size_t landmarks) {
  Associations associations(log.Texts("robots").size());
  bool complete = true;
  for (std::size_t r = 0; r < associations.size(); ++r) {
    const std::size_t rows = ObservationCount(log, r);
    const std::string name = "truth/" + ObservationsOf(r) + "landmark";
    if (log.Has(name))
      associations[r] = ReadIndices(log, name, rows, landmarks);
    else
      complete = complete && rows == 0;
  }
  if (!complete) return std::nullopt;
  return associations;
}

bool SamePartition(const Associations& map, const Associations& truth, std::size_t landmarks) {
  std::map<std::int32_t, std::int32_t> truth_of, map_of;
  for (std::size_t r = 0; r < map.size(); ++r) {
    for (std::size_t i = 0; i < map[r].size(); ++i) {
      const std::int32_t m = map[r][i], t = truth[r][i];
      if ((m < 0) != (t < 0)) return false;
      if (m < 0) continue;
      if (truth_of.try_emplace(m, t).first->second != t) return false;
      if (map_of.try_emplace(t, m).first->second != m) return false;
    }
  }
  return truth_of.size() == landmarks;
}

IndexPairs MajorityPairs(const Associations& map, const Associations& truth, std::size_t landmarks) {
  std::vector<std::map<std::int32_t, int>> votes(landmarks);
  for (std::size_t r = 0; r < map.size(); ++r) {
    for (std::size_t i = 0; i < map[r].size(); ++i) {
      if (map[r][i] >= 0 && truth[r][i] >= 0) ++votes[static_cast<std::size_t>(map[r][i])][truth[r][i]];
    }
  }
  IndexPairs pairs;
  for (std::size_t k = 0; k < landmarks; ++k) {
    int most = 0;
    std::int32_t winner = -1;
    for (const auto& [t, count] : votes[k]) {
      if (count > most) {
        most = count;
        winner = t;
      }
    }
    if (winner >= 0) pairs.emplace_back(k, static_cast<std::size_t>(winner));
  }
  return pairs;
}

}  // namespace cairn::datasets
