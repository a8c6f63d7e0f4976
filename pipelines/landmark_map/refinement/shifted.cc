#include "pipelines/landmark_map/refinement/shifted.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <span>

#include "pipelines/common/odometry.h"
#include "pipelines/landmark_map/refinement/fitted_map.h"
#include "pipelines/landmark_map/refinement/robot_ties.h"

namespace cairn::landmark_map {
namespace {

constexpr std::size_t kLeast = 3;  // landmarks that meet another

using RobotRows = std::vector<PlacedRow>;

// What a robot saw in some time, and all that it saw otherwise.
struct Parts {
  Submap piece, rest;
};

Parts PartsOf(const RobotRows& rows, double from_s, double until_s) {
  const auto begin = std::ranges::lower_bound(rows, from_s, {}, &PlacedRow::time_s);
  const auto end = std::ranges::upper_bound(rows, until_s, {}, &PlacedRow::time_s);
  return {SubmapOf({std::span(begin, end)}),
          SubmapOf({std::span(rows.begin(), begin), std::span(end, rows.end())})};
}

double NatsOfParts(const RobotRows& rows, const Shift& shift, double sigma_m) {
  const Parts parts = PartsOf(rows, shift.from_s, shift.until_s);
  return PlacingHere(parts.piece, parts.rest, sigma_m).nats;
}

// A part that may have been shifted: between two long ways, or before the first; the shorter of the two.
struct Piece {
  double from_s, until_s, way_m;
  bool first = false;
};

std::vector<Piece> PiecesOf(const RobotRows& rows, const std::vector<double>& way_m) {
  constexpr std::size_t kMost = 3;
  std::vector<Piece> stretches;  // without a landmark in view
  std::optional<std::size_t> last;
  double first_s = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].landmark < 0) continue;
    if (!last) first_s = rows[i].time_s;
    if (last && rows[i].time_s > rows[*last].time_s)
      stretches.push_back({rows[*last].time_s, rows[i].time_s, way_m[i] - way_m[*last], false});
    last = i;
  }
  std::ranges::stable_sort(stretches, std::ranges::greater{}, &Piece::way_m);
  if (stretches.size() > kMost) stretches.resize(kMost);
  std::ranges::sort(stretches, {}, &Piece::from_s);
  std::vector<Piece> pieces;
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    pieces.push_back({first_s, stretches[k].from_s, stretches[k].way_m, true});
    for (std::size_t i = 0; i < k; ++i)
      pieces.push_back({stretches[i].until_s, stretches[k].from_s,
                        std::min(stretches[i].way_m, stretches[k].way_m), false});
  }
  return pieces;
}

Point Minus(const Submap::Seen& a, const Submap::Seen& b) { return {a.x_m - b.x_m, a.y_m - b.y_m}; }

Submap MovedBy(Submap submap, const Point& by) {
  for (Submap::Seen& seen : submap.landmarks) seen.x_m += by.x_m, seen.y_m += by.y_m;
  for (Submap::Look& look : submap.looks) look.from.x_m += by.x_m, look.from.y_m += by.y_m;
  return submap;
}

// From each landmark to its nearest neighbours.
std::vector<Point> ToNeighbours(const Parts& parts, double least_m, double most_m) {
  constexpr std::size_t kNearest = 4;
  std::vector<Point> all;
  for (const Submap::Seen& seen : parts.piece.landmarks) {
    std::vector<Point> to;
    for (const Submap::Seen& other : parts.rest.landmarks) {
      const Point by = Minus(other, seen);
      const double length_m = std::hypot(by.x_m, by.y_m);
      if (length_m > least_m && length_m <= most_m) to.push_back(by);
    }
    std::ranges::stable_sort(to, {}, [](const Point& by) { return std::hypot(by.x_m, by.y_m); });
    if (to.size() > kNearest) to.resize(kNearest);
    all.insert(all.end(), to.begin(), to.end());
  }
  return all;
}

