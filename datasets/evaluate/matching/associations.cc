#include "datasets/evaluate/matching/associations.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace cairn::datasets {
namespace {

// As many as the log's observations of the robot.
std::vector<std::int32_t> Indices(const Column<std::int32_t>& indices, const kinds::Log::Robot& robot,
                                  std::size_t landmarks) {
  const std::size_t rows = robot.observations.time_s.OrNone().size();
  if (indices.size() != rows) {
    throw InputError("'" + indices.name() + "' has " + std::to_string(indices.size()) +
                     " rows; the log has " + std::to_string(rows) +
                     " observations of this robot: was it made from this log?");
  }
  for (std::size_t i = 0; i < rows; ++i) {
    if (indices[i] < -1 || indices[i] >= static_cast<std::int64_t>(landmarks)) {
      throw InputError("'" + indices.name() + "', row " + std::to_string(i) + ": landmark " +
                       std::to_string(indices[i]) + " of " + std::to_string(landmarks));
    }
  }
  return indices.vector();
}

bool HasObservations(const kinds::Log::Robot& robot) { return !robot.observations.time_s.OrNone().empty(); }

}  // namespace

Associations ReadMapAssociations(const kinds::LandmarkMap& map, const kinds::Log& log,
                                 std::size_t landmarks) {
  Associations associations(log.robot.size());
  for (std::size_t r = 0; r < associations.size(); ++r) {
    const Column<std::int32_t> none, &of = r < map.robot.size() ? map.robot[r].map_landmark : none;
    if (HasObservations(log.robot[r]) || of) associations[r] = Indices(of, log.robot[r], landmarks);
  }
  return associations;
}

std::optional<Associations> ReadTrueAssociations(const kinds::Log& log, std::size_t landmarks) {
  Associations associations(log.robot.size());
  for (std::size_t r = 0; r < associations.size(); ++r) {
    if (r < log.truth.robot.size() && log.truth.robot[r].landmark)
      associations[r] = Indices(log.truth.robot[r].landmark, log.robot[r], landmarks);
    else if (HasObservations(log.robot[r]))
      return std::nullopt;
  }
  return associations;
}

std::vector<std::vector<bool>> ReadLookedAt(const kinds::LandmarkMap& map, const Associations& of) {
  std::vector<std::vector<bool>> looked_at;
  for (std::size_t r = 0; r < of.size(); ++r) {
    std::vector<bool>& of_robot = looked_at.emplace_back();
    const std::span<const double> probability =
        r < map.robot.size() ? map.robot[r].probability.OrNone() : std::span<const double>();
    if (!probability.empty() && probability.size() != of[r].size())
      throw InputError("'" + map.robot[r].probability.name() + "' has " + std::to_string(probability.size()) +
                       " rows for " + std::to_string(of[r].size()) + " observations");
    for (std::size_t i = 0; i < of[r].size(); ++i)
      of_robot.push_back(of[r][i] >= 0 || (!probability.empty() && probability[i] > 0.0));
  }
  return looked_at;
}

std::vector<std::vector<bool>> ReadContacts(const kinds::Log& log, const Associations& map) {
  std::vector<std::vector<bool>> contacts;
  for (std::size_t r = 0; r < map.size(); ++r) {
    contacts.emplace_back(map[r].size(), true);
    const std::span<const double> range = log.robot[r].observations.range_m.OrNone();
    for (std::size_t i = 0; i < std::min(range.size(), map[r].size()); ++i)
      contacts[r][i] = std::isnan(range[i]);
  }
  return contacts;
}

namespace {

struct OfTruth {
  std::int64_t looked_at = 0, right = 0;  // observations; those in the map's landmark for it
};

// The true landmark of each of the map's; -1: it has no observation.
std::vector<std::int32_t> TruthOfEach(const Associations& map, const Associations& truth,
                                      std::size_t landmarks) {
  std::vector<std::int32_t> truth_of(landmarks, -1);
  for (const auto& [k, t] : MajorityPairs(map, truth, landmarks)) truth_of[k] = static_cast<std::int32_t>(t);
  return truth_of;
}

bool EachOfAnother(std::vector<std::int32_t> truth_of) {
  std::ranges::sort(truth_of);
  return (truth_of.empty() || truth_of.front() >= 0) &&
         std::ranges::adjacent_find(truth_of) == truth_of.end();
}

}  // namespace

TopologyScore ScoreTopology(const Associations& map, const std::vector<std::vector<bool>>& looked_at,
                            const std::vector<std::vector<bool>>& contacts, const Associations& truth,
                            std::size_t landmarks) {
  constexpr std::int64_t kOneIn = 20;
  const std::vector<std::int32_t> truth_of = TruthOfEach(map, truth, landmarks);
  TopologyScore score;
  std::map<std::int32_t, OfTruth> of_truth;
  std::int64_t wrong_contacts = 0, wrong_ranged = 0, ranged = 0;
  for (std::size_t r = 0; r < map.size(); ++r) {
    for (std::size_t i = 0; i < map[r].size(); ++i) {
      const std::int32_t m = map[r][i], t = truth[r][i];
      const bool right = m >= 0 && t >= 0 && truth_of[static_cast<std::size_t>(m)] == t;
      const bool left_out = m < 0 && t >= 0 && looked_at[r][i];
      score.associations += m >= 0 ? 1 : 0;
      score.wrong += m >= 0 && !right ? 1 : 0;
      if (contacts[r][i]) {
        wrong_contacts += (m >= 0 && !right) || left_out ? 1 : 0;
      } else if (m >= 0) {
        ++ranged;
        wrong_ranged += right ? 0 : 1;
      }
      if (t < 0) continue;
      ++score.observations;
      score.unused += m < 0 ? 1 : 0;
      of_truth[t].looked_at += looked_at[r][i] ? 1 : 0;
      of_truth[t].right += right ? 1 : 0;
    }
  }
  score.correct = EachOfAnother(truth_of) && wrong_contacts == 0 && kOneIn * wrong_ranged <= ranged &&
                  std::ranges::all_of(of_truth, [](const auto& landmark) {
                    return 2 * landmark.second.right > landmark.second.looked_at;
                  });
  return score;
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
