#include "coordinator/cli/job_file/choose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "schema/error.h"
#include "schema/geometry.h"
#include "schema/kinds/log.h"
#include "schema/kinds/robots_without_observations.h"

namespace cairn::cli {
namespace {

// Up to so many readings are explained together; each takes some 50 µs of laser, several times that of sonar.
constexpr std::size_t kMostForwardReadings = 2'000'000;
constexpr double kMostCells = 4e6;
// A grid each of so many robots; of more nobody looks at all.
constexpr std::size_t kMostGrids = 10;
// A share of beams lost that is clearly more than forward_map takes for granted (its p_lost).
constexpr double kMuchLost = 0.015;
constexpr double kLaserCell_m = 0.05, kSonarCell_m = 0.1;  // the cone of a sonar is wider than any cell

// Beams of lasers beside two that return from about as far: glass, black things and doors that stand open
// have edges, and are wide; what a laser loses of itself, as on matt walls or in sunlight, lies anywhere.
struct Neighboured {
  std::size_t returned = 0, lost = 0;
  double LostShare() const {
    constexpr std::size_t kLeast = 200;
    const std::size_t all = returned + lost;
    return all < kLeast ? 0 : static_cast<double>(lost) / static_cast<double>(all);
  }
};

// Of all robots together, or of one.
struct Holdings {
  std::size_t robots = 0, with_scans = 0, with_poses = 0, observations = 0, named = 0, scans = 0,
              readings = 0;
  std::vector<std::string> sensors = {};  // each once
  Point low = {}, high = {};              // where robots went, by poses, else by odometry
  double reach_m = 0;                     // the middle range of the sensor that sees furthest
  double unseen_m = 0;                    // the longest way that a robot with scans observed no landmark
  double unplaced_m = 0;                  // that it observed no two at once, which tell where it was
  bool sees_two = false;                  // at once, at some time
  Neighboured neighboured = {};

