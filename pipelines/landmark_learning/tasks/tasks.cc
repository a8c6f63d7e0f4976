#include "pipelines/landmark_learning/tasks/tasks.h"

#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "pipelines/common/handed_over.h"
#include "pipelines/landmark_learning/networks/some_networks.h"
#include "pipelines/landmark_learning/optimizer/batch.h"
#include "pipelines/landmark_learning/optimizer/patterns.h"
#include "pipelines/landmark_learning/state/handed_data.h"
#include "pipelines/landmark_learning/state/state.h"
#include "pipelines/landmark_learning/state/sum_path.h"
#include "pipelines/landmark_learning/tasks/block_task.h"
#include "pipelines/landmark_learning/tasks/compact.h"

namespace cairn::landmark_learning {
namespace {

constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();

// Of so many that there are.
IndexRange BlockOf(const Task& task, std::size_t count) {
  const std::int64_t end = IntegerOf(task, "end", 1, static_cast<std::int64_t>(count));
  return {static_cast<int>(IntegerOf(task, "first", 0, end - 1)), static_cast<int>(end)};
}
IndexRange BlockOf(const Task& task, const SampleSet& set) { return BlockOf(task, set.weight.size()); }

int InUse(const Task& task, std::int64_t networks) {
  return static_cast<int>(IntegerOf(task, "in_use", 1, networks));
}

// Those in use.
Parameters<float> NetworksOf(const Parameters<float>& all, const Task& task) {
  return SomeNetworks(all, 0, InUse(task, all.shape.networks));
}

// The first network in use that learns.
int LearnsFrom(const Task& task) {
  return static_cast<int>(IntegerOf(task, "learns", 0, IntegerOf(task, "in_use", 1, kMost) - 1));
}

std::int64_t StepOf(const Task& task) {
  return IntegerOf(task, "step", 0, std::numeric_limits<std::int64_t>::max());
}

InputNoise NoiseOf(const Options& options, std::uint64_t seed, const Task& task) {
  return {options.input_noise, seed, StepOf(task)};
}

Blob GradientTask(const Options& options, const SumPlan& sum, std::uint64_t seed, const TrainingData& data,
                  const Parameters<float>& all, const Task& task) {
  std::vector<IndexRange> true_positions;
  double scale = 1.0;
  const auto drawn = DrawnStretches(data.training.size(), options.batch, seed, StepOf(task));
  if (TruePositionsIn(drawn) < data.training.size()) {  // the block is one of stretches
    const IndexRange block = BlockOf(task, drawn.size());
    scale = static_cast<double>(data.training.size()) / TruePositionsIn(drawn);
    true_positions.assign(drawn.begin() + block.first, drawn.begin() + block.end);
  } else {
    true_positions = {BlockOf(task, data.training)};
  }
  const GradientShare share =
      GradientOfStretches(options, sum, data.training, NetworksOf(all, task), true_positions, scale,
                          NoiseOf(options, seed, task), LearnsFrom(task));
  Blob partial;
  partial.PutScalar("error", share.error);
  partial.PutVector("gradient", share.gradient);
  return partial;
}

Blob OutputGradientTask(const Options& options, const SumPlan& sum, const TrainingData& data,
                        const Parameters<float>& all, const Task& task) {
  const OutputGradientShare share =
      OutputGradientOfBlock(options, sum, data.training, all, BlockOf(task, data.training));
  Blob partial;
  partial.PutScalar("error", share.error);
  partial.PutScalar<std::int64_t>("first", std::int64_t{share.reach.first} * all.shape.networks);
  partial.PutVector("gradient", share.d_output);
  return partial;
}

// Where in a table [samples][networks] a block's rows begin.
std::int64_t FirstOf(const IndexRange& block, int networks) { return std::int64_t{block.first} * networks; }

// The three phases of a step. What is no error is a table, named `gradients` as all that adds up is.
Blob OutputsTask(const TrainingData& data, const Parameters<float>& all, const InputNoise& noise,
                 const Task& task) {
  const IndexRange block = BlockOf(task, data.training);
  const Parameters<float> networks = NetworksOf(all, task);
  Blob partial;
  partial.PutScalar("error", 0.0);
  partial.PutScalar<std::int64_t>("first", FirstOf(block, networks.shape.networks));
  const InputRows rows(data.training.inputs(), block, networks.shape.inputs, noise);
  partial.PutVector("gradient", Forward(networks, rows.data(), block.size()).output);
  return partial;
}

Blob PairsTask(const Options& options, const SumPlan& sum, const TrainingData& data, const Blob& outputs,
               const Task& task) {
  const int networks = InUse(task, options.networks);
  const auto g = outputs.Get<float>("output");
  RequireSize("output", g.size(), data.training.weight.size() * static_cast<std::size_t>(networks));
  OutputGradientShare share;
  if (options.cell_m > 0.0) {
    const Cells cells = CellsOf(data.training, options.cell_m);
    auto of_cells =
        OutputGradientOfCells<float>(options, cells, g, networks, BlockOf(task, cells.weight.size()));
    share = {of_cells.error, {0, data.training.size()}, std::move(of_cells.d_output)};
  } else {
    share = OutputGradientOfOutputs(options, sum, data.training, g, networks, BlockOf(task, data.training));
  }
  Blob partial;
  partial.PutScalar("error", share.error);
  partial.PutScalar<std::int64_t>("first", FirstOf(share.reach, networks));
  partial.PutVector("gradient", share.d_output);
  return partial;
}

Blob WeightsTask(const TrainingData& data, const Parameters<float>& all, const Blob& gradient_of_sum,
                 const InputNoise& noise, const Task& task) {
  const IndexRange block = BlockOf(task, data.training);
  const Parameters<float> networks = NetworksOf(all, task);
  const int in_use = networks.shape.networks;
  const auto all_d_output = gradient_of_sum.Get<double>("gradient");
  RequireSize("gradient", all_d_output.size(),
              data.training.weight.size() * static_cast<std::size_t>(in_use));
  const auto d_output =
      all_d_output.subspan(static_cast<std::size_t>(FirstOf(block, in_use)),
                           static_cast<std::size_t>(block.size()) * static_cast<std::size_t>(in_use));
  const InputRows rows(data.training.inputs(), block, networks.shape.inputs, noise);
  const auto gradient =
      BackwardFrom(LearnsFrom(task), networks, rows.data(), block.size(),
                   Forward(networks, rows.data(), block.size()), {d_output.begin(), d_output.end()});
  Blob partial;
  partial.PutScalar("error", 0.0);
  partial.PutVector("gradient", gradient.values);
  return partial;
}

// At a position along the line.
Blob SearchTask(const Options& options, const TrainingData& data, const NetworkShape& shape,
                const Inputs& inputs, const Task& task) {
  const Conjugate line = FieldsIn<Conjugate>("conjugate/", *inputs.Get("training"));
  const auto from = inputs.Get("parameters")->Get<double>("weights");
  const auto length = static_cast<std::size_t>(
      IntegerOf(task, "length", 0, static_cast<std::int64_t>(std::size(Conjugate::kTried)) - 1));
  RequireSize("direction", line.direction.size(), from.size());
  const auto weights =
      AlongLine({from.begin(), from.end()}, line.direction, line.length * Conjugate::kTried.at(length));
  Blob partial;
  partial.PutScalar<std::int64_t>("length", static_cast<std::int64_t>(length));
  partial.PutScalar("error", ErrorOfBlock(options, data.training, data.training, InFloat(shape, weights),
                                          BlockOf(task, data.training)));
  return partial;
}

Blob FitTask(const Options& options, const TrainingData& data, const Parameters<float>& rounded,
             const Inputs& inputs, const Task& task, Progress& progress) {
  const auto network = static_cast<int>(IntegerOf(task, "network", 0, rounded.shape.networks - 1));
  const BlobPtr blob = inputs.Get("parameters");
  const auto weights = blob->Get<double>("weights");
  Parameters<double> all(rounded.shape);
  all.values.assign(weights.begin(), weights.end());
  Parameters<double> own = SomeNetworks(all, network, network + 1);
  const BlobPtr gradient_of_sum = inputs.Get("gradient");
  const auto slope = gradient_of_sum->Get<double>("gradient");
  RequireSize("gradient", slope.size(),
              data.training.weight.size() * static_cast<std::size_t>(all.shape.networks));
  const auto now =
      Forward(SomeNetworks(rounded, network, network + 1), data.training.inputs(), data.training.size());
  std::vector<float> target;
  for (std::size_t k = 0; k < now.output.size(); ++k) {
    const std::size_t at =
        k * static_cast<std::size_t>(all.shape.networks) + static_cast<std::size_t>(network);
    target.push_back(PatternTarget(now.output[k], options.pattern_step, slope[at] * data.training.size()));
  }
  Blob partial;
  partial.PutVector("weights", FitPatterns(own.shape, std::move(own.values), data.training.inputs(), target,
                                           RulesOf(options), options.pattern_steps, progress));
  return partial;
}

}  // namespace

Blob RunTask(const Options& options, std::uint64_t seed, const Task& task, const Inputs& inputs,
             Progress& progress) {
  progress.Tick();
  RequireKind(task,
              {"pairs", "search", "gradient", "output_gradient", "outputs", "weights", "fit", "validate"});
  const auto [data, sum] = DataIn(options, inputs);
  const NetworkShape shape = ShapeOf(options, data.mean.size());
  if (task.kind() == "pairs") return PairsTask(options, sum, data, *inputs.Get("outputs"), task);
  if (task.kind() == "search") return SearchTask(options, data, shape, inputs, task);
  const Parameters<float> all = InFloat(shape, *inputs.Get("parameters"));
  if (task.kind() == "gradient") return GradientTask(options, sum, seed, data, all, task);
  if (task.kind() == "output_gradient") return OutputGradientTask(options, sum, data, all, task);
  if (task.kind() == "outputs") return OutputsTask(data, all, NoiseOf(options, seed, task), task);
  if (task.kind() == "weights")
    return WeightsTask(data, all, *inputs.Get("gradient"), NoiseOf(options, seed, task), task);
  if (task.kind() == "fit") return FitTask(options, data, all, inputs, task, progress);
  Blob partial;
  partial.PutScalar("validation", ErrorOfBlock(options, data.held_out, data.training, NetworksOf(all, task),
                                               BlockOf(task, data.held_out)));
  return partial;
}

}  // namespace cairn::landmark_learning
