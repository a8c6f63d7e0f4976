#include "pipelines/landmark_learning/landmark_learning.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "pipelines/landmark_learning/block_task.h"
#include "pipelines/landmark_learning/descent.h"
#include "pipelines/landmark_learning/posterior_error.h"

namespace cairn::landmark_learning {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// What the State holds besides `data`: the weights that a step starts from, those that did best on the
// held-out run, the optimiser's memory, a row a step.
struct Training {
  std::vector<double> weights, best;
  Descent descent;
  std::vector<double> error, validation, norm;
  double prior = 0.0, validation_prior = kNone;
  std::int64_t since_best = 0;  // looks at the held-out run

  Blob ToBlob() const;
  static Training FromBlob(const Blob& blob);
};

template <class S, class F>
void VisitVectors(S& t, const F& f) {
  f("weights", t.weights);
  f("best", t.best);
  f("error", t.error);
  f("validation", t.validation);
  f("norm", t.norm);
}

Blob Training::ToBlob() const {
  Blob blob;
  VisitVectors(*this,
               [&](const char* name, const std::vector<double>& values) { blob.PutVector(name, values); });
  blob.PutAll("descent/", descent.ToBlob());
  blob.PutScalar("prior", prior);
  blob.PutScalar("validation_prior", validation_prior);
  blob.PutScalar("since_best", since_best);
  return blob;
}

Training Training::FromBlob(const Blob& blob) {
  Training t;
  VisitVectors(t, [&](const char* name, std::vector<double>& values) {
    const auto stored = blob.Get<double>(name);
    values.assign(stored.begin(), stored.end());
  });
  t.descent = Descent::FromBlob(blob.Sub("descent/"));
  t.prior = blob.Scalar<double>("prior");
  t.validation_prior = blob.Scalar<double>("validation_prior");
  t.since_best = blob.Scalar<std::int64_t>("since_best");
  return t;
}

NetworkShape ShapeOf(const Options& options, std::size_t inputs) {
  return {static_cast<int>(options.networks), static_cast<int>(inputs), static_cast<int>(options.hidden)};
}

DescentRules RulesOf(const Options& options) {
  const Method method = options.method == "gradient"   ? Method::kGradient
                        : options.method == "momentum" ? Method::kMomentum
                                                       : Method::kAdam;
  return {method, options.rate, options.momentum, options.weight_decay};
}

Parameters<float> InFloat(const NetworkShape& shape, const std::vector<double>& weights) {
  Parameters<float> parameters(shape);
  std::ranges::transform(weights, parameters.values.begin(), [](double w) { return static_cast<float>(w); });
  return parameters;
}

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

class Planner {
 public:
  Planner(const Options& options, const TrainingData& data) : options_(options), data_(data) {}

  // The tasks of the next step.
  void Plan(const Training& training, Step* step) const {
    State& state = *step->plan.mutable_state();
    const NetworkShape shape = ShapeOf(options_, data_.mean.size());
    Blob weights;
    weights.PutVector("weights", InFloat(shape, training.weights).values);
    (*state.mutable_blobs())["weights"] = step->Share(weights);
    (*state.mutable_blobs())["training"] = step->Share(training.ToBlob());
    const int samples = data_.training.size();
    for (const Range& block : Blocks(samples, samples, shape.networks)) Add("gradient", block, &step->plan);
    if (Validates(training.descent.step)) {
      for (const Range& block : Blocks(data_.held_out.size(), samples, shape.networks))
        Add("validate", block, &step->plan);
    }
    step->plan.set_rounds_left(static_cast<std::uint32_t>(options_.steps - training.descent.step));
  }
  bool Validates(std::int64_t steps_done) const {
    return data_.held_out.size() > 0 && steps_done % options_.validate_every == 0;
  }

 private:
  static void Add(const char* kind, const Range& block, proto::Step* plan) {
    Task& task = *plan->add_tasks();
    task.set_index(static_cast<std::uint32_t>(plan->tasks_size() - 1));
    task.set_kind(kind);
    task.set_cost(static_cast<std::uint64_t>(block.size()));
    (*task.mutable_params())["first"].set_i(block.first);
    (*task.mutable_params())["end"].set_i(block.end);
    for (const char* name : {"data", "weights"}) {
      proto::InputRef& input = *task.add_inputs();
      input.set_name(name);
      input.set_blob(plan->state().blobs().at(name));
    }
  }