  bool HasLaser() const {
    return std::ranges::any_of(sensors, [](const std::string& name) { return name.starts_with("laser"); });
  }
};

void Cover(const Pose& pose, Holdings* all) {
  all->low = {std::min(all->low.x_m, pose.x_m), std::min(all->low.y_m, pose.y_m)};
  all->high = {std::max(all->high.x_m, pose.x_m), std::max(all->high.y_m, pose.y_m)};
}

double MiddleRange(const kinds::Log::RangeSensor& sensor) {
  std::vector<double> ranges;
  for (const double range : sensor.range_m)
    if (kinds::IsEcho(range, sensor.max_range_m.Scalar())) ranges.push_back(range);
  if (ranges.empty()) return 0;
  const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2);
  std::ranges::nth_element(ranges, middle);
  return *middle;
}

void AddNeighboured(const kinds::Log::RangeSensor& sensor, Neighboured* all) {
  constexpr double kBeside_rad = 0.06, kFar = 0.8, kAlike = 0.1;
  const std::size_t beams = sensor.beam_heading_rad.size();
  const double reach_m = sensor.max_range_m.Scalar(), far_m = kFar * reach_m;
  const auto beside = [&](std::size_t a, std::size_t b) {
    return std::abs(WrapAngle(sensor.beam_heading_rad[a] - sensor.beam_heading_rad[b])) < kBeside_rad;
  };
  for (std::size_t b = 1; b + 1 < beams; ++b) {
    if (!beside(b - 1, b) || !beside(b, b + 1)) continue;
    for (std::size_t at = b; at < sensor.range_m.size(); at += beams) {
      const double before_m = sensor.range_m[at - 1], after_m = sensor.range_m[at + 1];
      // false for NaN, which is no return
      const bool alike =
          std::abs(before_m - after_m) < kAlike * before_m && before_m < far_m && after_m < far_m;
      if (alike) ++(kinds::IsEcho(sensor.range_m[at], reach_m) ? all->returned : all->lost);
    }
  }
}

void AddScans(const kinds::Log::Robot& robot, Holdings* all) {
  const std::size_t before = all->scans;
  for (const kinds::Log::RangeSensor& sensor : robot.sensors) {
    if (sensor.time_s.OrNone().empty() || sensor.range_m.OrNone().empty()) continue;
    all->scans += sensor.time_s.size();
    all->readings += sensor.range_m.size();
    if (sensor.sensor.starts_with("laser")) AddNeighboured(sensor, &all->neighboured);
    all->reach_m = std::max(all->reach_m, MiddleRange(sensor));
    if (std::ranges::find(all->sensors, sensor.sensor) == all->sensors.end())
      all->sensors.push_back(sensor.sensor);
  }
  if (all->scans > before) ++all->with_scans;
}

void AddPath(const kinds::Log::Robot& robot, Holdings* all) {
  if (!robot.poses.time_s.OrNone().empty()) {
    ++all->with_poses;
    for (const Pose& pose : robot.poses.poses()) Cover(pose, all);
    return;
  }
  Pose pose;
  for (std::size_t i = 0; i < robot.odometry.time_s.OrNone().size(); ++i) {
    pose = Compose(pose, {0, 0, robot.odometry.turn_rad[i]});
    pose = Compose(pose, {robot.odometry.forward_m[i], 0, 0});
    Cover(pose, all);
  }
}

// When as many landmarks or more were observed at once, in order.
std::vector<double> TimesOfObservations(const kinds::Log::Robot& robot, std::size_t at_once) {
  const auto times_s = robot.observations.time_s.OrNone();
  std::vector<double> all_s(times_s.begin(), times_s.end()), seen_s;
  std::ranges::sort(all_s);
  for (std::size_t i = at_once - 1; i < all_s.size(); ++i)
    if (all_s[i + 1 - at_once] == all_s[i]) seen_s.push_back(all_s[i]);
  return seen_s;
}

// By odometry, from the first row to the last.
double LongestWayWithoutObservation(const kinds::Log::Robot& robot, std::size_t at_once) {
  const std::vector<double> seen_s = TimesOfObservations(robot, at_once);
  double way_m = 0, longest_m = 0;
  auto next = seen_s.begin();
  for (std::size_t i = 0; i < robot.odometry.time_s.OrNone().size(); ++i) {
    const bool saw = next != seen_s.end() && *next <= robot.odometry.time_s[i];
    while (next != seen_s.end() && *next <= robot.odometry.time_s[i]) ++next;
    way_m += std::abs(robot.odometry.forward_m[i]);
    longest_m = std::max(longest_m, way_m);
    if (saw) way_m = 0;
  }
  return longest_m;
}

void Add(const kinds::Log::Robot& robot, Holdings* all) {
  ++all->robots;
  all->observations += robot.observations.time_s.OrNone().size();
  for (const std::int32_t landmark : robot.observations.landmark.OrNone()) all->named += landmark >= 0;
  const std::size_t before = all->with_scans;
  AddScans(robot, all);
  if (all->with_scans > before) {
    all->unseen_m = std::max(all->unseen_m, LongestWayWithoutObservation(robot, 1));
    all->unplaced_m = std::max(all->unplaced_m, LongestWayWithoutObservation(robot, 2));
    all->sees_two |= !TimesOfObservations(robot, 2).empty();
  }
  AddPath(robot, all);
}

Holdings Look(const kinds::Log& log) {
  Holdings all;
  for (const kinds::Log::Robot& robot : log.robot) Add(robot, &all);
  return all;
}

double CellOf(const Holdings& all) {
  const double width_m = all.high.x_m - all.low.x_m + 2 * all.reach_m;
  const double height_m = all.high.y_m - all.low.y_m + 2 * all.reach_m;
  double cell_m = all.HasLaser() ? kLaserCell_m : kSonarCell_m;
  while (width_m * height_m > kMostCells * cell_m * cell_m) cell_m *= 2;
  return cell_m;
}

proto::Stage& AddStage(const std::string& name, const std::string& pipeline, ChosenJob* chosen) {
  proto::Stage& stage = *chosen->job.add_stages();
  stage.set_name(name);
  stage.set_pipeline(pipeline);
  (*stage.mutable_inputs())["log"] = "log";
  return stage;
}

std::string Counted(std::size_t count, const std::string& what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string Listed(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

// Landmarks are mapped by odometry alone.
void CheckPaths(const kinds::Log& log, bool has_observations) {
  for (std::size_t r = 0; r < log.robot.size(); ++r) {
    if (!log.robot[r].odometry.time_s.OrNone().empty()) continue;
    const std::string robot = "robot '" + log.robots[r] + "' has ";
    if (has_observations)
      throw InputError(robot + "no odometry: a map of landmarks that were observed needs it");
    if (log.robot[r].poses.time_s.OrNone().empty())
      throw InputError(robot + "neither poses nor odometry: where it was is not known");
  }
}

// A grid, and whose scans and poses it is made of.
struct Grid {
  std::string name;
  std::string poses;              // a stage's; empty: the log's own
  std::string why = {};           // of that stage's
  std::optional<std::string> of;  // a robot alone; none: all
};

// Taken for what they seem to say, that there is nothing as far as the laser reaches, they would free what
// stands behind walls.
void TellOfLostBeams(const Holdings& holdings, proto::Stage* grid, std::string* reason) {
  const double lost = holdings.neighboured.LostShare();
  if (lost < kMuchLost) return;
  const bool forward = grid->pipeline() == "forward_map";
  const double p_lost = std::ceil(100 * std::min(lost, 0.5)) / 100;
  if (forward)
    (*grid->mutable_options())["p_lost"].set_d(p_lost);
  else
    (*grid->mutable_options())["use_no_return"].set_b(false);
  *reason += fmt::format("; {:.1f}% of the laser's beams between two that return do not, so {}", 100 * lost,
                         forward ? fmt::format("p_lost is {:g}", p_lost)
                                 : std::string("no beam without a return says that anything is free "
                                               "(use_no_return=false)"));
}

void ChooseGrid(const Holdings& holdings, const Grid& of, ChosenJob* chosen) {
  const bool forward = holdings.readings <= kMostForwardReadings;
  proto::Stage& grid = AddStage(of.name, forward ? "forward_map" : "evidence_map", chosen);
  const double cell_m = CellOf(holdings);
  (*grid.mutable_options())["cell_m"].set_d(cell_m);
  (*grid.mutable_options())["skip_unposed"].set_b(true);
  if (of.of) (*grid.mutable_options())["robots"].set_s(*of.of);
  if (!of.poses.empty()) (*grid.mutable_inputs())["poses"] = of.poses;
  chosen->reasons.push_back(fmt::format(
      "{}: {}, of {}{} in cells of {:g} m, with the poses of {}{}{}", of.name, grid.pipeline(),
      Counted(holdings.readings, "reading"), of.of ? " of robot '" + *of.of + "'" : "", cell_m,
      of.poses.empty() ? "the log" : "'" + of.poses + "'", of.why,
      forward ? ""
              : fmt::format("; forward_map, which explains readings together, would take long of more "
                            "than {}",
                            kMostForwardReadings)));
  TellOfLostBeams(holdings, &grid, &chosen->reasons.back());
}

// Of robots that nothing ties together: laid over each other their scans would be no map.
void ChooseGridOfEach(const kinds::Log& log, const Holdings& all, ChosenJob* chosen) {
  const std::string apart =
      fmt::format("nothing in the log says where its {} robots stand to each other", all.robots);
  if (all.with_scans > kMostGrids) {
    chosen->reasons.push_back(
        fmt::format("no grid: {}, and {} have scans: `cairn run forward_map LOG --input poses=path.h5 "
                    "--set robots=NAME` makes one of a robot",
                    apart, all.with_scans));
    return;
  }
  chosen->reasons.back() += "; " + apart + ", so each has a grid of its own";
  for (std::size_t r = 0; r < log.robot.size(); ++r) {
    Holdings one;
    Add(log.robot[r], &one);
    if (one.scans == 0) continue;
    ChooseGrid(one, {.name = fmt::format("grid_{}", r), .poses = "path", .why = {}, .of = log.robots[r]},
               chosen);
  }
}

// Two landmarks at once tell where a robot is; over a way so long odometry does between.
constexpr double kMostUnplaced_m = 10;

// Whether landmarks tell best where the robots were when they scanned: where they tie several together, where
// they are seen all along, or where there is no path of what was scanned itself. A laser shows walls all the
// time, a sonar hears less; between landmarks a path is that of odometry.
bool AreSeenAllAlong(const Holdings& all) { return all.sees_two && all.unplaced_m <= kMostUnplaced_m; }

bool LandmarksPlaceScans(const Holdings& all, bool has_poses) {
  constexpr double kMostUnseen_m = 20;
  return has_poses || all.with_scans > 1 || AreSeenAllAlong(all) ||
         (!all.HasLaser() && all.unseen_m <= kMostUnseen_m);
}

// Of the choice between landmarks and the path of a laser.
std::string WhyThosePoses(const Holdings& all) {
  if (AreSeenAllAlong(all))
    return fmt::format(", for it is never more than {:.1f} m between two landmarks at once and the next two",
                       all.unplaced_m);
  return all.HasLaser()
             ? fmt::format(", for there are {:.0f} m without two landmarks at once", all.unplaced_m)
             : "";
}

void ChooseGrids(const kinds::Log& log, const Holdings& all, ChosenJob* chosen) {
  const bool has_landmarks = all.observations > 0, has_poses = all.with_poses == all.robots;
  if (has_poses && !has_landmarks)
    chosen->reasons.push_back("path: the log has poses of its own, which are taken as they are");
  if (!has_poses) {
    AddStage("path", "local_map", chosen);
    chosen->reasons.push_back(
        fmt::format("path: local_map, of {} of {}", Counted(all.scans, "range scan"), Listed(all.sensors)));
  }
  if (!has_landmarks && !has_poses && all.with_scans > 1) return ChooseGridOfEach(log, all, chosen);
  std::string poses = has_poses ? "" : "path";
  if (has_landmarks && LandmarksPlaceScans(all, has_poses)) poses = "landmarks";
  const bool either = has_landmarks && !has_poses && all.with_scans == 1;
  const std::string why = either ? WhyThosePoses(all) : "";
  ChooseGrid(all, {.name = "grid", .poses = poses, .why = why, .of = {}}, chosen);
  if (either)
    chosen->reasons.back() += fmt::format("; `poses: {}` in the job file takes the other stage's",
                                          poses == "path" ? "landmarks" : "path");
}

}  // namespace

ChosenJob ChooseJob(const Blob& blob) {
  const auto log = Read<kinds::Log>(blob);
  const Holdings all = Look(log);
  if (all.observations == 0 && all.scans == 0)
    throw InputError(
        "the log has no observations of landmarks and no range scans: there is nothing to make a map of");
  CheckPaths(log, all.observations > 0);
  if (const auto unplaced = RobotsWithoutObservationsOf(blob); !unplaced.empty())
    throw InputError(unplaced.front());
  ChosenJob chosen;
  chosen.job.set_name("map");
  if (all.observations > 0) {
    AddStage("landmarks", "landmark_map", &chosen);
    chosen.reasons.push_back(fmt::format(
        "landmarks: landmark_map, of {} by {}; {}", Counted(all.observations, "observation"),
        Counted(all.robots, "robot"),
        all.named == 0                  ? "none says which landmark it is of"
        : all.named == all.observations ? "all say which landmark they are of"
                                        : fmt::format("{} say which landmark they are of", all.named)));
  }
  if (all.scans > 0) ChooseGrids(log, all, &chosen);
  return chosen;
}

}  // namespace cairn::cli
