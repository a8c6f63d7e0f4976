#include "pipelines/landmark_map/landmark_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "pipelines/common/fan_out.h"
#include "pipelines/common/handed_over.h"
#include "pipelines/landmark_map/candidates.h"
#include "pipelines/landmark_map/em.h"
#include "pipelines/landmark_map/estimate.h"
#include "pipelines/landmark_map/initial_state.h"
#include "pipelines/landmark_map/m_step_task.h"
#include "pipelines/landmark_map/measured.h"
#include "pipelines/landmark_map/model/e_step.h"
#include "pipelines/landmark_map/outlook.h"
#include "pipelines/landmark_map/refinement/contradictions.h"
#include "pipelines/landmark_map/refinement/refine.h"
#include "pipelines/landmark_map/round.h"
#include "pipelines/landmark_map/search.h"
#include "pipelines/landmark_map/slice_task.h"
#include "pipelines/landmark_map/so_far.h"
#include "schema/step_limits.h"

namespace cairn::landmark_map {
namespace {

// Are there landmarks that no observation names?
bool WithoutIdentities(const std::vector<RobotSteps>& steps, const MapRules& rules) {
  return std::ranges::any_of(steps, [&](const RobotSteps& robot) {
    return std::ranges::any_of(robot.observations,
                               [&](const Observation& o) { return o.type >= rules.types; });
  });
}

// The first robot's EM has ended: what comes next is one map's affair.
bool SearchIsOver(const State& state) {
  const Schedule next = Schedule::Load(state);
  return next.summarises() || next.robots > 1;
}

std::vector<RobotSteps> AllStepsOn(const Settings& settings, const Blob& blob) {
  const auto log = Read<kinds::Log>(blob);
  std::vector<RobotSteps> steps;
  for (std::size_t r = 0; r < log.robot.size(); ++r)
    steps.push_back(MakeSteps(log.robot[r], log.robots[r], settings.steps, nullptr));
  return steps;
}

// How many times as many cells beliefs have on the one grid as on the other.
double FinerBy(const Settings& fine, const Settings& coarse) {
  const GridSpec &after = fine.map.grid, &before = coarse.map.grid;
  return (before.cell_m / after.cell_m) * (before.cell_m / after.cell_m) * after.headings / before.headings;
}

cairn::Step Merged(const Options& options, std::vector<cairn::Step> candidates) {
  const SearchOutlook outlook(options, candidates);
  cairn::Step step = FanOut(std::move(candidates));
  outlook.Announce(&step.plan);
  return step;
}

// The state of all starts goes with each step: what a coordinator would refuse, at once or when the search
// has gone on for long, is never begun.
void RequireRoomForStarts(const State& state, std::size_t starts) {
  constexpr std::size_t kToCome = 6;        // figures of a start until the search has chosen
  constexpr double kShareOfTheFirst = 0.4;  // with drifts further out there may be as many again
  const std::size_t each = (state.scalars().size() + starts - 1) / starts + kToCome,
                    room = kMostFigures / each;
  const auto most = static_cast<std::size_t>(kShareOfTheFirst * static_cast<double>(room));
  if (starts > most)
    throw InputError(fmt::format(
        "starts={} are more than can be searched side by side: of this log at most {}", starts, most));
}

Blob RunTask(const Options& options, const Task& task, const Inputs& inputs, Progress& progress) {
  if (task.kind() == "incremental") return RunIncremental(options, task, inputs, progress);
  if (task.kind() == "sum") return RunSum(options, task, inputs);
  return task.kind() == "m_step" ? RunMStep(options, task, inputs)
                                 : RunSlice(options, task, inputs, progress);
}

}  // namespace

cairn::Step LandmarkMap::Start(const Inputs& inputs) const {
  CheckIncremental(options_, inputs);
  const std::vector<std::size_t> robots = FirstRobots(options_, inputs);
  if (robots.size() < 2) return StartFrom(inputs, 1);
  FirstRobotTrials trials(robots);
  cairn::Step step = StartFrom(LedBy(trials.robot(), inputs), robots.size());
  trials.Expect(step.plan);
  trials.Store(&step);
  return step;
}

cairn::Step LandmarkMap::StartFrom(const Inputs& inputs, std::size_t trials) const {
  const BlobPtr log = inputs.Get("log");
  const Options search = inputs.Has("map") ? options_ : ForSearch(options_, *log);
  const InitialState initial = MakeInitialState(search, inputs);
  const Settings& settings = initial.settings;
  const bool on_finer = search.cell_m != options_.cell_m;
  const Settings fine = on_finer ? Resolve(options_, *log) : settings;
  if (on_finer)  // the search tells nothing of what the finer grid takes
    RequireMemory("the M-step", kMStepTables * sizeof(double) * fine.places, fine.memory_mb);
  const double finer = on_finer ? FinerBy(fine, settings) : 0.0;
  const std::vector<std::string> robots = log->Texts("robots");
  std::vector<cairn::Step> starts(1);
  std::vector<RobotSteps> steps;
  RobotStates robot_states = MakeAllSteps(*log, options_, initial, &starts[0], &steps);
  PlanRound(options_, robots, initial.schedule, robot_states, FirstBlobs(initial), &starts[0]);
  if (settings.starts > 1) {
    const State shared_state = starts[0].plan.state();
    const std::vector<StartingPoint> points = StartingPoints(settings);
    starts.resize(points.size());
    for (std::size_t k = 0; k < points.size(); ++k) {
      starts[k].plan.Clear();
      *starts[k].plan.mutable_state() = shared_state;
      BeginFrom(points[k], options_, robots, settings, steps[0], &starts[k]);
      CountCost({}, &starts[k]);
    }
    if (finer > 0.0) (*starts[0].plan.mutable_state()->mutable_scalars())[kFiner].set_d(finer);
  } else if (!inputs.Has("map") && options_.iterations > 0 && WithoutIdentities(steps, settings.map)) {
    Blob search = OneStartOnly();
    search.Put("why", Array::Text(ChooseStarts(options_, *log).why));
    (*starts[0].plan.mutable_state()->mutable_blobs())["search"] = starts[0].Share(std::move(search));
  }
  const Perception* given = initial.perception ? &*initial.perception : nullptr;
  Estimate estimate = EstimateJob(options_, {settings, steps},
                                  {fine, on_finer ? AllStepsOn(fine, *log) : steps}, starts, given);
  estimate.rounds *= static_cast<double>(trials);
  estimate.seconds *= static_cast<double>(trials);
  RequireMemory("a task", 1e6 * estimate.task_mb, settings.memory_mb);
  const std::size_t count = starts.size();
  cairn::Step step = count == 1 ? std::move(starts[0]) : Merged(options_, std::move(starts));
  if (count > 1) RequireRoomForStarts(step.plan.state(), count);
  estimate.Store(step.plan.mutable_state());
  const std::string why = inputs.Has("map")          ? "the map is given"
                          : options_.iterations == 0 ? "iterations=0 leaves nothing to choose"
                                                     : ChooseStarts(options_, *log).why;
  step.plan.set_note(Sentence(estimate, settings, robot_states) +
                     fmt::format("; {} start{}: {}", settings.starts, settings.starts == 1 ? "" : "s", why) +
                     (trials > 1 ? fmt::format("; {} robots are tried as the first", trials) : ""));
  return step;
}

// That no path fits one of several starts, or under one of several first robots, is that one's affair.
Blob LandmarkMap::Run(const Task& task, const Inputs& inputs, Progress& progress) const {
  RequireKind(task, {"incremental", "sum", "m_step", "guess", "forward", "backward"});
  if (!task.params().contains("start") && !IsOfTrial(task)) return RunTask(options_, task, inputs, progress);
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
  if (options_.incremental) return IncrementalResult(options_, state, partials, inputs);
  const auto trials = FirstRobotTrials::Load(state, inputs.Get("log")->Texts("robots").size());
  cairn::Step step =
      trials ? AdvanceTrial(*trials, state, partials, inputs) : AdvanceFrom(state, partials, inputs);
  if (!step.plan.result().empty()) return step;
  const auto now = FirstRobotTrials::Load(step.plan.state(), inputs.Get("log")->Texts("robots").size());
  if (now)
    ShowSoFar(state, LedBy(now->robot(), inputs), &step);
  else
    ShowSoFar(state, inputs, &step);
  return step;
}

cairn::Step LandmarkMap::AdvanceTrial(FirstRobotTrials trials, const State& state, Partials& partials,
                                      const Inputs& inputs) const {
  const BlobPtr log = inputs.Get("log");
  cairn::Step step;
  try {
    step = AdvanceFrom(state, partials, LedBy(trials.robot(), inputs));
    if (step.plan.result().empty()) {
      trials.Store(&step);
      step.plan.set_note(trials.Note(*log, step.plan.note()));
      return step;
    }
    const Blob result = InOrderOf(*log, trials.robot(), *step.blobs.back());
    step = {};
    trials.Ended(result, Settings::In(*inputs.Get("settings"), options_), &step);
  } catch (const NoPathError& error) {
    trials.Failed(error.what(), *log);
  } catch (const RobotsContradictError& error) {
    trials.Failed(error.what(), *log);
  }
  if (!trials.Next()) {
    const std::string result = step.Share(trials.Best(*log, inputs, step));
    step.plan.set_result(result);
    return step;
  }
  cairn::Step next = StartFrom(LedBy(trials.robot(), inputs), trials.count());
  std::ranges::move(step.blobs, std::back_inserter(next.blobs));
  trials.Store(&next);
  next.plan.set_note(trials.Note(*log, next.plan.note()));
  return next;
}

cairn::Step LandmarkMap::AdvanceFrom(const State& state, Partials& partials, const Inputs& inputs) const {
  return StartsIn(state) > 0 ? AdvanceSearch(state, partials, inputs)
                             : AdvanceEm(options_, state, partials, inputs);
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
          KeepAssociations(options_, start, start, &step);
        } else {
          step = AdvanceEm(options_, start.state(), start, start);
          KeepStart(start.state(), step.plan.mutable_state());
          note = step.plan.note();
          if (SearchIsOver(step.plan.state())) PlanAssociations(options_, robots, &step);
        }
        CountCost(start.state(), &step);
      } catch (const NoPathError& error) {
        (*step.plan.mutable_state()->mutable_scalars())[kFailure].set_s(error.what());
      }
    }
    running += step.plan.tasks_size() > 0 ? 1 : 0;
    steps.push_back(std::move(step));
  }
  if (running == 0) return GoOn(std::move(steps), inputs);
  cairn::Step step = Merged(options_, std::move(steps));
  step.plan.set_note(std::to_string(running) + " of " + std::to_string(StartsIn(state)) + " starts; " + note);
  return step;
}

