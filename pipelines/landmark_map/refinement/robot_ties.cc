#include "pipelines/landmark_map/refinement/robot_ties.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <span>
#include <string>

#include "schema/kinds/few_in_common.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::landmark_map {
namespace {

using Rows = std::vector<std::vector<PlacedRow>>;
using Robots = std::vector<std::size_t>;

Submap SubmapOfRobots(const Rows& rows, const Robots& robots) {
  std::vector<std::span<const PlacedRow>> of;
  for (const std::size_t r : robots) of.emplace_back(rows[r]);
  return SubmapOf(of);
}

// Names of two landmarks or more that both have given say how two submaps lie to one another.
bool NamesInCommon(const Submap& one, const Submap& base, const std::vector<bool>& named) {
  constexpr std::int64_t kEnough = 2;
  return std::ranges::count_if(one.landmarks, [&](const Submap::Seen& seen) {
           if (!named[static_cast<std::size_t>(seen.landmark)] || !seen.told) return false;
           const auto other = std::ranges::find(base.landmarks, seen.landmark, &Submap::Seen::landmark);
           return other != base.landmarks.end() && other->told;
         }) >= kEnough;
}

Tie TieOf(const Submap& one, const Submap& base, const std::vector<bool>& named, double sigma_m) {
  Tie tie;
  tie.shared = std::ranges::count_if(one.landmarks, [&](const Submap::Seen& seen) {
    return std::ranges::find(base.landmarks, seen.landmark, &Submap::Seen::landmark) != base.landmarks.end();
  });
  const bool by_names = NamesInCommon(one, base, named);
  if (by_names && std::ranges::all_of(named, std::identity())) return tie;
  const Placings placings = FindPlacings(one, base, sigma_m);
  // Names that were exchanged lead a robot elsewhere: the landmarks without say so.
  if (by_names && placings.LeadNats() > -kTiedNats) return tie;
  tie.one_sided = static_cast<std::int64_t>(placings.here.contradicted);
  tie.lead_nats = placings.LeadNats();
  tie.odds_nats = placings.OddsNats();
  return tie;
}

std::vector<bool> Named(const std::vector<Landmark>& landmarks, int names) {
  std::vector<bool> named;
  for (const Landmark& landmark : landmarks) named.push_back(landmark.type < names);
  return named;
}

// The landmarks of both submaps, those of the one moved; what they have in common then is one landmark.
std::vector<Landmark> Joined(const Submap& one, const Submap& base, const Placing& placing,
                             const std::vector<Landmark>& landmarks, double sigma_m) {
  std::vector<Landmark> joined;
  const auto add = [&](const Submap::Seen& seen, Point at) {
    Landmark landmark = landmarks[static_cast<std::size_t>(seen.landmark)];
    landmark.x_m = at.x_m;
    landmark.y_m = at.y_m;
    landmark.count = static_cast<double>(seen.count);
    landmark.covariance_m2[0] = landmark.covariance_m2[3] = sigma_m * sigma_m / 2;
    landmark.covariance_m2[1] = landmark.covariance_m2[2] = 0;
    joined.push_back(landmark);
  };
  for (const Submap::Seen& seen : base.landmarks) add(seen, {seen.x_m, seen.y_m});
  for (std::size_t i = 0; i < one.landmarks.size(); ++i) {
    const Submap::Seen& seen = one.landmarks[i];
    const Pose moved = Compose(placing.at, {seen.x_m, seen.y_m, 0});
    const auto pair = std::ranges::find(placing.pairs, i, &std::pair<std::size_t, std::size_t>::first);
    if (pair == placing.pairs.end()) {
      add(seen, {moved.x_m, moved.y_m});
      continue;
    }
    Landmark& both = joined[pair->second];
    const double share = static_cast<double>(seen.count) / (both.count + static_cast<double>(seen.count));
    both.x_m += share * (moved.x_m - both.x_m);
    both.y_m += share * (moved.y_m - both.y_m);
    both.count += static_cast<double>(seen.count);
    // A name, where one side gives it.
    both.type = std::min(both.type, landmarks[static_cast<std::size_t>(seen.landmark)].type);
  }
  return joined;
}

bool HoldTogether(const Submap& one, const Submap& base, const std::vector<bool>& named, double sigma_m) {
  return NamesInCommon(one, base, named) || PlacingHere(one, base, sigma_m).nats >= kTiedNats;
}

// Of robots each of which holds together with those before it.
std::vector<Robots> GroupsOf(const Rows& rows, const std::vector<bool>& named, double sigma_m) {
  Robots left(rows.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  std::vector<Robots> groups;
  while (!left.empty()) {
    groups.push_back({left.front()});
    left.erase(left.begin());
    for (std::size_t k = 0; k < left.size();) {
      if (!HoldTogether(SubmapOfRobots(rows, {left[k]}), SubmapOfRobots(rows, groups.back()), named,
                        sigma_m)) {
        ++k;
        continue;
      }
      groups.back().push_back(left[k]);
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(k));
      k = 0;
    }
  }
  return groups;
}

// Contact detections, each where its landmark is.
Rows ContactRows(const kinds::Log& log, const std::vector<RowAssociations>& rows,
                 const std::vector<Landmark>& landmarks) {
  Rows placed(rows.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const kinds::Log::Observations& seen = log.robot[r].observations;
    for (std::size_t i = 0; i < rows[r].landmark.size(); ++i) {
      if (rows[r].landmark[i] < 0 || rows[r].probability[i] < 0.5 || !std::isnan(seen.range_m[i])) continue;
      const Landmark& landmark = landmarks[static_cast<std::size_t>(rows[r].landmark[i])];
      placed[r].push_back({seen.time_s[i],
                           {landmark.x_m, landmark.y_m, 0},
                           0,
                           0,
                           rows[r].landmark[i],
                           seen.landmark[i] >= 0});
    }
  }
  return placed;
}

// How far off a landmark may be in another part of the map: as it is by the map's own account, twice.
double ContactTieSigma_m(const std::vector<Landmark>& landmarks, const ObservationNoise& noise) {
  double variance_m2 = 0;
  for (const Landmark& landmark : landmarks)
    variance_m2 += (landmark.covariance_m2[0] + landmark.covariance_m2[3]) / 2;
  return std::hypot(
      noise.contact_m,
      std::sqrt(2 * variance_m2 / static_cast<double>(std::max<std::size_t>(1, landmarks.size()))));
}

void PutTiesOfRobots(const std::vector<Tie>& ties, Blob* result) {
  for (std::size_t r = 0; r < ties.size() && ties.size() > 1; ++r) {
    const std::string prefix = "robot/" + std::to_string(r) + "/";
    result->PutScalar<std::int64_t>(prefix + "shared_landmarks", ties[r].shared);
    if (ties[r].one_sided)
      result->PutScalar<std::int64_t>(prefix + "one_sided_landmarks", *ties[r].one_sided);
    if (ties[r].lead_nats) result->PutScalar<double>(prefix + "place_lead_nats", *ties[r].lead_nats);
    if (ties[r].odds_nats && std::isfinite(*ties[r].odds_nats))
      result->PutScalar<double>(prefix + "place_odds_nats", *ties[r].odds_nats);
  }
}

// Where the halves of a path have few landmarks in common these may tie them all the same.
void PutTieOfFewest(const kinds::Log& log, const Rows& placed, const std::vector<RowAssociations>& rows,
                    const std::vector<bool>& named, double sigma_m, Blob* result) {
  std::vector<std::span<const std::int32_t>> landmarks;
  for (const RowAssociations& of : rows) landmarks.emplace_back(of.landmark);
  const FewInCommon least = FindFewestInCommon(landmarks);
  if (!least.AreFew() || std::ranges::all_of(named, std::identity())) return;
  const double time_s = log.robot[least.robot].observations.time_s[least.number - 1];
  const Tie tie = TieAcross(time_s, placed[least.robot], named, sigma_m);
  if (tie.lead_nats && std::isfinite(*tie.lead_nats))
    result->PutScalar<double>("fit/few_common_lead_nats", *tie.lead_nats);
}

Robots Without(const Robots& robots, std::size_t robot) {
  Robots others = robots;
  std::erase(others, robot);
  return others;
}

}  // namespace

