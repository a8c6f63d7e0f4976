#include "pipelines/landmark_map/estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "pipelines/landmark_map/model/work.h"

namespace cairn::landmark_map {
namespace {

constexpr double kCellMb = sizeof(double) / 1e6;
// What EM does, of simulated worlds: its iterations on all data until the first robot has settled, those on a
// finer grid than the search's, those of all robots, those after they were found apart, and the rounds at the
// end.
constexpr double kUsualIterations = 5.0, kOnFinerGrid = 4.0, kJoinedIterations = 4.0, kMoreAfterApart = 3.0,
                 kLastRounds = 2.0;
constexpr double kUsualWaves = 2.0, kRefits = 8.0, kNewStarts = 3.0;  // of the search; candidates a wave
constexpr double kTask_s = 2e-3;                                      // of each, whatever its size
constexpr double kSaved_s = 0.25;  // of a round: in a shorter one partials are not saved
// Observations that find a robot: with fewer its belief stays wide, and EM goes on for as long as it may.
constexpr std::size_t kTellAPose = 3;
constexpr double kFilled = 0.3;      // of a belief's boxes: the rest is zero, and not handed over
constexpr double kAhead = 16.0;      // partials that a worker fetches ahead of the one that it reads
constexpr double kProgramMb = 40.0;  // a worker that has done nothing yet, and its copy of the log
constexpr double kCacheMb = 512.0;   // what a worker keeps of blobs at most (--cache-mb)

// The slices of a round, in cells.
struct Slices {
  double tables = 0;  // alphas of the largest one
  double step = 0;    // largest belief
  double ends = 0;    // beliefs that one hands to the next, all together
  double counts = 0;  // of one landmark type, all together
};

Slices CutIntoSlices(const OpenLoop& loop, double slice_work) {
  Slices slices;
  double tables = 0, work = 0;
  Box box;
  for (std::size_t s = 0; s < loop.cells.size(); ++s) {
    const double here = loop.cells[s];
    const bool last = s + 1 == loop.cells.size();
    box = Union(box, loop.boxes[s]);
    tables += here;
    work += here + kStepCells;
    slices.step = std::max(slices.step, here);
    slices.tables = std::max(slices.tables, tables);
    if (work < slice_work && !last) continue;
    slices.ends += last ? 0.0 : here;
    slices.counts += static_cast<double>(box.cells());
    box = {};
    tables = work = 0;
  }
  return slices;
}

// Where by odometry the first robot may have stood when it saw landmarks, by their types: one with a name for
// the first time, those without one at any time.
std::map<std::int32_t, Box> SeenFrom(const RobotSteps& steps, const OpenLoop& loop, int names) {
  std::map<std::int32_t, Box> seen;
  for (int s = 0; s < steps.size(); ++s) {
    for (int k = steps.first_observation[s]; k < steps.first_observation[s + 1]; ++k) {
      const std::int32_t type = steps.observations[k].type;
      Box& from = seen[type];
      if (type >= names || from.empty()) from = Union(from, loop.boxes[static_cast<std::size_t>(s)]);
    }
  }
  return seen;
}

// The cells under each heading where a robot may start that may be anywhere: those from which its way leads
// to where the landmark may stand that it observes first. `seen`: as above; without one, a landmark that has
// a name stands in one place of the map, and others in any.
double PlacesWhereLost(const RobotSteps& steps, const Settings& settings,
                       const std::map<std::int32_t, Box>& seen, double map_cells) {
  if (steps.observations.empty()) return map_cells;
  const std::int32_t type = steps.observations[0].type;
  const bool named = type < settings.map.types && !settings.map.named_later;
  const auto from = seen.find(type);
  const double whole = std::sqrt(map_cells);
  constexpr double kReach = 7.0;  // standard deviations to both sides, of landmark and observation
  const double observed = 2.0 * kReach * settings.map.observation_m / settings.map.grid.cell_m;
  const double edge =
      from != seen.end() ? std::sqrt(static_cast<double>(from->second.cells())) : (named ? 0.0 : whole);
  return CellsWhereLost(steps, settings.Model(nullptr), std::min(std::hypot(observed, edge), whole));
}

// Ranges and bearings without names tell sooner than contact detections do where a robot is.
double StepsLost(const RobotSteps& steps, const Settings& settings) {
  constexpr double kAtADistance = 4.0;  // 2.5 to 4
  const bool soon = settings.gauge_free && steps.observations.size() >= kTellAPose;
  return std::min(soon ? kAtADistance : kStepsLost, static_cast<double>(steps.size()));
}

// A robot that may be anywhere: every heading of these places, and a slice holds a step at least.
Slices SlicesWhereLost(double places, const RobotSteps& steps, const Settings& settings, double slice_work) {
  const double step = places * settings.map.grid.headings;
  const double all = StepsLost(steps, settings) * step, tables = std::clamp(slice_work, step, all);
  return {tables, step, (all / tables - 1.0) * step, all / tables * places};
}

double TaskMb(const Slices& slices, double counts) {
  return kCellMb * (slices.tables + kBeliefCopies * slices.step + counts);
}

// Alphas and betas handed over, and counts.
double PartialsMb(const Slices& slices, double types) {
  return kCellMb * (2.0 * kFilled * slices.ends + types * slices.counts);
}

std::set<std::int32_t> TypesSeen(const std::vector<RobotSteps>& robots) {
  std::set<std::int32_t> types;
  for (const RobotSteps& steps : robots) {
    for (const Observation& seen : steps.observations) types.insert(seen.type);
  }
  return types;
}

Box GrownByRadius(const Box& box, const MapRules& rules) {
  return box.Grown(static_cast<int>(std::ceil(rules.radius_m / rules.grid.cell_m)));
}

// The same place where an edge has so many times as many cells.
Box OnFiner(const Box& box, double times) {
  const auto scaled = [&](std::int32_t cells) {
    return static_cast<std::int32_t>(std::lround(times * cells));
  };
  return {scaled(box.x0), scaled(box.y0), scaled(box.nx), scaled(box.ny)};
}

Box BoxOf(const LayeredGrid& grid) {
  Box box;
  for (const Layer& layer : grid.layers) box = Union(box, layer.box);
  return box;
}

// Cells that EM of the first robot moves from such a start on, after the first round.
double WorkFrom(Schedule schedule, const Options& options, const RobotSteps& robot,
                const Settings& settings) {
  if (schedule.summarises()) return 0.0;  // the first round is the last one
  const EStepModel model = settings.Model(nullptr);
  const bool named = settings.map.types > 0 && !settings.map.partly_named;  // others may be seen anywhere
  const double step = WorkOfStep(robot, model);
  // What one iteration sees for the first time is sharp in the map of the next but one.
  const auto in_a_map_of = [&](int sharp, int count) {
    return named ? WorkInAMapUpTo(sharp, count, step, robot, model) : count * step;
  };
  double work = 0.0;
  int sharp = 0, count = StepsInUse(schedule, robot.size());
  while (schedule.prefix < 1.0) {
    schedule = schedule.Next(options, 1, 0.0, 0.0);
    const int before = std::exchange(count, StepsInUse(schedule, robot.size()));
    work += in_a_map_of(sharp, count);
    sharp = before;
  }
  const double on_all = std::min(kUsualIterations, static_cast<double>(options.iterations));
  const double not_sharp = sharp > 0 && on_all > 0.0 ? in_a_map_of(sharp, count) - count * step : 0.0;
  return work + not_sharp + on_all * robot.size() * step;
}

double JoinedIterations(const Options& options, const Schedule& schedule) {
  const double apart = schedule.apart > 0 ? static_cast<double>(schedule.apart) + kMoreAfterApart : 0.0;
  return std::min(std::max(kJoinedIterations, apart), 1.0 + static_cast<double>(options.iterations));
}

// Of those, the ones in which a robot that may start anywhere looks for itself.
double RoundsLost(Schedule schedule, std::size_t robot, std::size_t robots, double joined) {
  schedule.robots = static_cast<std::int64_t>(robots);
  double lost = 0.0;
  for (schedule.settled = 0; static_cast<double>(schedule.settled) < joined; ++schedule.settled)
    lost += schedule.StartsNearby(robot) ? 0.0 : 1.0;
  return lost;
}

double WavesOf(const Options& options, const std::vector<cairn::Step>& starts) {
  return starts.size() < 2 ? 0.0 : std::min(kUsualWaves, static_cast<double>(options.waves));
}

// Seconds of the candidates of the search, or of the only start.
double SecondsOfSearch(const Options& options, const RobotSteps& robot, const Settings& settings,
                       double first_round_s, const std::vector<cairn::Step>& starts) {
  const auto count = static_cast<double>(starts.size());
  const EStepModel model = settings.Model(nullptr);
  const double cell_s = 1e-9 * CellNanoseconds(robot, model, true);
  const double step_s = cell_s * WorkOfStep(robot, model);
  double work = 0.0;
  for (const cairn::Step& start : starts)
    work += WorkFrom(Schedule::Load(start.plan.state()), options, robot, settings);
  const double all = first_round_s + cell_s * work;
  return all + WavesOf(options, starts) *
                   (kNewStarts / count * all + kRefits * kUsualIterations * robot.size() * step_s);
}

// Beliefs of one pass forward: by odometry alone until that first comes back to something, then in a map that
// is far from what EM would make of it, so that they lie, in ratio, between both.
OpenLoop ReckonOnePass(const RobotSteps& robot, OpenLoop loop, const EStepModel& model) {
  const double in_a_map = WorkOfStep(robot, model), cell_m = model.grid.cell_m;
  const int back = FirstReturn(robot, loop, model);
  for (int s = back; s < robot.size(); ++s) {
    const auto at = static_cast<std::size_t>(s);
    loop.cells[at] = std::min(loop.cells[at], std::sqrt(loop.cells[at] * in_a_map));
    // No wider than when it came back.
    const Box& widest = loop.boxes[static_cast<std::size_t>(back)];
    const Box here{static_cast<std::int32_t>(std::lround(robot.odo_x_m[s] / cell_m)),
                   static_cast<std::int32_t>(std::lround(robot.odo_y_m[s] / cell_m)), 1, 1};
    loop.boxes[at] = Intersection(loop.boxes[at], here.Grown(std::max(widest.nx, widest.ny) / 2 + 1));
  }
  return loop;
}

// Each observation makes a map.
double SecondsOfOnePass(const RobotSteps& robot, const OpenLoop& pass, const EStepModel& model,
                        double map_cells) {
  constexpr double kForward = 0.8;  // of what a cell takes over both passes of a slice
  constexpr double kMapNs = 30.0;   // of a cell of a map that is made
  double maps = 0.0;
  for (int s = 0; s < robot.size(); ++s)
    maps += robot.first_observation[s + 1] > robot.first_observation[s] ? 1.0 : 0.0;
  return 1e-9 * (kForward * CellNanoseconds(robot, model, false) * WorkOf(pass.cells, robot.size()) +
                 kMapNs * maps * map_cells);
}

double MStepMb(const Box& box, bool identified, const MapRules& rules) {
  if (box.empty()) return 0.0;
  return kMStepTables * kCellMb * static_cast<double>((identified ? box : GrownByRadius(box, rules)).cells());
}

}  // namespace

void Estimate::Store(State* state) const {
  auto& scalars = *state->mutable_scalars();
  scalars["expected/cells"].set_d(cells);
  scalars["expected/tasks"].set_d(tasks);
  scalars["expected/rounds"].set_d(rounds);
  scalars["expected/seconds"].set_d(seconds);
  scalars["expected/task_mb"].set_d(task_mb);
  scalars["expected/memory_mb"].set_d(memory_mb);
  scalars["expected/store_mb"].set_d(store_mb);
}

Estimate EstimateJob(const Options& options, const OnGrid& search, const OnGrid& last,
                     const std::vector<cairn::Step>& starts, const Perception* given) {
  const auto& [settings, robots] = search;
  const EStepModel model = settings.Model(nullptr);
  int used = 0;  // steps, in the first round of some start
  for (const cairn::Step& start : starts)
    used = std::max(used, StepsInUse(Schedule::Load(start.plan.state()), robots[0].size()));
  OpenLoop first = ReckonOpenLoop(robots[0], model, used);
  if (options.incremental) first = ReckonOnePass(robots[0], std::move(first), model);
  const std::set<std::int32_t> types = TypesSeen(robots);
  Box reach;
  for (const Box& box : first.boxes) reach = Union(reach, box);
  const auto layers = static_cast<double>(types.size());
  const double counts = layers * static_cast<double>(reach.cells());
  const double slice_work = 1e6 * options.slice_mcells;
  Estimate estimate;
  for (const cairn::Step& start : starts) {
    estimate.cells += RobotStates::Load(start.plan.state(), robots.size()).work[0];
    estimate.tasks += start.plan.tasks_size();
  }
  const bool only_round = options.iterations == 0;
  estimate.rounds = only_round ? 1.0 : (1.0 + RoundsLater(starts[0].plan)) * (1.0 + WavesOf(options, starts));
  const auto step_s = [](const RobotSteps& robot, const EStepModel& on) {
    return 1e-9 * CellNanoseconds(robot, on, true) * WorkOfStep(robot, on);
  };
  const double first_round_s = 1e-9 * CellNanoseconds(robots[0], model, false) * estimate.cells;
  estimate.seconds = SecondsOfSearch(options, robots[0], settings, first_round_s, starts);
  const Schedule schedule = Schedule::Load(starts[0].plan.state());
  const double joined = JoinedIterations(options, schedule);
  const bool finer = last.settings.map.grid.cell_m < settings.map.grid.cell_m;
  const EStepModel last_model = last.settings.Model(nullptr);
  for (std::size_t r = 0; r < robots.size() && !only_round; ++r) {
    const RobotSteps& robot = last.robots[r];
    const double alone = r == 0 && finer ? kOnFinerGrid : 0.0;
    const double rounds = kLastRounds + alone + (robots.size() > 1 ? joined : 0.0);
    estimate.seconds += rounds * (robot.size() * step_s(robot, last_model) + kTask_s);
  }
  const Slices slices = CutIntoSlices(first, options.incremental ? HUGE_VAL : slice_work);
  estimate.task_mb = TaskMb(slices, counts);
  const auto candidates = static_cast<double>(starts.size());
  double partials = candidates * PartialsMb(slices, layers), partials_where_lost = 0.0;
  double largest = slices.step;
  // Robots join on the grid on which EM ends.
  const double cells = settings.map.grid.cell_m / last.settings.map.grid.cell_m;
  std::map<std::int32_t, Box> seen;
  if (given == nullptr) seen = SeenFrom(robots[0], first, settings.map.types);
  for (auto& [type, from] : seen) from = OnFiner(from, cells);
  const auto map = static_cast<double>(
      (given != nullptr ? BoxOf(given->likelihood) : GrownByRadius(OnFiner(reach, cells), last.settings.map))
          .cells());
  // The first one's frame is loose once others join.
  const bool all_anywhere = options.start == "anywhere" || (settings.gauge_free && robots.size() > 1);
  const bool few = std::ranges::any_of(
      robots, [](const RobotSteps& robot) { return robot.observations.size() < kTellAPose; });
  double lost_round_s = 0.0;
  for (std::size_t r = all_anywhere ? 0 : 1; r < robots.size(); ++r) {
    const RobotSteps& robot = last.robots[r];
    const double places = PlacesWhereLost(robot, last.settings, seen, map);
    const Slices lost = SlicesWhereLost(places, robot, last.settings, slice_work);
    estimate.task_mb = std::max(estimate.task_mb, TaskMb(lost, counts));
    largest = std::max(largest, lost.step);
    const double round_s =
        1e-9 * CellNanoseconds(robot, last_model, false) * StepsLost(robot, last.settings) * lost.step;
    lost_round_s += round_s;
    estimate.seconds += (few ? 1.0 + static_cast<double>(options.iterations)
                             : RoundsLost(schedule, r, robots.size(), joined)) *
                        round_s;
    partials_where_lost += PartialsMb(lost, layers);
  }
  const double ahead =
      std::min(std::max(partials, partials_where_lost), kAhead * kFilled * kCellMb * largest);
  partials = std::max(partials, partials_where_lost);
  // A short round is not saved with its partials.
  const double saved = std::max(first_round_s, lost_round_s) < kSaved_s ? 0.0 : partials;
  double m_step = 0.0;
  for (const std::int32_t type : types) m_step += MStepMb(reach, type < settings.map.types, settings.map);
  estimate.task_mb = std::max(estimate.task_mb, m_step);
  estimate.memory_mb = estimate.task_mb + std::min(kCacheMb, 2.0 * partials) + ahead + kProgramMb;
  estimate.store_mb = (only_round ? 1.0 : 2.0) * (saved + candidates * 2.0 * kCellMb * counts);
  if (options.incremental) {
    const auto cells = static_cast<double>(GrownByRadius(reach, settings.map).cells());
    estimate.cells = WorkOf(first.cells, used);
    estimate.seconds = SecondsOfOnePass(robots[0], first, model, layers * cells);
  }
  return estimate;
}

std::string Sentence(const Estimate& estimate, const Settings& settings, const RobotStates& robot_states) {
  return fmt::format(
      "planned: cells of {:g} m, {} headings, {} steps of the first robot, {:.0f} tasks in the first of some "
      "{:.0f} rounds, which moves about {:.3g} million cells: some {:.2g} s on one core; a worker may need "
      "{:.0f} MB, the store {:.0f} MB",
      settings.map.grid.cell_m, settings.map.grid.headings, robot_states.step_counts[0], estimate.tasks,
      estimate.rounds, estimate.cells / 1e6, estimate.seconds, estimate.memory_mb, estimate.store_mb);
}

double MStepBytes(const LayeredGrid& counts, const MapRules& rules) {
  double megabytes = 0.0;
  for (std::size_t type = 0; type < counts.layers.size(); ++type) {
    megabytes += MStepMb(counts.layers[type].box, static_cast<int>(type) < rules.types, rules);
  }
  return 1e6 * megabytes;
}

}  // namespace cairn::landmark_map
