#include "pipelines/landmark_learning/advance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pipelines/common/handed_over.h"
#include "pipelines/landmark_learning/networks/some_networks.h"
#include "pipelines/landmark_learning/plan.h"
#include "pipelines/landmark_learning/result.h"
#include "pipelines/landmark_learning/starts.h"
#include "pipelines/landmark_learning/state/handed_data.h"
#include "pipelines/landmark_learning/state/round_sum.h"
#include "schema/kinds/map_so_far.h"

namespace cairn::landmark_learning {
namespace {

class Round {
 public:
  Round(const Options& options, std::uint64_t seed, const State& state, const Inputs& inputs, bool on_trial)
      : on_trial_(on_trial),
        options_(options),
        state_(state),
        inputs_(inputs),
        handed_(DataIn(options, inputs)),
        planner_(options_, seed, data_, handed_.sum),
        t_(Training::Of(options, Shape(), inputs)) {}

  Step End(Partials& partials) {
    if (t_.phase == Phase::kSearch) return EndSearch(partials);
    if (t_.phase == Phase::kFit) return EndFit(partials);
    return planner_.FindsGradient(t_.phase) ? EndGradient(partials) : EndPhase(partials);
  }

 private:
  NetworkShape Shape() const { return ShapeOf(options_, data_.mean.size()); }

  // What the next phase reads: the outputs, or E and its gradients by them.
  Step EndPhase(Partials& partials) {
    const bool outputs = t_.phase == Phase::kOutputs;
    const RoundSum sum = SumOf(partials, static_cast<std::size_t>(data_.training.size()) *
                                             static_cast<std::size_t>(t_.learning.end));
    Step step;
    Blob blob;
    if (outputs) {
      blob.PutVector("output", std::vector<float>(sum.gradient.begin(), sum.gradient.end()));
    } else {
      blob.PutScalar("error", sum.error);
      blob.PutVector("gradient", sum.gradient);
    }
    (*step.plan.mutable_state()->mutable_blobs())[outputs ? "outputs" : "gradient"] =
        step.Share(std::move(blob));
    t_.phase = outputs ? Phase::kPairs : Phase::kWeights;
    return Next(std::move(step),
                "step " + std::to_string(t_.steps + 1) + (outputs ? ": outputs" : ": pairs"));
  }

  Step EndGradient(Partials& partials) {
    const bool by_outputs = t_.phase == Phase::kOutputGradient || t_.phase == Phase::kPairs;
    NetworkShape learning = Shape();
    learning.networks = t_.learning.end - t_.learning.first;
    const std::size_t size = by_outputs ? static_cast<std::size_t>(data_.training.size()) *
                                              static_cast<std::size_t>(learning.networks)
                                        : learning.parameters();
    RoundSum sum = SumOf(partials, size);
    if (t_.phase == Phase::kWeights) sum.error = inputs_.Get("gradient")->Scalar<double>("error");
    // [Thr98] table 2
    t_.Record(sum.error, planner_.Validates(t_.steps) ? sum.validation : kNone, Norm(sum.gradient));
    std::string note = NoteOf(options_, t_);
    if (const std::string warning = t_.Warn(Saturated(sum.gradient, learning, by_outputs)); !warning.empty())
      note += "; " + warning;
    if (IsOver()) return Result(note);
    Step step;
    if (by_outputs) {
      t_.phase = Phase::kFit;
      Blob gradient_of_sum;
      gradient_of_sum.PutVector("gradient", sum.gradient);
      (*step.plan.mutable_state()->mutable_blobs())["gradient"] = step.Share(std::move(gradient_of_sum));
    } else if (options_.method == "conjugate") {
      t_.phase = Phase::kSearch;
      AddPenalty(&sum.gradient);
      t_.conjugate.Turn(sum.error + PenaltyOf(t_.weights), sum.gradient, RateOf(options_));
    } else {
      Descend(sum.gradient);
    }
    return Next(std::move(step), note);
  }

