#include "pipelines/landmark_learning/landmark_learning.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "pipelines/landmark_learning/block_task.h"
#include "pipelines/landmark_learning/plan.h"
#include "pipelines/landmark_learning/posterior_error.h"
#include "pipelines/landmark_learning/result.h"
#include "pipelines/landmark_learning/round_sum.h"

namespace cairn::landmark_learning {
namespace {

// Mean over the truths of what they expect before they sense.
double PriorError(const Options& options, const Places& truths, const Places& samples) {
  const auto count = static_cast<std::size_t>(truths.size());
  return PriorErrorOfTruths(Pairs(truths, samples, BeliefOf(options), ErrorOf(options)),
                            std::vector<double>(count, 1.0 / static_cast<double>(count)), {0, truths.size()});
}

// The gradient is zero wherever no sample is in reach of another.
void RefuseLonely(const Options& options, const TrainingData& data) {
  if (PriorError(options, data.training.places, data.training.places) > 0.0) return;
  char text[160];
  std::snprintf(
      text, sizeof text,
      "window_m = %g m reaches no other place from any of the %d samples: there is nothing to tell apart",
      options.window_m, data.training.size());
  throw InputError(text);
}

}  // namespace

Step LandmarkLearning::Start(const Inputs& inputs) const {
  const TrainingData data = TrainingData::Of(*inputs.Get("samples"), options_.holdout);
  RefuseLonely(options_, data);
  Rng rng(seed_);
  Training training;
  training.weights =
      RandomParameters<double>(ShapeOf(options_, data.mean.size()), options_.init_width, rng).values;
  training.prior = PriorError(options_, data.training.places, data.training.places);
  if (data.held_out.size() > 0)
    training.validation_prior = PriorError(options_, data.held_out.places, data.training.places);
  Step step;
  (*step.plan.mutable_state()->mutable_blobs())["data"] = step.Share(data.ToBlob());
  training.Share({}, inputs, &step);
  Planner(options_, data).Plan(training, &step);
  step.plan.set_note(std::to_string(data.training.size()) + " samples of " +
                     std::to_string(data.mean.size()) + " inputs to train on, " +
                     std::to_string(data.held_out.size()) + " held out");
  return step;
}

Blob LandmarkLearning::Run(const Task& task, const Inputs& inputs, Progress& progress) const {
  progress.Tick();
  const TrainingData data = TrainingData::FromBlob(*inputs.Get("data"));
  const Parameters<float> parameters = InFloat(ShapeOf(options_, data.mean.size()), *inputs.Get("weights"));
  const Range block{static_cast<int>(task.params().at("first").i()),
                    static_cast<int>(task.params().at("end").i())};
  Blob partial;
  if (task.kind() == "validate") {
    partial.PutScalar("validation", ValidationOfBlock(options_, data, parameters, block));
    return partial;
  }
  const GradientShare share = GradientOfBlock(options_, data.training, parameters, block);
  partial.PutScalar("error", share.error);
  partial.PutVector("gradient", share.gradient);
  return partial;
}

Step LandmarkLearning::Advance(const State& state, Partials& partials, const Inputs& inputs) const {
  const TrainingData data = TrainingData::FromBlob(*inputs.Get("data"));
  Training t = Training::Of(inputs);
  const Planner planner(options_, data);
  const RoundSum sum = SumOf(partials, t.weights.size());
  t.Record(sum.error, planner.Validates(t.descent.step) ? sum.validation : kNone, Norm(sum.gradient));
  const std::string note = NoteOf(t);
  Step step;
  if (t.descent.step + 1 >= options_.steps || t.since_best >= options_.patience) {
    step = ResultOf(options_, data, t, t.history.All(inputs));
  } else {
    t.descent.Step(RulesOf(options_), sum.gradient, &t.weights);
    (*step.plan.mutable_state()->mutable_blobs())["data"] = state.blobs().at("data");
    t.Share(state, inputs, &step);
    planner.Plan(t, &step);
  }
  step.plan.set_note(note);
  return step;
}

}  // namespace cairn::landmark_learning
