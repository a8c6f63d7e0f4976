#include "pipelines/landmark_map/refinement/moved_landmarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "pipelines/landmark_map/refinement/all_rows.h"
#include "schema/kinds/log.h"

namespace cairn::landmark_map {
namespace {

// When a landmark was seen, and where.
struct SeenAt {
  double time_s = 0;
  Point place;
};

// Of one type, by all robots, in the order of time.
std::vector<SeenAt> SeenOf(int type, const std::vector<AssociatedPath>& paths) {
  std::vector<SeenAt> seen;
  for (const AssociatedPath& path : paths) {
    const RobotSteps& steps = path.steps;
    for (std::size_t s = 0; s < path.x_m.size(); ++s) {
      const double cosine = std::cos(path.correction_rad[s]), sine = std::sin(path.correction_rad[s]);
      for (int k = steps.first_observation[s]; k < steps.first_observation[s + 1]; ++k) {
        const Observation& one = steps.observations[static_cast<std::size_t>(k)];
        if (one.type != type) continue;
        seen.push_back({steps.time_s[s],
                        {path.x_m[s] + cosine * one.x_m - sine * one.y_m,
                         path.y_m[s] + sine * one.x_m + cosine * one.y_m}});
      }
    }
  }
  std::ranges::stable_sort(seen, {}, &SeenAt::time_s);
  return seen;
}

// Of observations in the order of time, each in the first place or not: how many of the first lie on one side
// of the change, so that the fewest are on the wrong one.
std::size_t BestSplit(const std::vector<bool>& in_first, std::size_t* wrong) {
  auto now = static_cast<std::size_t>(std::ranges::count(in_first, true));
  std::size_t split = 0;
  *wrong = now;
  for (std::size_t i = 0; i < in_first.size(); ++i) {
    now = in_first[i] ? now - 1 : now + 1;
    if (now >= *wrong) continue;
    *wrong = now;
    split = i + 1;
  }
  return split;
}

// Nothing where its observations in the two places take turns.
std::optional<MovedLandmark> WhenMoved(const InTwoPlaces& landmark,
                                       const std::vector<AssociatedPath>& paths) {
  constexpr std::size_t kLeast = 4;
  constexpr double kMostWrong = 0.1;
  const std::vector<SeenAt> seen = SeenOf(landmark.type, paths);
  if (seen.size() < 2 * kLeast) return {};
  std::vector<bool> in_main, elsewhere;
  for (const SeenAt& one : seen) {
    in_main.push_back(DistanceM(one.place, landmark.main) < DistanceM(one.place, landmark.other));
    elsewhere.push_back(!in_main.back());
  }
  std::size_t wrong = 0, wrong_if_later = 0;
  std::size_t split = BestSplit(in_main, &wrong);
  const std::size_t split_if_later = BestSplit(elsewhere, &wrong_if_later);
  const bool main_is_first = wrong <= wrong_if_later;
  if (!main_is_first) split = split_if_later;
  const std::size_t before = split, after = seen.size() - split;
  if (static_cast<double>(std::min(wrong, wrong_if_later)) > kMostWrong * static_cast<double>(seen.size()) ||
      std::min(before, after) < kLeast || seen[split - 1].time_s >= seen[split].time_s)
    return {};
  return MovedLandmark{landmark.type, seen[split - 1].time_s, seen[split].time_s,
                       static_cast<std::uint8_t>(main_is_first ? 1 : 0)};
}

bool IsOneOf(int type, const std::vector<InTwoPlaces>& found) {
  return std::ranges::find(found, type, &InTwoPlaces::type) != found.end();
}

// The landmarks that are in one place, and were seen both before and after.
std::size_t CountStaying(const std::vector<InTwoPlaces>& found, const MovedLandmark& moved,
                         const std::vector<AssociatedPath>& paths, int types) {
  constexpr std::ptrdiff_t kLeast = 2;
  std::size_t staying = 0;
  for (int type = 0; type < types; ++type) {
    if (IsOneOf(type, found)) continue;
    const std::vector<SeenAt> seen = SeenOf(type, paths);
    const auto before =
        std::ranges::count_if(seen, [&](const SeenAt& s) { return s.time_s <= moved.until_s; });
    const auto after = std::ranges::count_if(seen, [&](const SeenAt& s) { return s.time_s >= moved.from_s; });
    staying += before >= kLeast && after >= kLeast;
  }
  return staying;
}

// Another landmark that stands, or stood, where this one does, or did.
bool TakesAnothersPlace(const InTwoPlaces& landmark, const std::vector<InTwoPlaces>& found,
                        const std::vector<Landmark>& landmarks, const MapRules& rules) {
  const double near_m = std::max(5.0 * rules.observation_m, 3.0 * rules.grid.cell_m);
  const auto is_near = [&](const Point& place) {
    return std::min(DistanceM(place, landmark.main), DistanceM(place, landmark.other)) < near_m;
  };
  return std::ranges::any_of(found,
                             [&](const InTwoPlaces& other) {
                               return other.type != landmark.type &&
                                      (is_near(other.main) || is_near(other.other));
                             }) ||
         std::ranges::any_of(landmarks, [&](const Landmark& other) {
           return other.type < rules.types && !IsOneOf(other.type, found) && is_near({other.x_m, other.y_m});
         });
}

std::string Reason(const InTwoPlaces& landmark, const MovedLandmark& moved) {
  return landmark.reason +
         fmt::format(
             "; it stands in one of them until {:.1f} s, and in the other from {:.1f} s on: if it was moved, "
             "give it another name from then on",
             moved.until_s, moved.from_s);
}

}  // namespace

std::vector<MovedLandmark> FindMoved(const std::vector<InTwoPlaces>& found,
                                     const std::vector<AssociatedPath>& paths,
                                     const std::vector<Landmark>& landmarks, const MapRules& rules) {
  std::vector<MovedLandmark> all;
  for (const InTwoPlaces& landmark : found) {
    const auto moved = WhenMoved(landmark, paths);
    if (!moved) throw InputError(landmark.reason);
    if (TakesAnothersPlace(landmark, found, landmarks, rules) ||
        CountStaying(found, *moved, paths, rules.types) <= 2 * found.size())
      throw InputError(Reason(landmark, *moved));
    all.push_back(*moved);
  }
  return all;
}

Blob WithoutLeftOut(Blob log, std::size_t robots, std::vector<MovedLandmark>* moved) {
  const auto before = Read<kinds::Log>(log);
  for (std::size_t r = 0; r < robots; ++r) {
    const kinds::Log::Observations& seen = before.robot[r].observations;
    std::vector<std::int32_t> landmark = seen.landmark.vector();
    for (std::size_t i = 0; i < landmark.size(); ++i) {
      const auto of = std::ranges::find(*moved, landmark[i], &MovedLandmark::type);
      if (of == moved->end() || !of->LeavesOut(seen.time_s[i])) continue;
      landmark[i] = -1;
      ++of->left_out;
    }
    log.PutVector(seen.landmark.name(), landmark);
  }
  return log;
}

std::vector<MovedLandmark> RefineAllThatStayed(const Blob& log, const std::vector<AssociatedPath>& paths,
                                               const Settings& settings,
                                               const std::vector<InTwoPlaces>& in_two_places, bool refines,
                                               std::vector<Landmark>* landmarks,
                                               std::vector<RowAssociations>* rows, JointRefinement* refined) {
  const std::vector<Landmark> of_em = *landmarks;
  const std::vector<RowAssociations> rows_of_em = *rows;
  const auto still = [&] {
    return StillInTwoPlaces(in_two_places, refines ? refined->landmarks : of_em,
                            refined->paths.empty() ? nullptr : &refined->fit);
  };
  if (refines) *refined = RefineWithAllRows(Read<kinds::Log>(log), paths, settings, landmarks, rows);
  std::vector<MovedLandmark> moved = FindMoved(still(), paths, of_em, settings.map);
  if (moved.empty()) return moved;
  const Blob stayed = WithoutLeftOut(log, paths.size(), &moved);
  if (!refines) return moved;
  *landmarks = of_em;
  *rows = rows_of_em;
  *refined = RefineWithAllRows(Read<kinds::Log>(stayed), paths, settings, landmarks, rows);
  if (!refined->paths.empty())
    for (const InTwoPlaces& landmark : still()) throw InputError(landmark.reason);
  return moved;
}

}  // namespace cairn::landmark_map
