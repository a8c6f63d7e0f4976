#include "pipelines/landmark_map/landmark_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "pipelines/landmark_map/e_step.h"
#include "pipelines/landmark_map/partial.h"
#include "pipelines/landmark_map/plan.h"
#include "pipelines/landmark_map/result.h"

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

// Plans the rounds of a job whose State is being built.
class Planner {
 public:
  Planner(const Options& options, const Blob& log, const Settings& settings)
      : options_(options), log_(log), settings_(settings), robots_(log.Texts("robots")) {}

  // The step that begins the E-step of `schedule` under `perception` (nullptr: none yet).
  cairn::Step Plan(const Schedule& schedule, const std::vector<double>& drift, const Perception* perception,
                   const std::vector<Landmark>* landmarks, Blob history, Blob counts) {
    State& state = *step_.plan.mutable_state();
    schedule.Store(&state);
    auto& blobs = *state.mutable_blobs();
    blobs["settings"] = step_.Share(settings_.ToBlob());
    blobs["history"] = step_.Share(std::move(history));
    blobs["counts"] = step_.Share(std::move(counts));
    if (perception != nullptr) blobs["perception"] = step_.Share(perception->ToBlob());
    if (landmarks != nullptr) blobs["landmarks"] = step_.Share(ToBlob(*landmarks));
    const std::vector<bool> shared = TypesSeen(log_.Sub("robot/0/"), settings_.map.types);
    for (std::int64_t r = 0; r < schedule.robots; ++r) {
      const auto robot = static_cast<std::size_t>(r);
      const RobotSteps steps = MakeSteps(log_.Sub(RobotPath(robot)), robots_[robot], settings_.steps,
                                         drift[robot], robot == 0 ? nullptr : &shared);
      blobs["steps/" + std::to_string(robot)] = step_.Share(steps.ToBlob());
      (*state.mutable_scalars())["drift/" + std::to_string(robot)].set_d(drift[robot]);
      AddRobot(schedule, robot, steps, perception);
    }
    step_.plan.set_rounds_left(static_cast<std::uint32_t>(schedule.RoundsLeft(options_, AllRobots())));
    step_.plan.set_memory_bytes(static_cast<std::uint64_t>(options_.memory_mb * 1e6));
    return std::move(step_);
  }

  std::int64_t AllRobots() const { return static_cast<std::int64_t>(robots_.size()); }

 private:
  static constexpr std::int64_t kNone = -1;

  // Chains over the slices: forward tasks to the last slice but one, then backward tasks from the last to the
  // first.
  void AddRobot(const Schedule& schedule, std::size_t robot, const RobotSteps& steps,
                const Perception* perception) {
    const double part = schedule.summarise ? 1.0 : schedule.prefix;
    const int count = std::clamp(static_cast<int>(std::ceil(part * steps.size())), 1, steps.size());
    const int slices = static_cast<int>((count + options_.slice_steps - 1) / options_.slice_steps);
    const auto begin = [&](int slice) { return static_cast<int>(std::int64_t{count} * slice / slices); };
    std::vector<std::int64_t> forward;
    for (int s = 0; s + 1 < slices; ++s) {
      forward.push_back(AddTask("forward", schedule, robot, begin(s), begin(s + 1), perception,
                                s > 0 ? forward.back() : kNone, kNone));
    }
    std::int64_t beta = kNone;
    for (int s = slices - 1; s >= 0; --s) {
      beta = AddTask("backward", schedule, robot, begin(s), begin(s + 1), perception,
                     s > 0 ? forward[static_cast<std::size_t>(s) - 1] : kNone, beta);
    }
  }

  std::int64_t AddTask(const char* kind, const Schedule& schedule, std::size_t robot, int first, int end,
                       const Perception* perception, std::int64_t before, std::int64_t beta) {
    const std::int64_t index = step_.plan.tasks_size();
    Task& task = *step_.plan.add_tasks();
    task.set_index(static_cast<std::uint32_t>(index));
    task.set_kind(kind);
    task.set_cost(static_cast<std::uint64_t>(end - first));
    auto& params = *task.mutable_params();
    params["robot"].set_i(static_cast<std::int64_t>(robot));
    params["name"].set_s(robots_[robot]);
    params["first"].set_i(first);
    params["end"].set_i(end);
    params["summarise"].set_b(schedule.summarise);
    AddBlob("settings", "settings", &task);
    AddBlob("steps", "steps/" + std::to_string(robot), &task);
    if (perception != nullptr) AddBlob("perception", "perception", &task);
    if (schedule.summarise) AddBlob("landmarks", "landmarks", &task);
    if (before != kNone) AddPartial("before", before, &task);
    if (beta != kNone) AddPartial("beta", beta, &task);
    return index;
  }

  void AddBlob(const char* name, const std::string& key, Task* task) {
    proto::InputRef& input = *task->add_inputs();
    input.set_name(name);
    input.set_blob(step_.plan.state().blobs().at(key));
  }

