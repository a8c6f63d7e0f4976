#include "pipelines/landmark_learning/landmark_learning.h"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipelines/common/fan_out.h"
#include "pipelines/landmark_learning/advance.h"
#include "pipelines/landmark_learning/data/ancestry.h"
#include "pipelines/landmark_learning/data/error_table.h"
#include "pipelines/landmark_learning/error_sum/posterior_error.h"
#include "pipelines/landmark_learning/plan.h"
#include "pipelines/landmark_learning/starts.h"
#include "pipelines/landmark_learning/state/sum_path.h"
#include "pipelines/landmark_learning/tasks/block_task.h"
#include "pipelines/landmark_learning/tasks/tasks.h"
#include "pipelines/landmark_learning/truth_weights.h"

namespace cairn::landmark_learning {
namespace {

// What true positions expect before they sense, on average.
double PriorError(const Options& options, const SampleSet& true_positions, const SampleSet& samples) {
  return PriorErrorOfTruePositions(
      Pairs(true_positions.positions, samples.positions, BeliefOf(options), ErrorOf(options)),
      true_positions.weight, {0, true_positions.size()});
}

void RequireHeadings(const Options& options, const TrainingData& data) {
  if (!BeliefOf(options).LooksAtHeadings()) return;
  for (const SampleSet* set : {&data.training, &data.held_out}) {
    if (set->heading_rad.size() != set->positions.x_m.size())
      throw InputError(
          "heading_window_deg: it takes samples whose headings are known, 'heading_rad' of each run");
  }
}

// The gradient is zero wherever no sample is in reach of another.
void RequireSamplesInReach(const Options& options, const TrainingData& data) {
  if (PriorError(options, data.training, data.training) > 0.0) return;
  throw InputError(
      fmt::format("window_m = {:g} m reaches no other position from any of the {} samples: there is nothing "
                  "to tell apart",
                  options.window_m, data.training.size()));
}

// Errors that are no function of two positions alone.
void AttachErrors(const Options& options, const Inputs& inputs, TrainingData* data) {
  const bool table = options.error == "table", travel = options.error == "travel";
  for (const auto& [name, needed] : {std::pair("errors", table), std::pair("map", travel)}) {
    if (needed && !inputs.Has(name))
      throw InputError("error=" + options.error + " needs the input '" + name + "': --input " + name +
                       "=FILE.h5");
    if (!needed && inputs.Has(name))
      throw InputError(std::string("the input '") + name + "' is for error=" +
                       (std::string(name) == "map" ? "travel" : "table") + ", not error=" + options.error);
  }
  if (table) AttachTable(*inputs.Get("errors"), data);
  if (travel) AttachTravel(*inputs.Get("map"), data);
}

// What training does not look at; empty: nothing.
std::string OverlookedImages(const Blob& samples, std::size_t inputs) {
  for (std::size_t run = 0; run < samples.Texts("runs").size(); ++run) {
    if (samples.Has("run/" + std::to_string(run) + "/image"))
      return "the samples' images are not looked at, only their " + std::to_string(inputs) +
             " other inputs: `cairn run image_features` makes inputs of images";
  }
  return "";
}

// Some ways to train go on what every step says of all true positions and networks.
void CheckOptionsGoTogether(const Options& options) {
  if (options.cell_m > 0.0 && options.heading_window_deg < 180.0)
    throw InputError("cell_m does not go with heading_window_deg: a cell's samples face whichever way");
  if (options.cell_m > 0.0 && (options.batch > 0 || options.method == "conjugate"))
    throw InputError("cell_m does not go with batch, nor with method=conjugate");
  if (options.starts > 1 && (options.method == "conjugate" || options.sequential))
    throw InputError("starts does not go with sequential, nor with method=conjugate");
  if (options.starts > 1 && StartStepsOf(options) >= options.steps)
    throw InputError("start_steps = " + std::to_string(StartStepsOf(options)) +
                     ": starts are compared before the last of all steps, of which there are " +
                     std::to_string(options.steps));
  const bool steps = options.method != "conjugate" && options.method != "pseudo";
  if (steps) return;
  for (const auto& [name, set] :
       {std::pair("batch", options.batch > 0), std::pair("input_noise", options.input_noise > 0.0),
        std::pair("sequential", options.sequential)}) {
    if (set)
      throw InputError(std::string(name) + " does not go with method=" + options.method +
                       "; allowed: gradient, momentum, adam");
  }
}

}  // namespace

Step LandmarkLearning::Start(const Inputs& inputs) const {
  CheckOptionsGoTogether(options_);
  const BlobPtr samples = inputs.Get("samples");
  const std::vector<std::string> input_names = samples->Texts("input_name");
  const NetworkShape shape = ShapeOf(options_, input_names.size());
  std::optional<Parent> parent;
  if (inputs.Has("weights") && options_.starts > 1)
    throw InputError("starts begin with random weights: they do not go with the input 'weights'");
  if (inputs.Has("weights")) parent = ReadParent(*inputs.Get("weights"), shape, input_names);
  TrainingData data = TrainingData::Of(*samples, options_.holdout, parent ? &parent->norm : nullptr,
                                       ByCommas(options_.unseen));
  RequireHeadings(options_, data);
  WeighTruePositions(options_, &data);
  AttachErrors(options_, inputs, &data);
  RequireSamplesInReach(options_, data);
  Training training;
  const SumPlan sum = PlanSum(options_, data.training.positions);
  const Planner planner(options_, seed_, data, sum);
  Blob stored = BlobOf(data);
  PutFields("sum/", sum, &stored);
  training.learning = FirstLearning(options_);
  training.phase = planner.FirstPhase(training.learning.end);
  training.prior = PriorError(options_, data.training, data.training);
  if (data.held_out.size() > 0)
    training.validation_prior = PriorError(options_, data.held_out, data.training);
  const std::string overlooked = OverlookedImages(*samples, input_names.size());
  if (!overlooked.empty()) training.warnings.push_back(overlooked);
  Rng rng(seed_);
  std::vector<Step> starts;
  for (std::int64_t start = 0; start < options_.starts; ++start) {
    Step& step = starts.emplace_back();
    training.weights =
        parent ? parent->weights : RandomParameters<double>(shape, options_.init_width, rng).values;
    (*step.plan.mutable_state()->mutable_blobs())["data"] = step.Share(stored);
    training.Share({}, inputs, &step);
    planner.Plan(training, &step);
  }
  const int count = static_cast<int>(starts.size());
  Step step = count > 1 ? FanOut(std::move(starts)) : std::move(starts.front());
  if (count > 1) ExpectTrials(options_, 0, count, &step.plan);
  step.plan.set_note(std::to_string(data.training.size()) + " samples of " +
                     std::to_string(data.mean.size()) + " inputs to train on, " +
                     std::to_string(data.held_out.size()) + " held out; " + sum.text +
                     (overlooked.empty() ? "" : "; " + overlooked));
  return step;
}

Blob LandmarkLearning::Run(const Task& task, const Inputs& inputs, Progress& progress) const {
  return RunTask(options_, seed_, task, inputs, progress);
}

Step LandmarkLearning::Advance(const State& state, Partials& partials, const Inputs& inputs) const {
  if (StartsIn(state) > 0) return AdvanceStarts(options_, seed_, state, partials, inputs);
  return AdvanceRound(options_, seed_, state, partials, inputs);
}

}  // namespace cairn::landmark_learning
