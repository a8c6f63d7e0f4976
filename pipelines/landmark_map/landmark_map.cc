#include "pipelines/landmark_map/landmark_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "pipelines/common/fan_out.h"
#include "pipelines/landmark_map/beginning.h"
#include "pipelines/landmark_map/candidates.h"
#include "pipelines/landmark_map/contradictions.h"
#include "pipelines/landmark_map/e_step.h"
#include "pipelines/landmark_map/estimate.h"
#include "pipelines/landmark_map/m_step_task.h"
#include "pipelines/landmark_map/partial.h"
#include "pipelines/landmark_map/polish.h"
#include "pipelines/landmark_map/result.h"
#include "pipelines/landmark_map/round.h"
#include "pipelines/landmark_map/search.h"
#include "pipelines/landmark_map/slice_task.h"
#include "pipelines/landmark_map/speculation.h"
#include "pipelines/landmark_map/work.h"

namespace cairn::landmark_map {
namespace {

std::string RobotPath(std::size_t robot) { return "robot/" + std::to_string(robot) + "/"; }

// Which layers of the map a robot's observations may be of: any kind may seem another.
std::vector<bool> TypesSeen(const RobotSteps& robot, const MapRules& rules) {
  std::vector<bool> seen(static_cast<std::size_t>(rules.layers()), false);
  for (const Observation& o : robot.observations) seen[static_cast<std::size_t>(o.type)] = true;
  const auto kinds = seen.begin() + rules.types;
  if (std::find(kinds, seen.end(), true) != seen.end()) std::fill(kinds, seen.end(), true);
  return seen;
}

std::vector<bool> TypesIn(const LayeredGrid& map) {
  std::vector<bool> types;
  for (const Layer& layer : map.layers) types.push_back(!layer.box.empty());
  return types;
}

// Every robot's steps; those that start anywhere begin where they see what the first robot has seen too, or
// what the given map holds.
Carried MakeAllSteps(const Blob& log, const Options& options, const Beginning& beginning, cairn::Step* step,
                     std::vector<RobotSteps>* all) {
  const std::vector<std::string> robots = log.Texts("robots");
  const Settings& settings = beginning.settings;
  std::vector<bool> shared;
  if (beginning.given) shared = TypesIn(beginning.given->map);
  Carried carried;
  carried.blobs["settings"] = step->Share(settings.ToBlob());
  carried.odometry.assign(robots.size(), OdometryFit::Of(settings.noise));
  carried.overlap.assign(robots.size(), kOverlap);
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const bool anywhere = StartsAnywhere(options, r);
    const RobotSteps steps =
        MakeSteps(log.Sub(RobotPath(r)), robots[r], settings.steps, anywhere ? &shared : nullptr);
    if (shared.empty()) shared = TypesSeen(steps, settings.map);
    if (beginning.given && !anywhere) RefuseOutOfReach(beginning.given->map, steps, settings);
    carried.step_counts.push_back(steps.size());
    const int count = StepsInUse(beginning.schedule, steps.size());
    carried.work.push_back(anywhere && beginning.perception
                               ? WorkWhereLost(count, settings.Model(&*beginning.perception))
                               : WorkOf(ReckonOpenLoop(steps, settings.Model(nullptr), count).cells, count));
    carried.blobs["steps/" + std::to_string(r)] = step->Share(steps.ToBlob());
    all->push_back(steps);
  }
  return carried;
}

// Are there landmarks that no observation names?
bool WithoutIdentities(const std::vector<RobotSteps>& steps, const MapRules& rules) {
  return std::ranges::any_of(steps, [&](const RobotSteps& robot) {
    return std::ranges::any_of(robot.observations,
                               [&](const Observation& o) { return o.type >= rules.types; });
  });
}

// The round's own blobs of the first round.
std::map<std::string, Blob> FirstBlobs(const Beginning& beginning) {
  std::map<std::string, Blob> blobs{{"history", EmptyHistory()},
                                    {"counts", StoredCounts(NoCounts(beginning.settings.map))}};
  if (beginning.given) {
    blobs["landmarks"] = ToBlob(beginning.given->landmarks);
    blobs["perception"] = beginning.perception->ToBlob();
  } else if (beginning.schedule.summarise) {
    blobs["landmarks"] = ToBlob(std::vector<Landmark>{});
  }
  return blobs;
}

// The steps of all robots, of a State.
std::vector<RobotSteps> StepsOf(const Inputs& inputs, std::size_t robots) {
  std::vector<RobotSteps> steps;
  for (std::size_t r = 0; r < robots; ++r)
    steps.push_back(RobotSteps::FromBlob(*inputs.Get("steps/" + std::to_string(r))));
  return steps;
}

// What the next E-step of each robot should cost: what the last one did, or, of a robot that joins (or whose
// start becomes unknown as others do), what a search of the whole map takes.
std::vector<double> NextWork(const RoundSum& sum, const Schedule& done, const Schedule& next,
                             const std::vector<std::int64_t>& steps, bool loose_frame,
                             const EStepModel& model) {
  const std::int64_t placed = loose_frame && next.robots > done.robots ? 0 : done.robots;
  std::vector<double> work;
  for (std::size_t r = 0; r < steps.size(); ++r) {
    const int count = StepsInUse(next, steps[r]);
    work.push_back(static_cast<std::int64_t>(r) < placed ? sum.WorkOf(r) * count / StepsInUse(done, steps[r])
                                                         : WorkWhereLost(count, model));
  }
  return work;
}

// Which of the next round's slices are guessed, and from what; the overlap doubles where it was too short.
void PlanGuesses(const Options& options, const RoundSum& sum, const Schedule& next, Carried* carried,
                 std::map<std::string, Blob>* fresh, State* state) {
  for (std::size_t r = 0; options.speculate && r < static_cast<std::size_t>(next.robots); ++r) {
    if (TooShort(sum.guessed(r), sum.confirmed(r))) {
      carried->overlap[r] *= 2;
      continue;  // what this round left for guesses lies elsewhere
    }
    const Guesses& guesses = sum.GuessesOf(r);
    const std::vector<bool> worth =
        WorthGuessing(guesses, StepsInUse(next, carried->step_counts[r]), carried->overlap[r], next);
    if (std::find(worth.begin(), worth.end(), true) == worth.end()) continue;
    (*fresh)[kGuesses + std::to_string(r)] = guesses.ToBlob();
    GuessSlices(r, worth, state);
  }
}

// The first robot's EM has ended: what comes next is one map's affair.
bool SearchIsOver(const State& state) {
  const Schedule next = Schedule::Load(state);
  return next.summarise || next.robots > 1;
}

// Once, for maps that EM made of presses or of landmarks that are told apart. A given map has a frame of its
// own.
bool WantsPolish(const Options& options, const Settings& settings, const Schedule& done, const Inputs& inputs,
                 const std::vector<RobotSteps>& steps) {
  if (inputs.Has("map") || !options.polish || !options.revise || options.iterations == 0 || done.polished ||
      settings.map.exact)
    return false;
  for (const RobotSteps& robot : steps) {
    for (const Observation& seen : robot.observations) {
      if (seen.type >= settings.map.types && (seen.x_m != 0.0 || seen.y_m != 0.0)) return false;
    }
  }
  return true;
}

Blob RunTask(const Options& options, const Task& task, const Inputs& inputs, Progress& progress) {
  return task.kind() == "m_step" ? RunMStep(task, inputs) : RunSlice(options, task, inputs, progress);
}

// The last E-step's sum, which no map follows.
MStep Summary(Partials& partials, const Settings& settings, std::size_t robots) {
  MStep last{RoundSum(NoCounts(settings.map), robots), {}, {}};
  for (std::size_t i = 0; i < partials.size(); ++i) last.sum.Add(*partials.Get(i));
  return last;
}

// Throws NoPathError where a task of the round said so.
MStep MadeMap(const Blob& partial, std::size_t robots) {
  if (partial.Has(kFailure)) throw NoPathError(partial.Text(kFailure));
  return MStep::FromBlob(partial, robots);
}

std::string Note(const Schedule& done, double log_likelihood, std::size_t landmarks) {
  char text[160];
  std::snprintf(text, sizeof text,
                "iteration %lld: log-likelihood %.2f, %zu landmarks, %.0f%% of the data, %lld robot%s",
                static_cast<long long>(done.iteration + 1), log_likelihood, landmarks, 100.0 * done.prefix,
                static_cast<long long>(done.robots), done.robots == 1 ? "" : "s");
  return text;
}

}  // namespace