void LandmarkMap::Refine(const std::vector<Landmark>& landmarks, const Settings& coarse, const Inputs& inputs,
                         cairn::Step* step) const {
  const std::vector<std::string> robots = inputs.Get("log")->Texts("robots");
  State& state = *step->plan.mutable_state();
  const RobotStates found = RobotStates::Load(state, robots.size());
  const InitialState initial = MakeInitialState(options_, inputs);
  std::vector<RobotSteps> all;
  RobotStates robot_states = MakeAllSteps(*inputs.Get("log"), options_, initial, step, &all);
  robot_states.odometry = found.odometry;
  robot_states.work[0] = FinerBy(initial.settings, coarse) * found.work[0];
  Schedule schedule = Schedule::Load(state);
  schedule.robots = 1;
  schedule.settled = 0;
  schedule.phase = Phase::kMap;
  schedule.Store(&state);
  robot_states.Store(&state);
  GuessNothing(&state);
  const LayeredGrid counts = CountsFromLandmarks(landmarks, initial.settings);
  RequireMemory("the M-step", MStepBytes(counts, initial.settings.map), initial.settings.memory_mb);
  const Perception perception =
      MakePerception(MapFromCounts(counts, initial.settings.map), initial.settings.map);
  (*state.mutable_blobs())["counts"] = step->Share(StoredCounts(counts));
  (*state.mutable_blobs())["perception"] = step->Share(BlobOf(perception));
}