// Whether enough landmarks of the piece are near one of the rest.
bool MostMeet(const Parts& parts, const Point& by, double gate_m) {
  std::size_t meet = 0;
  for (const Submap::Seen& seen : parts.piece.landmarks) {
    meet += std::ranges::any_of(parts.rest.landmarks, [&](const Submap::Seen& other) {
      const Point apart = Minus(other, seen);
      return std::hypot(apart.x_m - by.x_m, apart.y_m - by.y_m) <= gate_m;
    });
  }
  return meet >= kLeast && 3 * meet >= 2 * parts.piece.landmarks.size();
}

void AddShiftsOf(const Piece& piece, const RobotRows& rows, double sigma_m, std::vector<Shift>* shifts) {
  constexpr double kMostOfWay = 0.25, kGateSigmas = 3;
  const double gate_m = kGateSigmas * sigma_m;
  const Parts parts = PartsOf(rows, piece.from_s, piece.until_s);
  if (std::min(parts.piece.landmarks.size(), parts.rest.landmarks.size()) < kLeast) return;
  const Placing here = PlacingHere(parts.piece, parts.rest, sigma_m);
  std::set<std::vector<std::pair<std::size_t, std::size_t>>> seen;
  for (Point by : ToNeighbours(parts, gate_m, kMostOfWay * piece.way_m)) {
    if (!MostMeet(parts, by, gate_m)) continue;
    // As it lies best on what it meets.
    Placing there = PlacingHere(MovedBy(parts.piece, by), parts.rest, sigma_m);
    Point mean{0, 0};
    for (const auto& [i, j] : there.pairs) {
      const Point to = Minus(parts.rest.landmarks[j], parts.piece.landmarks[i]);
      const auto n = static_cast<double>(there.pairs.size());
      mean = {mean.x_m + to.x_m / n, mean.y_m + to.y_m / n};
    }
    by = mean;
    there = PlacingHere(MovedBy(parts.piece, by), parts.rest, sigma_m);
    const auto as_here = std::ranges::count_if(there.pairs, [&](const auto& pair) {
      return std::ranges::find(here.pairs, pair) != here.pairs.end();
    });
    if (2 * static_cast<std::size_t>(as_here) > there.pairs.size() || there.pairs.size() < kLeast) continue;
    std::ranges::sort(there.pairs);
    if (!seen.insert(there.pairs).second) continue;
    Shift shift{piece.from_s, piece.until_s, by, {}, here.nats - there.nats, piece.first};
    for (const auto& [i, j] : there.pairs)
      shift.meets.emplace_back(parts.piece.landmarks[i].landmark, parts.rest.landmarks[j].landmark);
    shifts->push_back(std::move(shift));
  }
}

// The map with what was seen in that time moved, fitted from there. Where the robot began it begins again.
FittedMap ShiftedBy(const Shift& shift, const kinds::Log& log, const Settings& settings,
                    const FittedMap& map) {
  FittedMap shifted{map.paths, map.refined.landmarks, map.rows, {}};
  const auto holds = [&](double time_s) { return time_s >= shift.from_s && time_s <= shift.until_s; };
  const auto time_s = log.robot[0].observations.time_s.values();
  std::vector<bool> elsewhere(map.landmarks.size(), false);  // it is seen out of that time, too
  for (std::size_t i = 0; i < time_s.size(); ++i)
    if (map.rows[0].landmark[i] >= 0 && !holds(time_s[i]))
      elsewhere[static_cast<std::size_t>(map.rows[0].landmark[i])] = true;
  std::map<std::int32_t, std::int32_t> now(shift.meets.begin(), shift.meets.end());
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    std::int32_t& landmark = shifted.rows[0].landmark[i];
    if (landmark < 0 || !holds(time_s[i])) continue;
    const auto [at, is_new] = now.try_emplace(landmark, landmark);
    if (is_new) {
      const auto k = static_cast<std::size_t>(landmark);
      if (elsewhere[k]) {
        at->second = static_cast<std::int32_t>(shifted.landmarks.size());
        const Landmark another = shifted.landmarks[k];
        shifted.landmarks.push_back(another);
      }
      Landmark& moved = shifted.landmarks[static_cast<std::size_t>(at->second)];
      moved.x_m += shift.by.x_m;
      moved.y_m += shift.by.y_m;
    }
    landmark = at->second;
  }
  const Point back = shift.first ? shift.by : Point{0, 0};
  for (Landmark& landmark : shifted.landmarks) {
    landmark.x_m -= back.x_m;
    landmark.y_m -= back.y_m;
  }
  AssociatedPath& path = shifted.paths[0];
  for (std::size_t s = 0; s < path.x_m.size(); ++s) {
    const double step_s = path.steps.time_s[s];
    const bool moves = holds(step_s) || (shift.first && step_s < shift.from_s);
    path.x_m[s] += (moves ? shift.by.x_m : 0) - back.x_m;
    path.y_m[s] += (moves ? shift.by.y_m : 0) - back.y_m;
  }
  shifted.refined = RefineWithAllRows(log, shifted.paths, settings, &shifted.landmarks, &shifted.rows);
  return shifted;
}

