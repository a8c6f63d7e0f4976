#include "pipelines/landmark_map/slice_task.h"

#include <string>
#include <vector>

#include "pipelines/landmark_map/beginning.h"
#include "pipelines/landmark_map/e_step.h"
#include "pipelines/landmark_map/estimate.h"
#include "pipelines/landmark_map/partial.h"
#include "pipelines/landmark_map/round.h"

namespace cairn::landmark_map {
namespace {

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

class SliceTask {
 public:
  SliceTask(const Options& options, const Task& task, const Inputs& inputs, int first, int end)
      : options_(options),
        task_(task),
        inputs_(inputs),
        anywhere_(StartsAnywhere(options, static_cast<std::size_t>(Param("robot").i()))),
        odometry_(OdometryOf(task)),
        settings_(Settings::FromBlob(*inputs.Get("settings"))),
        steps_(RobotSteps::FromBlob(*inputs.Get("steps")).WithoutDrift(odometry_.drift_rad_per_m)),
        slice_{steps_, first, end, Param("name").s()} {
    settings_.noise = odometry_.Widths(settings_.noise);
    const bool mapped = inputs.Has("perception");
    if (mapped) perception_ = Perception::FromBlob(*inputs.Get("perception"));
    model_ = settings_.Model(mapped ? &perception_ : nullptr);
    // Where the map has no landmark a first press is false: a thousandth as likely, which it survives only
    // so.
    constexpr double kWhereLost = 0.1;
    if (anywhere_) model_.prune *= kWhereLost;
  }
  SliceTask(const SliceTask&) = delete;
  SliceTask& operator=(const SliceTask&) = delete;

  Blob Forward(Progress& progress) const {
    const Frontier frontier = ForwardFor(model_, slice_, Before(), Param("work").d(), progress);
    Blob partial;
    frontier.alpha.StoreSparse("alpha/", &partial);
    partial.PutScalar<std::int32_t>("end", frontier.end);
    return partial;
  }

  Blob Backward(Progress& progress) const {
    const LayeredGrid before = Before();
    const Alphas alphas = landmark_map::Forward(model_, slice_, before, progress);
    LayeredGrid beta = BetaOn(alphas.tables.back());
    std::vector<Landmark> landmarks;
    const bool summarise = Param("summarise").b();
    if (summarise) landmarks = LandmarksFromBlob(*inputs_.Get("landmarks"));
    PartialBuilder builder(settings_, slice_, static_cast<int>(Param("robot").i()),
                           summarise ? &landmarks : nullptr, NoCounts(settings_.map));
    if (options_.beliefs) builder.KeepBeliefs();
    const Visitor visitor = CountingIn(&builder, sizeof(double) * static_cast<double>(alphas.Cells()));
    beta = options_.revise
               ? landmark_map::Backward(model_, slice_, alphas, before, std::move(beta), progress, visitor)
               : ForwardOnly(slice_, alphas, before, visitor);
    Blob partial = builder.Finish(alphas);
    if (slice_.first > 0) beta.StoreSparse("beta/", &partial);
    return partial;
  }

 private:
  const proto::Value& Param(const char* name) const { return task_.params().at(name); }

  // alpha before the slice's first step.
  LayeredGrid Before() const {
    if (inputs_.Has("before")) return HandedOver(inputs_, "before", "alpha/", model_.grid.headings);
    return anywhere_ ? UniformStart(model_, slice_) : DiracStart(model_.grid);
  }

  // beta of the slice's last step.
  LayeredGrid BetaOn(const LayeredGrid& alpha) const {
    if (!inputs_.Has("beta") || !inputs_.Get("beta")->Has("beta/box")) return UniformBeta(alpha);
    LayeredGrid beta = HandedOver(inputs_, "beta", "beta/", model_.grid.headings);
    for (std::size_t c = 0; c < beta.layers.size(); ++c) {
      if (beta.layers[c].box != alpha.layers[c].box)
        throw InputError("the input 'beta' does not lie where alpha does, in layer " + std::to_string(c));
    }
    return beta;
  }

  Visitor CountingIn(PartialBuilder* builder, double table_bytes) const {
    Visitor visitor;
    visitor.step = [this, builder, table_bytes](int step, const LayeredGrid& belief) {
      builder->Add(step, belief);
      const double counts = sizeof(double) * static_cast<double>(builder->counts().cells());
      RefuseMemory("alphas and counts", table_bytes + counts, settings_.memory_mb);
    };
    if (options_.calibrate) {
      visitor.leg = [builder](int step, const HalfTurn& posterior) { builder->AddLeg(step, posterior); };
    }
    return visitor;
  }

  const Options& options_;
  const Task& task_;
  const Inputs& inputs_;
  const bool anywhere_;
  const OdometryFit odometry_;
  Settings settings_;
  const RobotSteps steps_;
  const Slice slice_;
  Perception perception_;
  EStepModel model_;
};

}  // namespace

Blob RunSlice(const Options& options, const Task& task, const Inputs& inputs, Progress& progress) {
  const bool forward = task.kind() == "forward";
  const auto [first, end] = Range(task, inputs);
  if (first == end) {  // an empty slice
    Blob partial;
    partial.PutScalar<std::int32_t>(forward ? "end" : "first", end);
    return partial;
  }
  const SliceTask slice(options, task, inputs, first, end);
  return forward ? slice.Forward(progress) : slice.Backward(progress);
}

}  // namespace cairn::landmark_map