cairn::Step LandmarkMap::GoOn(std::vector<cairn::Step> starts, const Inputs& inputs) const {
  CandidateRounds rounds(options_, std::move(starts), inputs);
  const Settings settings = rounds.settings();
  const std::vector<Candidate> candidates = rounds.candidates();
  const Choice choice = Choose(candidates, settings);
  const bool rare = choice.support < kEnoughSupport;
  constexpr double kClear_nats = 50;  // ahead of all others: wide starts take many times as long
  const bool open = choice.lead_nats && *choice.lead_nats < kClear_nats &&
                    LooksOpen(candidates[static_cast<std::size_t>(choice.best)]);
  std::vector<Proposal> further;
  if (rare || open) further = ProposalsAtOnce(candidates, settings);
  if (rare && further.empty()) further = ProposalsBeyond(candidates, settings, rounds.MeanIncrementM());
  const std::size_t beyond = further.size();
  const std::vector<Proposal> proposals = rounds.WentOnFrom(choice.best)
                                              ? std::move(further)
                                              : ProposalsAround(candidates, choice.best, settings);
  if (rounds.waves() < options_.waves && rounds.Seconds() < kEnoughSeconds && !proposals.empty()) {
    rounds.GoOnFrom(choice.best, static_cast<int>(beyond), proposals);
    cairn::Step step = Merged(options_, std::move(rounds).Take());
    step.plan.set_note(Sentence(candidates, choice));
    return step;
  }
  std::vector<cairn::Step> ended = std::move(rounds).Take();
  cairn::Step step = std::move(ended[static_cast<std::size_t>(choice.best)]);
  DropAssociations(step.plan.mutable_state());
  if (Resolve(options_, *inputs.Get("log")).map.grid.cell_m < settings.map.grid.cell_m)
    Refine(candidates[static_cast<std::size_t>(choice.best)].landmarks, settings, inputs, &step);
  Blob search = ToBlob(candidates, choice, settings);
  const std::size_t landmarks = candidates[static_cast<std::size_t>(choice.best)].landmarks.size();
  search.Put("why", Array::Text(ChooseStarts(options_, *inputs.Get("log")).why));
  search.Put("unlike", Array::Texts(UnlikeMeasured(options_, *inputs.Get("log"), landmarks)));
  (*step.plan.mutable_state()->mutable_blobs())["search"] = step.Share(std::move(search));
  PlanTasks(options_, inputs.Get("log")->Texts("robots"), &step.plan);
  step.plan.set_note(Sentence(candidates, choice));
  return step;
}

}  // namespace cairn::landmark_map