cairn::Step LandmarkMap::Start(const Inputs& inputs) const {
  const BlobPtr log = inputs.Get("log");
  const Options search = inputs.Has("map") ? options_ : ForSearch(options_, *log);
  if (search.cell_m != options_.cell_m) {  // the search tells nothing of what the finer grid takes
    const Settings fine = Resolve(options_, *log);
    RefuseMemory("the M-step", kMStepTables * sizeof(double) * fine.places, fine.memory_mb);
  }
  const Beginning beginning = BeginningOf(search, inputs);
  const Settings& settings = beginning.settings;
  const std::vector<std::string> robots = log->Texts("robots");
  std::vector<cairn::Step> starts(1);
  std::vector<RobotSteps> steps;
  Carried carried = MakeAllSteps(*log, options_, beginning, &starts[0], &steps);
  PlanRound(options_, robots, beginning.schedule, carried, FirstBlobs(beginning), &starts[0]);
  if (settings.starts > 1) {
    const State carried_state = starts[0].plan.state();
    const std::vector<StartingPoint> points = StartingPoints(settings);
    starts.resize(points.size());
    for (std::size_t k = 0; k < points.size(); ++k) {
      starts[k].plan.Clear();
      *starts[k].plan.mutable_state() = carried_state;
      BeginFrom(points[k], options_, robots, settings, steps[0], &starts[k]);
    }
  } else if (!inputs.Has("map") && options_.iterations > 0 && WithoutIdentities(steps, settings.map)) {
    (*starts[0].plan.mutable_state()->mutable_blobs())["search"] = starts[0].Share(OneStartOnly());
  }
  const Estimate estimate =
      EstimateJob(options_, settings, steps, starts, beginning.perception ? &*beginning.perception : nullptr);
  RefuseMemory("a task", 1e6 * estimate.task_mb, settings.memory_mb);
  cairn::Step step = starts.size() == 1 ? std::move(starts[0]) : FanOut(std::move(starts));
  estimate.Store(step.plan.mutable_state());
  step.plan.set_note(Sentence(estimate, settings, carried));
  return step;
}