Rows PlacedRows(const kinds::Log& log, const JointRefinement& refined,
                const std::vector<RowAssociations>& rows, double until_s) {
  Rows placed(refined.paths.size());
  for (std::size_t r = 0; r < placed.size(); ++r) {
    const kinds::Log::Observations& seen = log.robot[r].observations;
    for (std::size_t i = 0; i < seen.time_s.size() && seen.time_s[i] <= until_s; ++i) {
      if (std::isnan(seen.range_m[i])) continue;
      const RefinedPath::Pose at = refined.paths[r].At(seen.time_s[i]);
      placed[r].push_back({seen.time_s[i],
                           {at.x_m, at.y_m, at.heading_rad},
                           seen.range_m[i] - refined.paths[r].errors().range_m,
                           seen.bearing_rad[i],
                           rows[r].landmark[i],
                           seen.landmark[i] >= 0});
    }
  }
  return placed;
}

double TieSigma_m(const Rows& rows, const ModelFit& fit) {
  // Of the difference of two, and a little for paths that are bent.
  constexpr double kOfBoth = 1.5;
  double range_m = 0, bearing_rad = 0, sum_m = 0, count = 0;
  for (const ModelFit::Width& width : fit.widths) {
    if (width.kind == "range") range_m = std::max(width.stated, width.found);
    if (width.kind == "bearing") bearing_rad = std::max(width.stated, width.found);
  }
  for (const std::vector<PlacedRow>& robot : rows) {
    for (const PlacedRow& row : robot) sum_m += row.range_m;
    count += static_cast<double>(robot.size());
  }
  return kOfBoth * std::hypot(range_m, count > 0 ? bearing_rad * sum_m / count : 0);
}

