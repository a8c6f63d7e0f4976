#include "pipelines/landmark_map/refinement/all_rows.h"

#include <algorithm>
#include <utility>

#include "pipelines/landmark_map/refinement/robot_ties.h"
#include "pipelines/landmark_map/refinement/seen_briefly.h"

namespace cairn::landmark_map {
namespace {

// As stated, or as found where that is more.
ObservationNoise FoundNoise(ObservationNoise noise, const ModelFit& fit) {
  for (const ModelFit::Width& width : fit.widths) {
    if (width.kind == "range") noise.range_m = std::max(noise.range_m, width.found);
    if (width.kind == "bearing") noise.bearing_rad = std::max(noise.bearing_rad, width.found);
  }
  return noise;
}

// Leaves out the landmarks that are not kept; their rows are of none.
void Keep(const std::vector<bool>& keep, std::vector<Landmark>* landmarks,
          std::vector<RowAssociations>* rows) {
  std::vector<std::int32_t> now;
  std::vector<Landmark> kept;
  for (std::size_t l = 0; l < keep.size(); ++l) {
    now.push_back(keep[l] ? static_cast<std::int32_t>(kept.size()) : -1);
    if (keep[l]) kept.push_back((*landmarks)[l]);
  }
  *landmarks = std::move(kept);
  for (RowAssociations& robot : *rows) {
    for (std::int32_t& landmark : robot.landmark)
      landmark = landmark < 0 ? -1 : now[static_cast<std::size_t>(landmark)];
  }
}

// The share of rows that are of another landmark than before.
double ShareThatChanged(const std::vector<RowAssociations>& before,
                        const std::vector<RowAssociations>& after) {
  double changed = 0.0, all = 0.0;
  for (std::size_t r = 0; r < after.size(); ++r) {
    for (std::size_t i = 0; i < after[r].landmark.size(); ++i)
      changed += before[r].landmark[i] != after[r].landmark[i] ? 1.0 : 0.0;
    all += static_cast<double>(after[r].landmark.size());
  }
  return all > 0.0 ? changed / all : 0.0;
}

}  // namespace

JointRefinement RefineWithAllRows(const kinds::Log& log, const std::vector<AssociatedPath>& paths,
                                  const Settings& settings, std::vector<Landmark>* landmarks,
                                  std::vector<RowAssociations>* rows) {
  constexpr int kAgain = 2;
  constexpr double kSettled = 0.002;
  const double reach_m = 3.0 * settings.map.observation_m;
  std::vector<const kinds::Log::Observations*> seen;
  for (const kinds::Log::Robot& robot : log.robot) seen.push_back(&robot.observations);
  JointRefinement refined = RefineJointly(log, paths, *rows, settings, *landmarks);
  for (int k = 0; k < kAgain && refined.refused.empty(); ++k) {
    const ObservationNoise noise = FoundNoise(settings.observation_noise, refined.fit);
    const auto told_apart = [&](const std::vector<RowAssociations>& before,
                                const std::vector<Landmark>& among) {
      std::vector<RowAssociations> now;
      for (std::size_t r = 0; r < paths.size(); ++r)
        now.push_back(
            RowsSeenFrom(refined.paths[r], before[r], *seen[r], among, noise, settings.steps.until_s));
      return now;
    };
    std::vector<Landmark> kept = *landmarks, among = refined.landmarks;
    std::vector<RowAssociations> now = told_apart(*rows, among);
    const auto placed = PlacedRows(log, refined, now, settings.steps.until_s);
    // Where all have names, what is of none is what was left out, for its landmark was moved.
    const std::vector<Landmark> more =
        settings.map.types > 0 && !settings.map.partly_named
            ? std::vector<Landmark>()
            : FindSeenBriefly(placed, among, TieSigma_m(placed, refined.fit), reach_m, settings.map.types);
    if (!more.empty()) {
      kept.insert(kept.end(), more.begin(), more.end());
      among.insert(among.end(), more.begin(), more.end());
      now = told_apart(now, among);
    }
    const std::vector<bool> keep = WithoutDoubles(among, settings.map.types, seen, now, reach_m);
    if (std::ranges::find(keep, false) != keep.end()) {
      Keep(keep, &among, &now);
      now = told_apart(now, among);
      std::vector<RowAssociations> none;
      Keep(keep, &kept, &none);
    } else if (ShareThatChanged(*rows, now) <= kSettled) {
      break;
    }
    JointRefinement again = RefineJointly(log, paths, now, settings, kept);
    if (!again.refused.empty()) break;
    refined = std::move(again);
    *rows = std::move(now);
    *landmarks = std::move(kept);
  }
  return refined;
}

}  // namespace cairn::landmark_map