// That no path fits one of several starts is that start's affair.
Blob LandmarkMap::Run(const Task& task, const Inputs& inputs, Progress& progress) const {
  if (!task.params().contains("start")) return RunTask(options_, task, inputs, progress);
  for (const proto::InputRef& input : task.inputs()) {
    if (input.has_task() && inputs.Get(input.name())->Has(kFailure)) return *inputs.Get(input.name());
  }
  try {
    return RunTask(options_, task, inputs, progress);
  } catch (const NoPathError& error) {
    Blob partial;
    partial.Put(kFailure, Array::Text(error.what()));
    return partial;
  }
}

cairn::Step LandmarkMap::Advance(const State& state, Partials& partials, const Inputs& inputs) const {
  return StartsIn(state) > 0 ? AdvanceSearch(state, partials, inputs) : AdvanceOne(state, partials, inputs);
}

cairn::Step LandmarkMap::AdvanceOne(const State& state, Partials& partials, const Inputs& inputs) const {
  const BlobPtr log = inputs.Get("log");
  const std::vector<std::string> robots = log->Texts("robots");
  const Settings settings = Settings::FromBlob(*inputs.Get("settings"));
  const Schedule done = Schedule::Load(state);
  Carried carried = Carried::Load(state, robots.size());

  const MStep m_step = done.summarise ? Summary(partials, settings, robots.size())
                                      : MadeMap(*partials.Get(partials.size() - 1), robots.size());
  const RoundSum& sum = m_step.sum;
  if (done.iteration == 0 && inputs.Has("map") && !settings.map.exact) {
    RefuseUnlikely(sum.log_likelihood(), Perception::FromBlob(*inputs.Get("perception")),
                   StepsOf(inputs, robots.size()));
  }
  const Blob& before = *inputs.Get("history");
  const auto robots_before = before.Get<std::int64_t>("robots");
  if (!robots_before.empty() && robots_before.back() < done.robots) {
    RefuseStrangers(sum, Perception::FromBlob(*inputs.Get("perception")), StepsOf(inputs, robots.size()),
                    robots);
  }
  const Blob history = Extended(before, done, sum);
  if (done.summarise) {
    const std::vector<RobotSteps> steps = StepsOf(inputs, robots.size());
    if (!done.polished) {
      RefuseSpoiltMap(sum, history, settings.places, steps[0].observations.size());
      RefuseTwoPlaces(sum.counts(), settings.map, log->Texts("landmarks"));
    }
    if (WantsPolish(options_, settings, done, inputs, steps)) {
      const std::vector<Landmark> landmarks = LandmarksFromBlob(*inputs.Get("landmarks"));
      if (const auto polished = Polish(SettledPaths(sum, steps, carried.odometry), settings, landmarks)) {
        return SummaryUnder(*polished, Recentred(sum.counts(), landmarks, *polished, settings.map), history,
                            sum, state, inputs);
      }
    }
    return MakeResult(*log, settings, inputs, sum, carried.odometry, history);
  }

  if (options_.calibrate) {
    for (std::size_t r = 0; r < robots.size(); ++r) {
      double& drift = carried.odometry[r].drift_rad_per_m;
      drift = DriftOf(sum.legs()[r], settings.noise, drift);
    }
    FitWidths(sum.legs(), settings.noise, &carried.odometry);
  }
  const Schedule next =
      done.Next(options_, static_cast<std::int64_t>(robots.size()), sum.log_likelihood(), sum.counts().Sum());
  carried.work = NextWork(sum, done, next, carried.step_counts, settings.loose_frame,
                          settings.Model(&m_step.perception));
  cairn::Step step;
  std::map<std::string, Blob> fresh{{"history", history},
                                    {"counts", StoredCounts(sum.counts())},
                                    {"perception", m_step.perception.ToBlob()},
                                    {"landmarks", ToBlob(m_step.landmarks)}};
  if (inputs.Has("search")) fresh["search"] = *inputs.Get("search");
  PlanGuesses(options_, sum, next, &carried, &fresh, step.plan.mutable_state());
  PlanRound(options_, robots, next, carried, fresh, &step);
  step.plan.set_note(Note(done, sum.log_likelihood(), m_step.landmarks.size()));
  return step;
}