  const Options& options_;
  const TrainingData& data_;
};

struct RoundSum {
  double error = 0.0, validation = 0.0;
  std::vector<double> gradient;
};

RoundSum SumOf(Partials& partials, std::size_t parameters) {
  RoundSum sum;
  sum.gradient.assign(parameters, 0.0);
  for (std::size_t i = 0; i < partials.size(); ++i) {
    const BlobPtr partial = partials.Get(i);
    if (partial->Has("validation")) {
      sum.validation += partial->Scalar<double>("validation");
      continue;
    }
    sum.error += partial->Scalar<double>("error");
    const auto gradient = partial->Get<float>("gradient");
    if (gradient.size() != parameters) throw InputError("a partial's gradient is by other weights");
    for (std::size_t p = 0; p < parameters; ++p) sum.gradient[p] += gradient[p];
  }
  return sum;
}

double Norm(const std::vector<double>& gradient) {
  double squares = 0.0;
  for (const double slope : gradient) squares += slope * slope;
  return std::sqrt(squares);
}

std::string Note(const Training& t) {
  char text[200];
  const double reduction = 100.0 * (1.0 - t.error.back() / t.prior);
  int length = std::snprintf(text, sizeof text, "step %zu: error %.3f m of %.3f m, reduced by %.1f%%",
                             t.error.size(), t.error.back(), t.prior, reduction);
  if (!std::isnan(t.validation.back())) {
    length += std::snprintf(text + length, sizeof text - static_cast<std::size_t>(length),
                            "; held out %.1f%%", 100.0 * (1.0 - t.validation.back() / t.validation_prior));
  }
  if (t.norm.back() == 0.0)
    std::snprintf(text + length, sizeof text - static_cast<std::size_t>(length),
                  "; the gradient is exactly zero");
  return text;
}

void PutNetworks(const Parameters<float>& p, Blob* result) {
  const NetworkShape& s = p.shape;
  std::vector<double> hidden_weight, hidden_bias, output_weight, output_bias;
  for (int u = 0; u < s.units(); ++u) {
    for (int i = 0; i < s.inputs; ++i) hidden_weight.push_back(p.HiddenWeights(i)[u]);
    hidden_bias.push_back(p.HiddenBiases()[u]);
    output_weight.push_back(p.OutputWeights()[u]);
  }
  for (int n = 0; n < s.networks; ++n) output_bias.push_back(p.OutputBiases()[n]);
  result->Put("networks/hidden_weight", Array::Of<double>({s.networks, s.hidden, s.inputs}, hidden_weight));
  result->Put("networks/hidden_bias", Array::Of<double>({s.networks, s.hidden}, hidden_bias));
  result->Put("networks/output_weight", Array::Of<double>({s.networks, s.hidden}, output_weight));
  result->PutVector("networks/output_bias", output_bias);
}

Step Result(const Options& options, const TrainingData& data, const Training& t) {
  const Parameters<float> parameters =
      InFloat(ShapeOf(options, data.mean.size()), t.best.empty() ? t.weights : t.best);
  Blob result;
  PutNetworks(parameters, &result);
  result.PutVector("networks/input_mean", data.mean);
  result.PutVector("networks/input_scale", data.scale);
  result.Put("networks/input_name", Array::Texts(data.input_names));
  const SampleSet& set = data.training;
  result.PutVector("map/x_m", set.places.x_m);
  result.PutVector("map/y_m", set.places.y_m);
  result.PutVector("map/along_m", set.places.along_m);
  result.PutVector("map/run", set.run);
  result.Put("map/output", Array::Of<float>({set.size(), parameters.shape.networks},
                                            Forward(parameters, set.inputs.data(), set.size()).output));
  result.Put("runs", Array::Texts(data.runs));
  result.PutVector("history/training_error_m", t.error);
  result.PutVector("history/validation_error_m", t.validation);
  result.PutVector("history/gradient_norm", t.norm);
  result.PutScalar("prior_error_m", t.prior);
  result.PutScalar("validation_prior_error_m", t.validation_prior);
  result.PutScalar("window_m", options.window_m);
  Step step;
  step.plan.set_result(step.Share(result));
  step.plan.set_note(Note(t));
  return step;
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
  Planner(options_, data).Plan(training, &step);
  step.plan.set_note(std::to_string(data.training.size()) + " samples of " +
                     std::to_string(data.mean.size()) + " inputs to train on, " +
                     std::to_string(data.held_out.size()) + " held out");
  return step;
}

Blob LandmarkLearning::Run(const Task& task, const Inputs& inputs, Progress& progress) const {
  progress.Tick();
  const TrainingData data = TrainingData::FromBlob(*inputs.Get("data"));
  Parameters<float> parameters(ShapeOf(options_, data.mean.size()));
  const auto weights = inputs.Get("weights")->Get<float>("weights");
  if (weights.size() != parameters.values.size()) {
    throw InputError("there are " + std::to_string(weights.size()) + " weights where the networks have " +
                     std::to_string(parameters.values.size()));
  }
  parameters.values.assign(weights.begin(), weights.end());
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
  Training t = Training::FromBlob(*inputs.Get("training"));
  const Planner planner(options_, data);
  const RoundSum sum = SumOf(partials, t.weights.size());
  t.error.push_back(sum.error);
  t.norm.push_back(Norm(sum.gradient));
  t.validation.push_back(planner.Validates(t.descent.step) ? sum.validation : kNone);
  if (!std::isnan(t.validation.back())) {
    const bool better = std::none_of(t.validation.begin(), t.validation.end() - 1,
                                     [&](double earlier) { return earlier <= t.validation.back(); });
    if (better) t.best = t.weights;
    t.since_best = better ? 0 : t.since_best + 1;
  }
  if (t.descent.step + 1 >= options_.steps || t.since_best >= options_.patience)
    return Result(options_, data, t);
  t.descent.Step(RulesOf(options_), sum.gradient, &t.weights);
  Step step;
  (*step.plan.mutable_state()->mutable_blobs())["data"] = state.blobs().at("data");
  planner.Plan(t, &step);
  step.plan.set_note(Note(t));
  return step;
}

}  // namespace cairn::landmark_learning
