#include "datasets/simulate/office/persons.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace cairn::datasets::office {
namespace {

constexpr double kEveryS = 40;  // somebody comes through the corridor
constexpr double kLookChance = 0.4;
constexpr double kBesideM = 0.75;  // of the corridor's axis
constexpr double kRobotRadiusM = 0.25;
constexpr double kComesFromM = 2;

std::optional<Point> At(const Walk& walk, double time_s) {
  if (walk.empty() || time_s < walk.front().time_s || time_s > walk.back().time_s) return std::nullopt;
  const auto after = std::ranges::find_if(walk, [&](const TimedPoint& p) { return p.time_s >= time_s; });
  if (after == walk.begin()) return after->at;
  const auto before = after - 1;
  const double share = (time_s - before->time_s) / (after->time_s - before->time_s);
  return Point{before->at.x_m + share * (after->at.x_m - before->at.x_m),
               before->at.y_m + share * (after->at.y_m - before->at.y_m)};
}

// From one end of the corridor to the other; who looks stops near where the robot is when they are there.
Walk DrawPassing(const Office& office, const Tour& tour, double time_s, Rng& rng) {
  const bool back = rng.Uniform() < 0.5;
  const double from = back ? office.to_x_m - 2.5 : office.from_x_m + 0.5;
  const double to = back ? office.from_x_m + 0.5 : office.to_x_m - 2.5;
  const double y = rng.Uniform() < 0.5 ? kBesideM : -kBesideM, speed_mps = rng.Uniform(0.7, 1.3);
  const double beside_m = rng.Uniform(-1, 1), stays_s = rng.Uniform(5, 25);
  const bool looks = rng.Uniform() < kLookChance;
  const auto tick = std::min(static_cast<std::size_t>(time_s / kTickS), tour.poses.size() - 1);
  const double stop = std::clamp(tour.poses[tick].x_m + beside_m, std::min(from, to), std::max(from, to));
  const double there_s = time_s + std::abs(stop - from) / speed_mps;
  const double leaves_s = there_s + (looks ? stays_s : 0);
  return {{time_s, {from, y}},
          {there_s, {stop, y}},
          {leaves_s, {stop, y}},
          {leaves_s + std::abs(to - stop) / speed_mps, {to, y}}};
}

Walk InTheWay(const Stop& stop) {
  constexpr double kWalkMps = 1;
  const Point away{stop.person.x_m + kComesFromM * std::cos(stop.heading_rad),
                   stop.person.y_m + kComesFromM * std::sin(stop.heading_rad)};
  const double walk_s = kComesFromM / kWalkMps;
  return {{stop.from_s - walk_s, away},
          {stop.from_s, stop.person},
          {stop.to_s - walk_s, stop.person},
          {stop.to_s, away}};
}

bool RunsIntoRobot(const Walk& walk, const Tour& tour) {
  for (std::size_t i = 0; i < tour.poses.size(); ++i) {
    const auto at = At(walk, tour.drive.times_s[i]);
    const Pose& robot = tour.poses[i];
    if (at && DistanceM(*at, {robot.x_m, robot.y_m}) < kRobotRadiusM + kPersonRadiusM) return true;
  }
  return false;
}

}  // namespace

std::vector<Walk> DrawWalks(const Office& office, const Tour& tour, Rng& rng) {
  std::vector<Walk> walks;
  for (const Stop& stop : tour.stops) walks.push_back(InTheWay(stop));
  const double end_s = tour.drive.times_s.back();
  const auto gap_s = [&] { return -kEveryS * std::log(1 - rng.Uniform()); };
  for (double time_s = gap_s(); time_s < end_s; time_s += gap_s()) {
    Walk walk = DrawPassing(office, tour, time_s, rng);
    if (!RunsIntoRobot(walk, tour)) walks.push_back(std::move(walk));
  }
  return walks;
}

std::vector<Point> PersonsAt(const std::vector<Walk>& walks, double time_s) {
  std::vector<Point> persons;
  for (const Walk& walk : walks) {
    if (const auto at = At(walk, time_s)) persons.push_back(*at);
  }
  return persons;
}

}  // namespace cairn::datasets::office