// By how many nats the map is ahead of the other one.
double LeadOver(const FittedMap& other, const FittedMap& map, const Shift& shift, const kinds::Log& log,
                const Settings& settings, double sigma_m) {
  const auto none = [](const FittedMap& of) {
    return kOfNoLandmark_nats * static_cast<double>(RowsOfNone(of.rows));
  };
  const auto in_common = [&](const FittedMap& of) {
    return NatsOfParts(PlacedRows(log, of.refined, of.rows, settings.steps.until_s)[0], shift, sigma_m);
  };
  return CostBeside(other.refined, map.refined) + none(other) - in_common(other) -
         CostBeside(map.refined, other.refined) - none(map) + in_common(map);
}

}  // namespace

std::vector<Shift> FindShifts(const RobotRows& rows, const std::vector<double>& way_m, double sigma_m) {
  constexpr std::size_t kMost = 4;
  constexpr double kMostBehind = 30;  // nats, which a least squares seldom makes up for
  std::vector<Shift> shifts;
  for (const Piece& piece : PiecesOf(rows, way_m)) AddShiftsOf(piece, rows, sigma_m, &shifts);
  std::erase_if(shifts, [](const Shift& shift) { return shift.behind_nats > kMostBehind; });
  std::ranges::stable_sort(shifts, {}, &Shift::behind_nats);
  if (shifts.size() > kMost) shifts.resize(kMost);
  return shifts;
}

std::optional<WeighedShift> WeighShifts(const kinds::Log& log, const std::vector<AssociatedPath>& paths,
                                        const Settings& settings, std::vector<Landmark>* landmarks,
                                        std::vector<RowAssociations>* rows, JointRefinement* refined) {
  constexpr int kRounds = 3;
  constexpr double kTaken_nats = 3;  // by less it is as likely EM's that is right
  const Odometry odometry = Integrate(log.robot[0].odometry, log.robots[0]);
  FittedMap map{paths, *landmarks, *rows, *refined};
  std::optional<WeighedShift> weighed;
  for (int round = 0; round < kRounds; ++round) {
    const RobotRows placed = PlacedRows(log, map.refined, map.rows, settings.steps.until_s)[0];
    const double sigma_m = TieSigma_m({placed}, map.refined.fit);
    if (!(sigma_m > 0)) break;
    std::vector<double> way_m;
    for (const PlacedRow& row : placed) way_m.push_back(PoseAt(odometry, row.time_s).path_m);
    std::optional<FittedMap> best;
    double least_nats = std::numeric_limits<double>::infinity();
    for (const Shift& shift : FindShifts(placed, way_m, sigma_m)) {
      FittedMap other = ShiftedBy(shift, log, settings, map);
      if (!other.refined.refused.empty()) continue;
      const double lead_nats = LeadOver(other, map, shift, log, settings, sigma_m);
      if (!(lead_nats < least_nats)) continue;
      least_nats = lead_nats;
      best = std::move(other);
      weighed = {shift.from_s, shift.until_s, std::hypot(shift.by.x_m, shift.by.y_m), lead_nats, round > 0};
    }
    if (!(least_nats < -kTaken_nats)) break;
    weighed->lead_nats = -least_nats;
    weighed->taken = true;
    map = std::move(*best);
    *landmarks = map.landmarks;
    *rows = map.rows;
    *refined = map.refined;
  }
  return weighed;
}

}  // namespace cairn::landmark_map