std::vector<Tie> TiesOfRobots(const Rows& rows, const std::vector<bool>& named, double sigma_m) {
  std::vector<Tie> ties(rows.size());
  if (rows.size() < 2) return ties;
  const std::vector<Robots> groups = GroupsOf(rows, named, sigma_m);
  const Robots& most = *std::ranges::max_element(groups, {}, &Robots::size);
  for (const Robots& group : groups) {
    if (&group == &most) continue;
    const Tie tie = TieOf(SubmapOfRobots(rows, group), SubmapOfRobots(rows, most), named, sigma_m);
    for (const std::size_t r : group) ties[r] = tie;
  }
  for (const std::size_t r : most) {
    if (most.size() == 1) continue;  // the others are tied to it
    ties[r] = TieOf(SubmapOfRobots(rows, {r}), SubmapOfRobots(rows, Without(most, r)), named, sigma_m);
  }
  return ties;
}

std::optional<std::vector<Landmark>> PlacedAnew(const Rows& rows, const std::vector<Landmark>& landmarks,
                                                int names, double sigma_m) {
  const std::vector<bool> named = Named(landmarks, names);
  std::vector<Robots> groups = GroupsOf(rows, named, sigma_m);
  const Robots most = *std::ranges::max_element(groups, {}, &Robots::size);
  // Those that do not hang together with the most; else each among the others.
  std::erase(groups, most);
  if (groups.empty() && most.size() > 1)
    for (const std::size_t r : most) groups.push_back({r});
  std::optional<std::vector<Landmark>> best;
  double most_nats = kTiedNats;
  for (const Robots& group : groups) {
    Robots others(rows.size());
    std::iota(others.begin(), others.end(), std::size_t{0});
    for (const std::size_t r : group) others = Without(others, r);
    const Submap one = SubmapOfRobots(rows, group), base = SubmapOfRobots(rows, others);
    const Placings placings = FindPlacings(one, base, sigma_m);
    if (NamesInCommon(one, base, named) || !placings.other) continue;
    const double nats = placings.other->nats - std::max(0.0, placings.here.nats);
    if (nats < most_nats) continue;
    most_nats = nats;
    best = Joined(one, base, *placings.other, landmarks, sigma_m);
  }
  return best;
}

Tie TieAcross(double time_s, const std::vector<PlacedRow>& rows, const std::vector<bool>& named,
              double sigma_m) {
  const auto after = std::ranges::find_if(rows, [&](const PlacedRow& row) { return row.time_s > time_s; });
  return TieOf(SubmapOf({std::span(rows.begin(), after)}), SubmapOf({std::span(after, rows.end())}), named,
               sigma_m);
}

void PutTies(const Blob& blob, const JointRefinement& refined, const std::vector<RowAssociations>& rows,
             const std::vector<Landmark>& landmarks, const Settings& settings, Blob* result) {
  const auto log = Read<kinds::Log>(blob);
  const std::vector<bool> named = Named(landmarks, settings.map.types);
  if (refined.paths.empty()) {
    const double sigma_m = ContactTieSigma_m(landmarks, settings.observation_noise);
    PutTiesOfRobots(TiesOfRobots(ContactRows(log, rows, landmarks), named, sigma_m), result);
    return;
  }
  const Rows placed = PlacedRows(log, refined, rows, settings.steps.until_s);
  const double sigma_m = TieSigma_m(placed, refined.fit);
  if (!(sigma_m > 0)) return;  // contact detections alone
  PutTiesOfRobots(TiesOfRobots(placed, named, sigma_m), result);
  PutTieOfFewest(log, placed, rows, named, sigma_m, result);
  kinds::LandmarkMap::Holes holes;
  std::vector<OdometryHole> found = FindOdometryHoles(blob);
  std::erase_if(found, [&](const OdometryHole& hole) {
    return !(hole.missing_m > 0) || hole.begin_s >= settings.steps.until_s;
  });
  if (found.empty()) return;
  std::vector<std::int64_t> shared;
  std::vector<double> lead_nats;
  for (const OdometryHole& hole : found) {
    const Tie tie = TieAcross(hole.begin_s + 0.5 * hole.length_s,
                              placed[static_cast<std::size_t>(hole.robot)], named, sigma_m);
    shared.push_back(tie.shared);
    lead_nats.push_back(tie.lead_nats.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  holes.robot = cairn::ColumnOf(found, &OdometryHole::robot);
  holes.from_s = cairn::ColumnOf(found, &OdometryHole::begin_s);
  holes.length_s = cairn::ColumnOf(found, &OdometryHole::length_s);
  holes.missing_m = cairn::ColumnOf(found, &OdometryHole::missing_m);
  holes.shared_landmarks = shared;
  holes.lead_nats = lead_nats;
  result->PutAll("holes/", BlobOf(holes));
}

}  // namespace cairn::landmark_map
