// What the options and the log make of the settings (settings.h).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "pipelines/common/odometry.h"
#include "pipelines/landmark_map/model/work.h"
#include "pipelines/landmark_map/state/settings.h"
#include "schema/square.h"

namespace cairn::landmark_map {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

double NoiseParameter(const Column<double>& stated, double otherwise) {
  constexpr double kLargest = 1e3;  // m, rad, or a ratio: whoever errs more knows nothing
  if (stated.Or(0.0) > kLargest)
    throw InputError("the log's " + stated.name() + " is not a sensible figure (0 to 1000)");
  return stated.Or(otherwise);
}

// 1, 2 or 5 times a power of ten, the one nearest in ratio.
double RoundNumber(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  const double lead = value / power;
  return power * (lead < std::sqrt(2.0) ? 1 : lead < std::sqrt(10.0) ? 2 : lead < std::sqrt(50.0) ? 5 : 10);
}

double Extent(const Odometry& odometry) {
  const auto [x0, x1] = std::ranges::minmax(odometry.x_m);
  const auto [y0, y1] = std::ranges::minmax(odometry.y_m);
  return std::max(x1 - x0, y1 - y0);
}

// The time of the log's observation of this number, from 1 on, over all robots; infinite where it has no
// such.
double TimeOfObservation(const kinds::Log& log, std::int64_t number) {
  std::vector<double> times;
  for (const kinds::Log::Robot& robot : log.robot)
    times.insert(times.end(), robot.observations.time_s.begin(), robot.observations.time_s.end());
  if (number < 1 || number > static_cast<std::int64_t>(times.size()))
    return std::numeric_limits<double>::infinity();
  std::ranges::sort(times);
  return times[static_cast<std::size_t>(number - 1)];
}

// 360 degrees divided by a whole number, near `step_deg`.
int Headings(double step_deg) { return std::max(4, static_cast<int>(std::lround(360.0 / step_deg))); }

double HeadingStepDeg(const Options& options, const Sensing& sensing, double cell_m) {
  if (options.heading_deg > 0) return options.heading_deg;
  if (sensing.ranged == 0) return 5.0;
  // A landmark at the usual range should move by about a cell from one heading to the next.
  return std::clamp(cell_m / std::max(sensing.mean_range_m, 0.1) / kDegree, 1.0, 5.0);
}

// Starts spread over the drift that the log states.
bool TellsDrift(const kinds::Log& log) { return static_cast<bool>(log.noise.heading_drift_rad_per_m); }

// A 90th of the extent of the path, or of what a robot that hardly moves sees.
double ExtentCell(double extent_m, const Sensing& sensing) {
  const double seen_m = sensing.ranged > 0 ? sensing.mean_range_m : 0.0;
  return RoundNumber(std::max({extent_m, seen_m, 0.9}) / 90.0);
}

// Range-bearing observations without identity are told apart by where they are: a cell
// should not blur them further than the sensor does, but a fifth is as much as the time allows. Not where the
// log tells its drift.
double DefaultCell(const kinds::Log& log, const Sensing& sensing, double extent_m, double range_bearing_m) {
  const double cell_m = ExtentCell(extent_m, sensing);
  const bool identified = sensing.identified == sensing.observations;
  if (sensing.ranged == 0 || identified || TellsDrift(log) || !(range_bearing_m > 0.0)) return cell_m;
  return std::clamp(RoundNumber(range_bearing_m), 0.2 * cell_m, cell_m);
}

// Starts of a log of range-bearing observations that states no drift lie so far apart that hardly any robot
// drifts beyond them: EM follows what lies between. Those of contact detections must come near.
constexpr double kUnstatedDrift = 0.1 * kDegree, kUnstatedDriftSearched = 0.75 * kDegree;

double UnstatedDrift(const Sensing& sensing, int starts) {
  return starts > 1 && sensing.ranged > 0 ? kUnstatedDriftSearched : kUnstatedDrift;
}

// Over what distance a constant drift is unknown. Of several starts one is right to within a part of the
// drift: the distance between theirs, of which an even spread has 1/12 in square. Where nothing tells how
// much it drifts the starts may all lie beside it.
double DriftLength(const Options& options, const kinds::Log& log, const Sensing& sensing, int starts,
                   double cell_m) {
  if (options.drift_length_m > 0) return options.drift_length_m;
  const double length_m = 150.0 * cell_m;
  if (starts < 2 || !(TellsDrift(log) || sensing.ranged > 0)) return length_m;
  return std::min(1.0, Square(DriftStep(starts)) / 12.0) * length_m;
}

// What a log's odometry errs by over its extent is no more than what a small robot's does over that of a
// large hall: a robot that is driven over kilometres keeps its heading for longer. Beliefs of any heading
// would fill a map of that size. By how much less it drifts.
double ForLargeWorlds(const Sensing& sensing, double extent_m) {
  constexpr double kSmallRobots_m = 250.0;
  const bool named = sensing.identified == sensing.observations && sensing.ranged > 0;
  return named ? std::min(1.0, kSmallRobots_m / std::max(extent_m, kSmallRobots_m)) : 1.0;
}

// Odometry's errors where the log does not tell them. They are where EM starts and are estimated from there:
// with identities from far above, for a width too small loses robots for good and one too large costs time
// only. Without identities a large width lets landmarks be taken for one another.
void SetNoise(const Options& options, const kinds::Log& log, const Sensing& sensing, double extent_m,
              Settings* settings) {
  const double wide = sensing.identified == sensing.observations || sensing.ranged > 0 ? 3.0 : 1.0;
  const double scale = options.noise_scale;
  constexpr double kUsualWalk = 0.7 * kDegree, kUsualTurn = 0.02;
  const auto walk = [&](double unstated) {
    return NoiseParameter(log.noise.heading_walk_rad_per_sqrt_m, unstated) * scale;
  };
  const auto turn = [&](double unstated) { return NoiseParameter(log.noise.turn_ratio, unstated) * scale; };
  settings->expected_walk_rad_per_sqrt_m = walk(kUsualWalk);
  settings->expected_turn_ratio = turn(kUsualTurn);
  const double large = ForLargeWorlds(sensing, extent_m);
  const double drift =
      NoiseParameter(log.noise.heading_drift_rad_per_m, large * UnstatedDrift(sensing, settings->starts));
  settings->noise = {drift * scale, walk(std::sqrt(large) * wide * kUsualWalk),
                     DriftLength(options, log, sensing, settings->starts, settings->map.grid.cell_m),
                     NoiseParameter(log.noise.forward_ratio, 0.02) * scale, turn(wide * kUsualTurn)};
}

// A figure of a data sheet is not exact: what it calls impossible happens once in a hundred times.
ClassRules LandmarkClassesOf(const kinds::Log& log) {
  constexpr double kSurprise = 0.01, kUnstated = 0.1;
  constexpr std::size_t kMost = 256;  // each is a layer of the map
  ClassRules classes;
  if (log.types.OrNone().size() < 2) return classes;
  classes.count = static_cast<int>(log.types.size());
  const auto n = static_cast<std::size_t>(classes.count);
  if (n > kMost) throw InputError("the log has more than 256 types: are they identities (landmarks)?");
  const auto wrong = [&](double share) { return share / static_cast<double>(n); };
  classes.confusion.assign(n * n, wrong(kUnstated));
  for (std::size_t k = 0; k < n; ++k) classes.confusion[k * n + k] += 1.0 - kUnstated;
  const Column<double>& stated = log.noise.type_confusion;
  if (!stated) return classes;
  for (std::size_t k = 0; k < n; ++k) {
    double sum = 0.0;
    for (std::size_t j = 0; j < n; ++j) sum += stated[k * n + j];
    if (!(std::abs(sum - 1.0) < 1e-3))
      throw InputError("the log's " + stated.name() + " has a row that does not sum to 1");
    for (std::size_t j = 0; j < n; ++j)
      classes.confusion[k * n + j] = wrong(kSurprise) + (1.0 - kSurprise) * stated[k * n + j] / sum;
  }
  return classes;
}

std::set<std::int32_t> NamesOf(const kinds::Log::Robot& robot) {
  std::set<std::int32_t> names;
  for (const std::int32_t landmark : robot.observations.landmark.OrNone())
    if (landmark >= 0) names.insert(landmark);
  return names;
}

// Whether names do not say where some robot is in the first one's map: two do.
bool AnyJoinsByGeometry(const kinds::Log& log) {
  constexpr std::ptrdiff_t kEnough = 2;
  const std::set<std::int32_t> first = NamesOf(log.robot[0]);
  return std::any_of(log.robot.begin() + 1, log.robot.end(), [&](const kinds::Log::Robot& robot) {
    return std::ranges::count_if(NamesOf(robot), [&](std::int32_t k) { return first.contains(k); }) < kEnough;
  });
}

// What other sensors than buttons have in view nobody knows without the walls; a landmark that has a name is
// there.
Detection DetectionOf(const kinds::Log& log, const Sensing& sensing) {
  const Detection none;
  return {std::min(0.9, NoiseParameter(log.noise.false_ratio, none.false_ratio)),
          std::clamp(NoiseParameter(log.noise.miss_ratio, none.miss_ratio), 1e-3, 0.9),
          sensing.ranged == 0 && sensing.identified == 0};
}

// Of what has a name hardly any is false, however far the sensor sees: the rate is per area, and in what is
// in view it must not add up to more than a part of all. Or no observation says anything on wide cells.
double FalseRateOf(const Options& options, const Sensing& sensing) {
  constexpr double kMost = 0.3;
  if (sensing.identified < sensing.observations || sensing.ranged == 0) return options.false_rate_per_m2;
  const double view_m2 = std::numbers::pi * Square(sensing.mean_range_m);
  return std::min(options.false_rate_per_m2, kMost / view_m2);
}

// How far landmarks without identity reach, by the scale of the log: within a radius they contend for what
// was observed, within a core they are one. Those that images show beside each other keep their distance:
// what lies nearer together is of one landmark, though the robot's place was not known.
void SetReach(const Options& options, const Sensing& sensing, MapRules* map) {
  constexpr double kNotTold = 4.0;        // standard deviations within which two may be of one landmark
  constexpr double kContend = 2.0 / 3.0;  // of the distance between two
  const bool ranged = sensing.ranged > 0;
  const double not_told_m = kNotTold * map->observation_m;
  const double radius = ranged ? std::max(not_told_m, kContend * sensing.apart_m)
                               : RoundNumber(kContend * std::max(sensing.between_m, 0.1));
  map->radius_m = options.radius_m > 0 ? options.radius_m : radius;
  map->core_m = options.core_m > 0 ? options.core_m : ranged ? not_told_m : 0.25 * map->radius_m;
}

// The part of the path on which odometry keeps its heading to within `most_rad`.
double TrustedShare(const Odometry& odometry, const MotionNoise& noise, double most_rad) {
  double variance = 0.0;
  for (std::size_t i = 1; i < odometry.path_m.size(); ++i) {
    const MotionIncrement increment{.path_m = odometry.path_m[i] - odometry.path_m[i - 1],
                                    .turn_rad = odometry.turn_rad[i] - odometry.turn_rad[i - 1]};
    variance += Square(ErrorOf(increment, noise).heading_rad);
    if (variance > most_rad * most_rad) return odometry.path_m[i] / odometry.path_m.back();
  }
  return 1.0;
}

// What no grid can hold, before anything is allocated. `extent_m`: of the first robot's odometry and what it
// can see from there.
void CheckGridSize(const Options& options, const Settings& settings, double extent_m, bool anywhere) {
  const double cell_m = settings.map.grid.cell_m;
  const double side = extent_m / cell_m + 1.0;
  const double layers = anywhere ? settings.map.grid.headings : 1.0;  // a start anywhere fills every heading
  const double megabytes = 3.0 * side * side * layers * sizeof(double) / 1e6;
  if (megabytes > options.memory_mb) {
    throw InputError(
        fmt::format("the grid would need about {:.0f} MB ({:.0f} x {:.0f} cells x {:.0f} headings), more "
                    "than memory_mb = {:.0f}: take a larger cell_m or heading_deg",
                    megabytes, side, side, layers, options.memory_mb));
  }
}

void CheckOptions(const Options& options, const Sensing& sensing) {
  if (options.model == "exact" && sensing.ranged > 0) {
    throw InputError("model exact is for contact detections; this log has ranges and bearings: take robust");
  }
  if (options.cell_m > 0 && options.cell_m < 1e-3) throw InputError("cell_m: 0, or at least 0.001 m");
  if (options.tables == "whole" && !(options.box_m > 0)) {
    throw InputError("tables whole are those of the box that robots never leave: say box_m");
  }
  if (options.heading_deg > 0 && options.heading_deg < 0.25) {
    throw InputError("heading_deg: 0, or at least 0.25 degrees");
  }
  if (options.growth_factor > 0 && options.growth_factor < 1.1) {
    throw InputError("growth_factor: 0, or at least 1.1");
  }
}

// Of several robots whose landmarks have no names and are seen at a distance.
bool FirstIsFoundOut(const kinds::Log& log, const Sensing& sensing) {
  return log.robot.size() > 1 && sensing.ranged > 0 && log.landmarks.empty();
}

// A log, and what is read off it before anything is decided.
struct Seen {
  kinds::Log log;
  Odometry odometry;             // the first robot's
  std::size_t may_be_first = 1;  // so many robots, from the log's first on
  double extent_m = 0.0;         // of the widest of these
  Sensing sensing;
  ObservationNoise stated, taken;  // as the log states them; as EM takes them for
  double default_cell_m = 0.0;
};

// Throws InputError where the log has no robots, or no observations of landmarks.
Seen ReadSeen(const Blob& blob) {
  Seen seen;
  seen.log = Read<kinds::Log>(blob);
  const kinds::Log& log = seen.log;
  if (log.robot.empty()) throw InputError("the log has no robots");
  seen.odometry = Integrate(log.robot[0].odometry, log.robots[0]);
  seen.sensing = LookAt(log);
  if (seen.sensing.observations == 0)
    throw InputError(log.robot[0].sensors.empty()
                         ? "the log has controls only: without observations there is no map"
                         : "the log has range scans and no observations of landmarks: evidence_map, "
                           "forward_map and local_map make maps of scans");
  if (FirstIsFoundOut(log, seen.sensing)) seen.may_be_first = log.robot.size();
  seen.extent_m = Extent(seen.odometry);
  for (std::size_t r = 1; r < seen.may_be_first; ++r)
    seen.extent_m = std::max(seen.extent_m, Extent(Integrate(log.robot[r].odometry, log.robots[r])));
  const double mean_range_m = seen.sensing.mean_range_m;
  const ObservationNoise usual{0.0, 0.03 * mean_range_m, 0.02};
  seen.stated = {0.0, NoiseParameter(log.noise.range_m, usual.range_m),
                 NoiseParameter(log.noise.bearing_rad, usual.bearing_rad)};
  const auto off_m = [&](const ObservationNoise& sd) {
    return std::hypot(sd.range_m, sd.bearing_rad * mean_range_m);
  };
  // What is exact draws EM from near by only: a slip's landmarks then stay beside those seen before it. The
  // least squares, which follows, has what is stated.
  const bool named = seen.sensing.identified == seen.sensing.observations;
  seen.taken = named || off_m(seen.stated) >= off_m(usual) ? seen.stated : usual;
  seen.default_cell_m = DefaultCell(log, seen.sensing, seen.extent_m, off_m(seen.taken));
  return seen;
}

// With how much of the data EM starts: as far as odometry can be trusted where landmarks contend over more
// than an observation's error, for then EM finds its way back from afar. Not where nothing is said of its
// drift: starts lie so far apart that all of a sparse log fits some wrong drift, and what is seen at a
// distance leads each from its beginning on.
double GrowthStart(const Options& options, const Seen& seen, const Settings& settings) {
  constexpr double kTrusted_rad = 24.0 * kDegree, kBeginning = 0.05;
  if (options.growth_start > 0) return options.growth_start;
  const Sensing& sensing = seen.sensing;
  const bool contend =
      sensing.identified < sensing.observations && settings.map.radius_m > settings.map.core_m;
  return sensing.ranged == 0 || (contend && TellsDrift(seen.log))
             ? TrustedShare(seen.odometry, settings.noise, kTrusted_rad)
             : kBeginning;
}

Settings ResolveWith(const Options& options, const Seen& seen, int starts) {
  const kinds::Log& log = seen.log;
  const Sensing& sensing = seen.sensing;
  const double extent = seen.extent_m;
  const std::size_t robots = log.robot.size();
  Settings settings;
  GridSpec& grid = settings.map.grid;
  grid.cell_m = options.cell_m > 0 ? options.cell_m : seen.default_cell_m;
  grid.headings = Headings(HeadingStepDeg(options, sensing, grid.cell_m));
  const double step_rad = 2.0 * std::numbers::pi / grid.headings;
  settings.map.types = static_cast<int>(log.landmarks.size());
  settings.map.classes = LandmarkClassesOf(log);
  settings.map.partly_named = sensing.identified > 0 && sensing.identified < sensing.observations;
  settings.map.named_later = settings.map.partly_named && NamesOf(log.robot[0]).empty();
  settings.joins_by_geometry = settings.map.partly_named && AnyJoinsByGeometry(log);
  if (options.model == "exact" && settings.map.classes.count > 1)
    throw InputError("model exact is for landmarks that look alike; this log has types: take robust");
  const auto at_mean_range_m = [&](const ObservationNoise& sd) {
    const double bearing_rad = sd.bearing_rad + step_rad / std::sqrt(12.0);
    return std::hypot(sd.range_m, bearing_rad * sensing.mean_range_m);
  };
  settings.map.observation_m =
      sensing.ranged == 0 ? NoiseParameter(log.noise.contact_m, 0.3) : at_mean_range_m(seen.taken);
  settings.in_image_m = at_mean_range_m(seen.stated);
  settings.observation_noise = {NoiseParameter(log.noise.contact_m, settings.map.observation_m),
                                seen.stated.range_m, seen.stated.bearing_rad};
  SetReach(options, sensing, &settings.map);
  settings.map.prior_count = options.model == "exact" ? 0.0 : options.prior_count;
  settings.map.no_landmark = sensing.ranged == 0 ? options.no_landmark : 0.0;
  settings.map.false_rate_per_m2 = FalseRateOf(options, sensing);
  settings.map.exact = options.model == "exact";

  settings.incremental = options.incremental;
  settings.gauge_free = robots > 1 && sensing.ranged > 0;
  settings.starts = starts;
  // Landmarks seen at a distance may stand closer than a cell is wide: single observations say little.
  settings.alike = sensing.ranged == 0 ? 0.99 : 0.95;
  SetNoise(options, log, sensing, extent, &settings);
  constexpr double kShortestIncrement = 0.1;  // cells: below, steps are many and say nothing
  if (options.max_increment_m > 0 && options.max_increment_m < kShortestIncrement * grid.cell_m) {
    throw InputError("max_increment_m: 0, or at least a tenth of a cell");
  }
  const double max_increment_m =
      options.max_increment_m > 0 ? options.max_increment_m : grid.cell_m / step_rad;
  settings.steps = {max_increment_m, 4.0 * grid.cell_m, 30.0 * kDegree, settings.map.types,
                    TimeOfObservation(log, options.prefix_observations)};
  settings.steps.classes = settings.map.classes.count;
  settings.detection = DetectionOf(log, sensing);
  settings.shape = options.motion_error == "triangular" ? ErrorShape::kTriangular : ErrorShape::kGaussian;
  settings.memory_mb = options.memory_mb;
  settings.prune = options.prune;
  settings.keep_kernels = options.keep_kernels;
  settings.whole_tables = options.tables == "whole";
  settings.box_m = options.box_m;
  settings.places = Square(extent / grid.cell_m + 1.0);
  constexpr double kFast = 2.0, kCareful = 1.3;  // a landmark that is not told must be recognised
  const bool careful = sensing.identified < sensing.observations;
  settings.growth_start = GrowthStart(options, seen, settings);
  settings.growth_factor = options.growth_factor > 0 ? options.growth_factor : careful ? kCareful : kFast;
  CheckGridSize(options, settings, extent + 2.0 * std::max(settings.map.radius_m, sensing.max_range_m),
                robots > 1 && sensing.ranged == 0);
  return settings;
}

// What a start should take: seconds of one core, for its E-steps on all data and on parts that grow to it,
// and observations that it looks at.
struct StartCost {
  double seconds = 0.0, observations = 0.0;
};

// The most that one of any robot that may be the first takes.
StartCost CostOfStart(const Settings& settings, const Seen& seen) {
  constexpr double kOnAllData = 5.0;
  const double growing =
      settings.growth_start < 1.0 ? 1.0 / (1.0 - 1.0 / settings.growth_factor) : 1.0;  // a geometric series
  const EStepModel model = settings.Model(nullptr);
  StartCost most;
  for (std::size_t r = 0; r < seen.may_be_first; ++r) {
    const RobotSteps steps = MakeSteps(seen.log.robot[r], seen.log.robots[r], settings.steps, nullptr);
    const double e_step_s =
        1e-9 * CellNanoseconds(steps, model, true) * WorkOfStep(steps, model) * steps.size();
    most.seconds = std::max(most.seconds, e_step_s * (growing + kOnAllData));
    most.observations = std::max(most.observations, static_cast<double>(steps.observations.size()));
  }
  return most;
}

// The same options on the grid that several starts are searched on: two and a half default cells are enough
// to find the basin, five are not (Victoria Park rolls up).
Options OnSearchGrid(const Options& options, const Seen& seen) {
  constexpr double kCoarser = 2.5;
  Options coarse = options;
  coarse.cell_m = std::min(ExtentCell(seen.extent_m, seen.sensing), kCoarser * seen.default_cell_m);
  if (options.cell_m >= coarse.cell_m) return options;
  coarse.heading_deg = 0.0;
  return coarse;
}

StartChoice ChooseFor(const Options& options, const Seen& seen) {
  constexpr int kMost = 10, kFewest = 5, kEachWay = kMost / 2 - 1;  // fewer tell too little of one another
  constexpr double kMost_s = 600.0, kMostObservations = 2e4;        // of all starts
  const Sensing& sensing = seen.sensing;
  if (options.starts > 0) return {static_cast<int>(options.starts), "as many as were asked for"};
  if (options.model == "exact") return {1, "under model=exact a start may be impossible"};
  if (sensing.identified == sensing.observations) return {1, "every observation names its landmark"};
  const Settings settings = ResolveWith(OnSearchGrid(options, seen), seen, kMost);
  const StartCost cost = CostOfStart(settings, seen);
  // Among hundreds of landmarks at a distance starts lose themselves, and take far longer than is reckoned.
  const double most = sensing.ranged > 0 ? kMostObservations : std::numeric_limits<double>::infinity();
  const double fit = std::min(kMost_s / cost.seconds, most / cost.observations);
  const double most_deg =
      DriftStep(kMost) * 0.5 * kEachWay * settings.noise.heading_drift_rad_per_m / kDegree;
  const std::string why = fmt::format(
      "observations name no landmark, and {} a drift of the heading: starts are spread over {:.3g} deg/m to "
      "either side",
      TellsDrift(seen.log) ? "the log states" : "the log does not state", most_deg);
  if (fit >= kMost) return {kMost, why};
  if (fit >= kFewest) return {static_cast<int>(fit), why + ", fewer than ten, for the log is long"};
  return {
      1, fmt::format(
             "observations name no landmark, but the log is long: {:.0f} of them in {:.3g} s a start, of one "
             "core; starts={} searches all the same",
             cost.observations, cost.seconds, kMost)};
}

}  // namespace

StartChoice ChooseStarts(const Options& options, const Blob& log) {
  return ChooseFor(options, ReadSeen(log));
}

Settings Resolve(const Options& options, const Blob& log) {
  const Seen seen = ReadSeen(log);
  CheckOptions(options, seen.sensing);
  return ResolveWith(options, seen, ChooseFor(options, seen).count);
}

Options ForSearch(const Options& options, const Blob& log) {
  const Settings asked = Resolve(options, log);
  if (asked.starts < 2) return options;
  const Options coarse = OnSearchGrid(options, ReadSeen(log));
  // Beyond that a map does not make the fine grid small enough: the job is reckoned, and refused, as it
  // stands.
  constexpr double kFinest = 1.0 / 25.0;
  const double ratio = asked.map.grid.cell_m / Resolve(coarse, log).map.grid.cell_m;
  return ratio < 1.0 && ratio >= kFinest ? coarse : options;
}

}  // namespace cairn::landmark_map
