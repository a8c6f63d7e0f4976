#include "pipelines/landmark_map/landmark_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "pipelines/landmark_map/e_step.h"
#include "pipelines/landmark_map/estimate.h"
#include "pipelines/landmark_map/partial.h"
#include "pipelines/landmark_map/result.h"
#include "pipelines/landmark_map/round.h"
#include "pipelines/landmark_map/work.h"

namespace cairn::landmark_map {
namespace {

std::string RobotPath(std::size_t robot) { return "robot/" + std::to_string(robot) + "/"; }

// Which landmark types (the last: unknown) a robot has observed.
std::vector<bool> TypesSeen(const Blob& robot, int types) {
  std::vector<bool> seen(static_cast<std::size_t>(types) + 1, false);
  for (const std::int32_t landmark : robot.Get<std::int32_t>("observations/landmark")) {
    const int type = landmark < 0 ? types : landmark;
    if (type < static_cast<int>(seen.size())) seen[static_cast<std::size_t>(type)] = true;
  }
  return seen;
}

// Every robot's steps; robots but the first begin where they see what the first has seen too.
Carried MakeAllSteps(const Blob& log, const Settings& settings, const Schedule& schedule, cairn::Step* step,
                     std::vector<RobotSteps>* all) {
  const std::vector<std::string> robots = log.Texts("robots");
  const std::vector<bool> shared = TypesSeen(log.Sub("robot/0/"), settings.map.types);
  Carried carried;
  carried.blobs["settings"] = step->Share(settings.ToBlob());
  carried.odometry.assign(robots.size(), OdometryFit::Of(settings.noise));
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const RobotSteps steps =
        MakeSteps(log.Sub(RobotPath(r)), robots[r], settings.steps, r == 0 ? nullptr : &shared);
    carried.step_counts.push_back(steps.size());
    const int count = StepsInUse(schedule, steps.size());
    carried.work.push_back(WorkOf(ReckonOpenLoop(steps, settings.Model(nullptr), count).cells, count));
    carried.blobs["steps/" + std::to_string(r)] = step->Share(steps.ToBlob());
    all->push_back(steps);
  }
  return carried;
}

LayeredGrid NoCounts(const Settings& settings) {
  LayeredGrid counts;
  counts.layers.resize(static_cast<std::size_t>(settings.map.types) + 1);
  return counts;
}

Blob StoredCounts(const LayeredGrid& counts) {
  Blob blob;
  counts.Store("counts/", &blob);
  return blob;
}

// A table that another task handed over; a layer for each heading.
LayeredGrid HandedOver(const Inputs& inputs, const std::string& input, const std::string& prefix,
                       int headings) {
  LayeredGrid grid = LayeredGrid::LoadSparse(prefix, *inputs.Get(input));
  if (grid.layers.size() != static_cast<std::size_t>(headings)) {
    throw InputError("the input '" + input + "' has " + std::to_string(grid.layers.size()) +
                     " layers where the grid has " + std::to_string(headings) + " headings");
  }
  return grid;
}

// alpha before the slice's first step; robots but the first start anywhere.
LayeredGrid Before(const Task& task, const Inputs& inputs, const EStepModel& model, const Slice& slice) {
  if (inputs.Has("before")) return HandedOver(inputs, "before", "alpha/", model.grid.headings);
  return task.params().at("robot").i() == 0 ? DiracStart(model.grid) : UniformStart(model, slice);
}

// The steps of a task's slice: from where the forward task before it ended to where the backward task after
// it began; `forward` tasks may go on to the end of all.
std::pair<int, int> Range(const Task& task, const Inputs& inputs) {
  const int first = inputs.Has("before") ? inputs.Get("before")->Scalar<std::int32_t>("end") : 0;
  const int end = inputs.Has("beta") ? inputs.Get("beta")->Scalar<std::int32_t>("first")
                                     : static_cast<int>(task.params().at("count").i());
  if (first < 0 || first > end || end > task.params().at("count").i()) {
    throw InputError("the inputs name the steps from " + std::to_string(first) + " to " +
                     std::to_string(end) + ", which are none");
  }
  return {first, end};
}

// What the next E-step of each robot should cost: what the last one did, or, of a robot that joins, what a
// search of the whole map takes.
std::vector<double> NextWork(const RoundSum& sum, const Schedule& done, const Schedule& next,
                             const std::vector<std::int64_t>& steps, const EStepModel& model) {
  std::vector<double> work;
  for (std::size_t r = 0; r < steps.size(); ++r) {
    const int count = StepsInUse(next, steps[r]);
    work.push_back(static_cast<std::int64_t>(r) < done.robots
                       ? sum.WorkOf(r) * count / StepsInUse(done, steps[r])
                       : WorkWhereLost(count, model));
  }
  return work;
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
  const Settings settings = Resolve(options_, *log);
  const std::vector<std::string> robots = log->Texts("robots");
  Schedule schedule;
  schedule.prefix = settings.growth_start;
  cairn::Step step;
  std::vector<RobotSteps> steps;
  const Carried carried = MakeAllSteps(*log, settings, schedule, &step, &steps);
  PlanRound(options_, robots, schedule, carried,
            {{"history", EmptyHistory()}, {"counts", StoredCounts(NoCounts(settings))}}, &step);
  const Estimate estimate = EstimateJob(options_, settings, steps, carried, step.plan);
  RefuseMemory("a task", 1e6 * estimate.task_mb, settings.memory_mb);
  estimate.Store(step.plan.mutable_state());
  step.plan.set_note(Sentence(estimate, settings, carried));
  return step;
}

Blob LandmarkMap::Run(const Task& task, const Inputs& inputs, Progress& progress) const {
  const auto& params = task.params();
  const auto [first, end] = Range(task, inputs);
  if (first == end) {  // an empty slice
    Blob partial;
    partial.PutScalar<std::int32_t>(task.kind() == "forward" ? "end" : "first", end);
    return partial;
  }
  const OdometryFit odometry = OdometryOf(task);
  Settings settings = Settings::FromBlob(*inputs.Get("settings"));
  settings.noise = odometry.Widths(settings.noise);
  const RobotSteps steps = RobotSteps::FromBlob(*inputs.Get("steps")).WithoutDrift(odometry.drift_rad_per_m);
  Perception perception;
  const bool mapped = inputs.Has("perception");
  if (mapped) perception = Perception::FromBlob(*inputs.Get("perception"));
  const EStepModel model = settings.Model(mapped ? &perception : nullptr);
  const Slice slice{steps, first, end, params.at("name").s()};
  LayeredGrid before = Before(task, inputs, model, slice);
  if (task.kind() == "forward") {
    const Frontier frontier = ForwardFor(model, slice, std::move(before), params.at("work").d(), progress);
    Blob partial;
    frontier.alpha.StoreSparse("alpha/", &partial);
    partial.PutScalar<std::int32_t>("end", frontier.end);
    return partial;
  }
  const Alphas alphas = Forward(model, slice, before, progress);
  const bool later = inputs.Has("beta") && inputs.Get("beta")->Has("beta/box");
  LayeredGrid beta =
      later ? HandedOver(inputs, "beta", "beta/", model.grid.headings) : UniformBeta(alphas.tables.back());
  for (std::size_t c = 0; c < beta.layers.size(); ++c) {
    if (beta.layers[c].box != alphas.tables.back().layers[c].box)
      throw InputError("the input 'beta' does not lie where alpha does, in layer " + std::to_string(c));
  }
  std::vector<Landmark> landmarks;
  const bool summarise = params.at("summarise").b();
  if (summarise) landmarks = LandmarksFromBlob(*inputs.Get("landmarks"));
  PartialBuilder builder(settings, slice, static_cast<int>(params.at("robot").i()),
                         summarise ? &landmarks : nullptr, NoCounts(settings));
  const double tables = sizeof(double) * static_cast<double>(alphas.Cells());
  const auto add = [&](int step, const LayeredGrid& belief) {
    builder.Add(step, belief);
    RefuseMemory("alphas and counts", tables + sizeof(double) * static_cast<double>(builder.counts().cells()),
                 settings.memory_mb);
  };
  Visitor visitor{add, nullptr};
  if (options_.calibrate) {
    visitor.leg = [&](int step, const HalfTurn& posterior) { builder.AddLeg(step, posterior); };
  }
  beta = Backward(model, slice, alphas, before, std::move(beta), progress, visitor);
  Blob partial = builder.Finish(alphas);
  if (slice.first > 0) beta.StoreSparse("beta/", &partial);
  return partial;
}

cairn::Step LandmarkMap::Advance(const State& state, Partials& partials, const Inputs& inputs) const {
  const BlobPtr log = inputs.Get("log");
  const std::vector<std::string> robots = log->Texts("robots");
  const Settings settings = Settings::FromBlob(*inputs.Get("settings"));
  const Schedule done = Schedule::Load(state);
  Carried carried = Carried::Load(state, robots.size());

  RoundSum sum(NoCounts(settings), robots.size());
  for (std::size_t i = 0; i < partials.size(); ++i) sum.Add(*partials.Get(i));
  const Blob history = Extended(*inputs.Get("history"), done, sum.log_likelihood());
  if (done.summarise) return MakeResult(*log, settings, inputs, sum, carried.odometry, history);

  if (options_.calibrate) {
    for (std::size_t r = 0; r < robots.size(); ++r) {
      double& drift = carried.odometry[r].drift_rad_per_m;
      drift = DriftOf(sum.legs()[r], settings.noise, drift);
    }
    FitWidths(sum.legs(), settings.noise, &carried.odometry);
  }
  RefuseMemory("the M-step", MStepBytes(sum.counts(), settings.map), settings.memory_mb);
  const LayeredGrid map = MapOf(sum.counts(), settings.map);
  const std::vector<Landmark> landmarks = ExtractLandmarks(sum.counts(), settings.map);
  const Perception perception = PerceptionOf(map, settings.map);
  const Schedule next =
      done.Next(options_, static_cast<std::int64_t>(robots.size()), sum.log_likelihood(), sum.counts().Sum());
  carried.work = NextWork(sum, done, next, carried.step_counts, settings.Model(&perception));
  cairn::Step step;
  PlanRound(options_, robots, next, carried,
            {{"history", history},
             {"counts", StoredCounts(sum.counts())},
             {"perception", perception.ToBlob()},
             {"landmarks", ToBlob(landmarks)}},
            &step);
  step.plan.set_note(Note(done, sum.log_likelihood(), landmarks.size()));
  return step;
}

}  // namespace cairn::landmark_map