  static void AddPartial(const char* name, std::int64_t index, Task* task) {
    proto::InputRef& input = *task->add_inputs();
    input.set_name(name);
    input.set_task(static_cast<std::uint32_t>(index));
  }

  const Options& options_;
  const Blob& log_;
  const Settings& settings_;
  std::vector<std::string> robots_;
  cairn::Step step_;
};

LayeredGrid NoCounts(const Settings& settings) {
  LayeredGrid counts;
  counts.layers.resize(static_cast<std::size_t>(settings.map.types) + 1);
  return counts;
}

// alpha before the slice's first step; robots but the first start anywhere.
LayeredGrid Before(const Task& task, const Inputs& inputs, const EStepModel& model, const RobotSteps& steps) {
  if (inputs.Has("before")) return LayeredGrid::Load("alpha/", *inputs.Get("before"));
  return task.params().at("robot").i() == 0 ? DiracStart(model.grid) : UniformStart(model, steps);
}

std::vector<double> Drifts(const State& state, std::size_t robots) {
  std::vector<double> drift(robots, 0.0);
  for (std::size_t r = 0; r < robots; ++r) {
    const auto it = state.scalars().find("drift/" + std::to_string(r));
    if (it != state.scalars().end()) drift[r] = it->second.d();
  }
  return drift;
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
  Schedule schedule;
  schedule.prefix = settings.growth_start;
  Blob counts;
  NoCounts(settings).Store("counts/", &counts);
  Planner planner(options_, *log, settings);
  const std::vector<double> drift(static_cast<std::size_t>(planner.AllRobots()), 0.0);
  cairn::Step step = planner.Plan(schedule, drift, nullptr, nullptr, EmptyHistory(), std::move(counts));
  step.plan.set_note("planned");
  return step;
}

Blob LandmarkMap::Run(const Task& task, const Inputs& inputs, Progress& progress) const {
  const Settings settings = Settings::FromBlob(*inputs.Get("settings"));
  const RobotSteps steps = RobotSteps::FromBlob(*inputs.Get("steps"));
  Perception perception;
  const bool mapped = inputs.Has("perception");
  if (mapped) perception = Perception::FromBlob(*inputs.Get("perception"));
  const EStepModel model = settings.Model(mapped ? &perception : nullptr);
  const auto& params = task.params();
  const Slice slice{steps, static_cast<int>(params.at("first").i()), static_cast<int>(params.at("end").i()),
                    params.at("name").s()};
  const LayeredGrid before = Before(task, inputs, model, steps);
  const Alphas alphas = Forward(model, slice, before, progress);
  Blob partial;
  if (task.kind() == "forward") {
    alphas.tables.back().Store("alpha/", &partial);
    return partial;
  }
  LayeredGrid beta = inputs.Has("beta") ? LayeredGrid::Load("beta/", *inputs.Get("beta"))
                                        : UniformBeta(alphas.tables.back());
  std::vector<Landmark> landmarks;
  if (params.at("summarise").b()) landmarks = LandmarksFromBlob(*inputs.Get("landmarks"));
  PartialBuilder builder(settings, slice, static_cast<int>(params.at("robot").i()),
                         params.at("summarise").b() ? &landmarks : nullptr, NoCounts(settings));
  beta = Backward(model, slice, alphas, before, std::move(beta), progress,
                  [&](int step, const LayeredGrid& belief) { builder.Add(step, belief); });
  partial = builder.Finish(alphas.log_likelihood);
  if (slice.first > 0) beta.Store("beta/", &partial);
  return partial;
}

cairn::Step LandmarkMap::Advance(const State& state, Partials& partials, const Inputs& inputs) const {
  const BlobPtr log = inputs.Get("log");
  const Settings settings = Settings::FromBlob(*inputs.Get("settings"));
  const Schedule done = Schedule::Load(state);
  Planner planner(options_, *log, settings);
  const auto robots = static_cast<std::size_t>(planner.AllRobots());

  RoundSum sum(NoCounts(settings), robots);
  for (std::size_t i = 0; i < partials.size(); ++i) sum.Add(*partials.Get(i));
  std::vector<double> drift = Drifts(state, robots);
  Blob history = Extended(*inputs.Get("history"), done, sum.log_likelihood());
  if (done.summarise) return MakeResult(*log, settings, inputs, sum, drift, history);
  if (options_.calibrate) {
    for (std::size_t r = 0; r < robots; ++r) drift[r] = sum.DriftOf(r, settings.noise, drift[r]);
  }
  const LayeredGrid map = MapOf(sum.counts(), settings.map);
  const Perception perception = PerceptionOf(map, settings.map);
  const Schedule next = done.Next(options_, planner.AllRobots(), sum.log_likelihood());
  const std::vector<Landmark> landmarks = ExtractLandmarks(sum.counts(), settings.map);
  Blob counts;
  sum.counts().Store("counts/", &counts);
  cairn::Step step =
      planner.Plan(next, drift, &perception, &landmarks, std::move(history), std::move(counts));
  step.plan.set_note(Note(done, sum.log_likelihood(), landmarks.size()));
  return step;
}

}  // namespace cairn::landmark_map