cairn::Step LandmarkMap::SummaryUnder(const std::vector<Landmark>& landmarks, const LayeredGrid& counts,
                                      const Blob& history, const RoundSum& sum, const State& state,
                                      const Inputs& inputs) const {
  const std::vector<std::string> robots = inputs.Get("log")->Texts("robots");
  const Settings settings = Settings::FromBlob(*inputs.Get("settings"));
  Schedule schedule = Schedule::Load(state);
  ++schedule.iteration;
  schedule.polished = true;
  cairn::Step step;
  std::map<std::string, Blob> fresh{
      {"history", history},
      {"counts", StoredCounts(counts)},
      {"perception", PerceptionOf(MapOf(counts, settings.map), settings.map).ToBlob()},
      {"landmarks", ToBlob(landmarks)}};
  if (inputs.Has("search")) fresh["search"] = *inputs.Get("search");
  Carried carried = Carried::Load(state, robots.size());
  PlanGuesses(options_, sum, schedule, &carried, &fresh, step.plan.mutable_state());
  PlanRound(options_, robots, schedule, carried, fresh, &step);
  step.plan.set_note("polished: " + std::to_string(landmarks.size()) + " landmarks by least squares");
  return step;
}

cairn::Step LandmarkMap::AdvanceSearch(const State& state, Partials& partials, const Inputs& inputs) const {
  const std::vector<std::string> robots = inputs.Get("log")->Texts("robots");
  std::vector<cairn::Step> steps;
  int running = 0;
  std::string note;
  for (int k = 0; k < StartsIn(state); ++k) {
    OneStart start(state, k, partials, inputs);
    cairn::Step step;
    *step.plan.mutable_state() = start.state();
    if (!start.waits()) {
      try {
        if (AwaitsAssociations(start.state())) {
          KeepAssociations(start, &step);
        } else {
          step = AdvanceOne(start.state(), start, start);
          KeepStart(start.state(), step.plan.mutable_state());
          note = step.plan.note();
          if (SearchIsOver(step.plan.state())) PlanAssociations(options_, robots, &step);
        }
      } catch (const NoPathError& error) {
        (*step.plan.mutable_state()->mutable_scalars())[kFailure].set_s(error.what());
      }
    }
    running += step.plan.tasks_size() > 0 ? 1 : 0;
    steps.push_back(std::move(step));
  }
  if (running == 0) return GoOn(std::move(steps), inputs);
  cairn::Step step = FanOut(std::move(steps));
  step.plan.set_note(std::to_string(running) + " of " + std::to_string(StartsIn(state)) + " starts; " + note);
  return step;
}