  // Networks that no step of any size would move.
  std::vector<std::int32_t> Saturated(const std::vector<double>& gradient_of_sum,
                                      const NetworkShape& learning, bool by_outputs) const {
    std::vector<std::int32_t> saturated;
    Parameters<double> gradient(learning);
    if (!by_outputs) gradient.values = gradient_of_sum;
    for (int n = 0; n < learning.networks; ++n) {
      double largest = 0.0;
      if (by_outputs) {
        for (std::size_t i = static_cast<std::size_t>(n); i < gradient_of_sum.size();
             i += static_cast<std::size_t>(learning.networks))
          largest = std::max(largest, std::abs(gradient_of_sum[i]));
      } else {
        for (const double slope : SomeNetworks(gradient, n, n + 1).values)
          largest = std::max(largest, std::abs(slope));
      }
      if (largest == 0.0) saturated.push_back(t_.learning.first + n);
    }
    return saturated;
  }

  // Whether training ends before the step; else, where networks come one after another, the next one may
  // join.
  bool IsOver() {
    if (on_trial_) return false;
    if (t_.steps + 1 >= options_.steps) return true;
    // [Thr98] section 4.3: early stopping by a run that is held out
    const bool patient = t_.since_best < options_.patience;
    if (!options_.sequential || t_.learning.end == options_.networks) return !patient;
    if (patient && t_.network_steps + 1 < options_.steps / options_.networks) return false;
    joins_ = true;
    return false;
  }

  // A step of the networks that learn; where the next one joins there is none.
  void Descend(const std::vector<double>& gradient) {
    ++t_.steps;
    ++t_.network_steps;
    if (joins_) t_.NextNetwork();
    t_.phase = planner_.FirstPhase(t_.learning.end);
    if (joins_) return;
    Parameters<double> all(Shape());
    all.values = std::move(t_.weights);
    Parameters<double> learning = SomeNetworks(all, t_.learning.first, t_.learning.end);
    t_.descent.Step(RulesOf(options_), gradient, &learning.values);
    PutNetworks(learning, t_.learning.first, &all);
    t_.weights = std::move(all.values);
  }

  // Conjugate gradients go down one function: E and half of weight_decay times the squares of the weights.
  void AddPenalty(std::vector<double>* gradient) const {
    for (std::size_t i = 0; i < gradient->size(); ++i)
      (*gradient)[i] += options_.weight_decay * t_.weights[i];
  }
  double PenaltyOf(const std::vector<double>& weights) const {
    double squares = 0.0;
    for (const double w : weights) squares += w * w;
    return 0.5 * options_.weight_decay * squares;
  }

  Step EndSearch(Partials& partials) {
    std::vector<double> errors = SearchedErrors(partials, Conjugate::kTried.size());
    for (std::size_t i = 0; i < errors.size(); ++i) {
      errors[i] += PenaltyOf(
          AlongLine(t_.weights, t_.conjugate.direction, t_.conjugate.length * Conjugate::kTried[i]));
    }
    const double taken = t_.conjugate.Choose(errors);
    const std::string note = fmt::format("step {}: goes {:.3g} of its line", t_.steps + 1, taken);
    if (t_.conjugate.Stuck()) return Result("no step along the slope lowers the error: training ends");
    t_.weights = AlongLine(std::move(t_.weights), t_.conjugate.direction, taken);
    ++t_.steps;
    t_.phase = planner_.FirstPhase(t_.learning.end);
    return Next({}, note);
  }

  Step EndFit(Partials& partials) {
    Parameters<double> all(Shape());
    RequireSize("the networks that were fitted", partials.size(),
                static_cast<std::size_t>(all.shape.networks));
    for (std::size_t i = 0; i < partials.size(); ++i) {
      NetworkShape one = all.shape;
      one.networks = 1;
      Parameters<double> fitted(one);
      const BlobPtr partial = partials.Get(i);
      const auto weights = partial->Get<double>("weights");
      if (weights.size() != fitted.values.size())
        throw InputError("a partial's weights are of another shape");
      fitted.values.assign(weights.begin(), weights.end());
      PutNetworks(fitted, static_cast<int>(i), &all);
    }
    t_.weights = std::move(all.values);
    ++t_.steps;
    t_.phase = planner_.FirstPhase(t_.learning.end);
    return Next(
        {}, "step " + std::to_string(t_.steps) + ": " + std::to_string(partials.size()) + " networks fitted");
  }

