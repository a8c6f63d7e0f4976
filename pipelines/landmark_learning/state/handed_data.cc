#include "pipelines/landmark_learning/state/handed_data.h"

#include <limits>

#include "pipelines/common/handed_over.h"

namespace cairn::landmark_learning {
namespace {

constexpr std::int64_t kMostOfAll = std::numeric_limits<std::int32_t>::max();

void Check(const Positions& positions, std::size_t count) {
  RequireWithin("the number of samples", static_cast<std::int64_t>(count), 0, kMostOfAll);
  for (const auto* coordinates : {&positions.x_m, &positions.y_m, &positions.along_m}) {
    RequireSize("positions", coordinates->size(), count);
    RequireAllWithin("a position", *coordinates, -kFar_m, kFar_m);
  }
  for (const auto* direction : {&positions.cos_heading, &positions.sin_heading}) {
    RequireSize("headings", direction->size(), positions.cos_heading.empty() ? 0 : count);
    RequireAllWithin("the cosine of a heading", *direction, -1.0, 1.0);
  }
  if (positions.row.empty()) return;
  RequireSize("rows of the table of errors", positions.row.size(), count);
  RequireSize("the shape of the table of errors", positions.table.shape().size(), 2);
  const std::int64_t rows = positions.table.shape()[0];
  RequireSize("the table of errors", positions.table.As<float>().size(),
              static_cast<std::size_t>(rows * rows));
  RequireAllWithin("a row of the table of errors", positions.row, std::int64_t{0}, rows - 1);
}

// What sums need of positions.
void CheckKnown(const Options& options, const Positions& positions) {
  const auto count = static_cast<std::size_t>(positions.size());
  if (BeliefOf(options).LooksAtHeadings()) RequireSize("headings", positions.cos_heading.size(), count);
  if (ErrorOf(options) == ErrorKind::kTable)
    RequireSize("rows of the table of errors", positions.row.size(), count);
}

void Check(const Options& options, const SampleSet& set, std::size_t inputs) {
  const std::size_t count = set.positions.x_m.size();
  Check(set.positions, count);
  CheckKnown(options, set.positions);
  RequireSize("weight", set.weight.size(), count);
  RequireAllWithin("weight", set.weight, 0.0, 1.0 + 1e-6);
  RequireSize("input", set.input.As<float>().size(), count * inputs);
}

void Check(const Options& options, const TrainingData& data, const SumPlan& sum) {
  RequireWithin("the number of inputs", static_cast<std::int64_t>(data.mean.size()), 1, kMostOfAll);
  Check(options, data.training, data.mean.size());
  Check(options, data.held_out, data.mean.size());
  RequireWithin("the path of the sum", static_cast<std::int64_t>(sum.path), 0,
                static_cast<std::int64_t>(SumPath::kTree));
  if (sum.projected.size() == 0) return;
  Check(sum.projected, data.training.weight.size());
  CheckKnown(options, sum.projected);
}

}  // namespace

HandedData DataIn(const Options& options, const Inputs& inputs) {
  const BlobPtr blob = inputs.Get("data");
  HandedData handed{Read<TrainingData>(*blob), FieldsIn<SumPlan>("sum/", *blob)};
  Check(options, handed.data, handed.sum);
  return handed;
}

}  // namespace cairn::landmark_learning