void LandmarkMap::Refine(const std::vector<Landmark>& landmarks, const Settings& coarse, const Inputs& inputs,
                         cairn::Step* step) const {
  const std::vector<std::string> robots = inputs.Get("log")->Texts("robots");
  State& state = *step->plan.mutable_state();
  const Carried found = Carried::Load(state, robots.size());
  const Beginning beginning = BeginningOf(options_, inputs);
  const GridSpec &fine = beginning.settings.map.grid, &before = coarse.map.grid;
  std::vector<RobotSteps> all;
  Carried carried = MakeAllSteps(*inputs.Get("log"), options_, beginning, step, &all);
  carried.odometry = found.odometry;
  const double cells =
      (before.cell_m / fine.cell_m) * (before.cell_m / fine.cell_m) * fine.headings / before.headings;
  carried.work[0] = cells * found.work[0];
  Schedule schedule = Schedule::Load(state);
  schedule.robots = 1;
  schedule.settled = 0;
  schedule.summarise = false;
  schedule.Store(&state);
  carried.Store(&state);
  GuessNothing(&state);
  const LayeredGrid counts = CountsOf(landmarks, beginning.settings.map);
  const Perception perception = PerceptionOf(MapOf(counts, beginning.settings.map), beginning.settings.map);
  (*state.mutable_blobs())["counts"] = step->Share(StoredCounts(counts));
  (*state.mutable_blobs())["perception"] = step->Share(perception.ToBlob());
}

cairn::Step LandmarkMap::GoOn(std::vector<cairn::Step> starts, const Inputs& inputs) const {
  CandidateRounds rounds(options_, std::move(starts), inputs);
  const Settings settings = rounds.settings();
  const std::vector<Candidate> candidates = rounds.candidates();
  const Choice choice = Choose(candidates, settings);
  std::vector<Proposal> proposals;
  if (!rounds.WentOnFrom(choice.best))
    proposals = ProposalsAround(candidates, choice.best, settings);
  else if (choice.support < kEnoughSupport)
    proposals = ProposalsBeyond(candidates, settings, rounds.MeanLegM());
  if (rounds.waves() < options_.waves && !proposals.empty()) {
    rounds.GoOnFrom(choice.best, proposals);
    cairn::Step step = FanOut(std::move(rounds).Take());
    step.plan.set_note(Sentence(candidates, choice));
    return step;
  }
  std::vector<cairn::Step> ended = std::move(rounds).Take();
  cairn::Step step = std::move(ended[static_cast<std::size_t>(choice.best)]);
  DropAssociations(step.plan.mutable_state());
  if (Resolve(options_, *inputs.Get("log")).map.grid.cell_m < settings.map.grid.cell_m)
    Refine(candidates[static_cast<std::size_t>(choice.best)].landmarks, settings, inputs, &step);
  (*step.plan.mutable_state()->mutable_blobs())["search"] = step.Share(ToBlob(candidates, choice, settings));
  PlanTasks(options_, inputs.Get("log")->Texts("robots"), &step.plan);
  step.plan.set_note(Sentence(candidates, choice));
  return step;
}

}  // namespace cairn::landmark_map