  Step Next(Step step, const std::string& note) {
    for (const char* name : {"data", "starts"}) {
      if (state_.blobs().contains(name))
        (*step.plan.mutable_state()->mutable_blobs())[name] = state_.blobs().at(name);
    }
    if (on_trial_ && t_.steps == StartStepsOf(options_) && t_.phase == planner_.FirstPhase(t_.learning.end))
      (*step.plan.mutable_state()->mutable_scalars())[kTrialScore].set_d(
          ScoreOf(t_.history.All(inputs_).error, t_.best_validation));
    if (IsToBeShown())
      ShowSoFar(&step);
    else
      step.plan.mutable_state()->set_so_far(state_.so_far());
    t_.Share(state_, inputs_, &step);
    planner_.Plan(t_, &step);
    step.plan.set_note(note);
    return step;
  }

  // Of long trainings every so many steps.
  bool IsToBeShown() const {
    constexpr std::int64_t kPart = 20;
    return !on_trial_ && data_.training.size() > 0 && t_.phase == planner_.FirstPhase(t_.learning.end) &&
           t_.steps % (1 + t_.steps / kPart) == 0;
  }

  // For people to look at while the stage runs: what the networks make of the first run, or of so many of its
  // samples as take no time.
  void ShowSoFar(Step* step) const {
    constexpr double kMostProducts = 1e7, kMostSamples = 500;
    const SampleSet& set = data_.training;
    RequireSize("run", set.run.size(), static_cast<std::size_t>(set.size()));
    RequireSize("along_m", set.positions.along_m.size(), set.run.size());
    Parameters<double> all(Shape());
    all.values = t_.weights;
    const Parameters<double> used = SomeNetworks(all, 0, t_.learning.end);
    std::vector<int> rows;
    const std::int32_t first = *std::ranges::min_element(set.run);
    for (int row = 0; row < set.size(); ++row)
      if (set.run[static_cast<std::size_t>(row)] == first) rows.push_back(row);
    const std::vector<double>& along_m = set.positions.along_m;
    std::ranges::stable_sort(rows, {}, [&](int row) { return along_m[static_cast<std::size_t>(row)]; });
    const double most =
        std::clamp(kMostProducts / static_cast<double>(used.values.size()), 1.0, kMostSamples);
    const auto every = static_cast<std::size_t>(std::ceil(static_cast<double>(rows.size()) / most));
    kinds::MapSoFar map;
    std::vector<double> along;
    std::vector<float> input;
    for (std::size_t k = 0; k < rows.size(); k += every) {
      const float* const of = set.inputs() + static_cast<std::size_t>(rows[k]) * data_.mean.size();
      input.insert(input.end(), of, of + data_.mean.size());
      along.push_back(along_m[static_cast<std::size_t>(rows[k])]);
    }
    map.what = fmt::format("step {}", t_.steps);
    map.map.run = std::vector<std::int32_t>(along.size(), first);
    map.map.output = {
        {std::ssize(along), used.shape.networks},
        Forward(InFloat(used.shape, used.values), input.data(), static_cast<int>(along.size())).output};
    map.map.along_m = along;
    step->plan.mutable_state()->set_so_far(step->Share(BlobOf(map)));
  }

  Step Result(const std::string& note) {
    const BlobPtr parent = inputs_.Has("weights") ? inputs_.Get("weights") : nullptr;
    const BlobPtr starts = inputs_.Has("starts") ? inputs_.Get("starts") : nullptr;
    Step step = ResultOf(options_, data_, t_, t_.history.All(inputs_), parent.get(), starts.get());
    step.plan.set_note(note);
    return step;
  }

  const bool on_trial_;
  const Options& options_;
  const State& state_;
  const Inputs& inputs_;
  const HandedData handed_;
  const TrainingData& data_ = handed_.data;
  Planner planner_;
  Training t_;
  bool joins_ = false;
};

}  // namespace

Step AdvanceRound(const Options& options, std::uint64_t seed, const State& state, Partials& partials,
                  const Inputs& inputs, bool on_trial) {
  return Round(options, seed, state, inputs, on_trial).End(partials);
}

}  // namespace cairn::landmark_learning
