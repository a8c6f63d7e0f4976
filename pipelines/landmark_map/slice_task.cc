#include "pipelines/landmark_map/slice_task.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipelines/common/handed_over.h"
#include "pipelines/landmark_map/estimate.h"
#include "pipelines/landmark_map/initial_state.h"
#include "pipelines/landmark_map/model/e_step.h"
#include "pipelines/landmark_map/round.h"
#include "pipelines/landmark_map/state/nearby_start.h"
#include "pipelines/landmark_map/state/partial.h"
#include "pipelines/landmark_map/state/speculation.h"

namespace cairn::landmark_map {
namespace {

// A table that another task handed over; a layer for each heading.
LayeredGrid HandedOver(const Inputs& inputs, const std::string& input, const std::string& prefix,
                       const Settings& settings) {
  const int headings = settings.map.grid.headings;
  LayeredGrid grid = LayeredGrid::LoadSparse(prefix, *inputs.Get(input), settings.MostCells());
  if (grid.layers.size() != static_cast<std::size_t>(headings)) {
    throw InputError("the input '" + input + "' has " + std::to_string(grid.layers.size()) +
                     " layers where the grid has " + std::to_string(headings) + " headings");
  }
  return grid;
}

// The steps of a task's slice. Where slices are guessed they are those of the round before; else it goes from
// where the forward task before it ended to where the backward task after it began, and `forward` tasks may
// go on to the end of all.
std::pair<int, int> SliceBounds(const Task& task, const Inputs& inputs) {
  const auto count = static_cast<int>(IntegerOf(task, "count", 0, kMostSteps));
  int first = 0, end = count;
  if (inputs.Has("before")) first = inputs.Get("before")->Scalar<std::int32_t>("end");
  if (inputs.Has("beta")) end = inputs.Get("beta")->Scalar<std::int32_t>("first");
  if (inputs.Has("guesses")) {
    const auto firsts = inputs.Get("guesses")->Get<std::int32_t>("first");
    const auto slice = static_cast<std::size_t>(IntegerOf(task, "slice", 0, kMostSteps));
    if (slice < firsts.size()) first = firsts[slice];
    if (slice + 1 < firsts.size()) end = firsts[slice + 1];
  }
  if (first < 0 || first > end || end > count) {
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
        odometry_(OdometryOf(task)),
        settings_(Settings::In(*inputs.Get("settings"), options)),
        robot_(static_cast<int>(IntegerOf(task, "robot", 0, std::numeric_limits<std::int32_t>::max()))),
        gauge_free_(settings_.gauge_free && robot_ == 0 && Param("joint").b()),
        anywhere_(gauge_free_ || StartsAnywhere(options, static_cast<std::size_t>(robot_))),
        steps_(RobotSteps::In(*inputs.Get("steps"), settings_.map.layers(), settings_.map.grid.cell_m)
                   .WithoutDrift(odometry_.drift_rad_per_m)),
        slice_{steps_, first, end, Param("name").s()} {
    IntegerOf(task, "count", end, steps_.size());
    settings_.noise = odometry_.Widths(settings_.noise);
    const bool mapped = inputs.Has("perception");
    if (mapped) perception_ = Read<Perception>(*inputs.Get("perception"));
    if (mapped) perception_.Check(settings_.map.layers());
    model_ = settings_.Model(mapped ? &perception_ : nullptr);
    // Where the map has no landmark a first contact detection is false: a thousandth as likely, which it
    // survives only so.
    constexpr double kWhereLost = 0.1;
    if (anywhere_) model_.prune *= kWhereLost;
  }
  SliceTask(const SliceTask&) = delete;
  SliceTask& operator=(const SliceTask&) = delete;

  Blob Forward(Progress& progress) const {
    const LayeredGrid before = Before();
    if (const auto guessed = WhatWasGuessed("forward/", before, nullptr)) return *guessed;
    const double work = inputs_.Has("guesses") ? kToTheEnd : Param("work").d();
    const Frontier frontier = ForwardFor(model_, slice_, before, work, progress);
    return ForwardPartial(frontier.alpha, frontier.end);
  }

  Blob Backward(Progress& progress) const {
    const LayeredGrid before = Before();
    std::optional<LayeredGrid> beta;
    if (inputs_.Has("beta") && inputs_.Get("beta")->Has("beta/box"))
      beta = HandedOver(inputs_, "beta", "beta/", settings_);
    if (const auto guessed = WhatWasGuessed("backward/", before, beta ? &*beta : nullptr)) return *guessed;
    const Alphas alphas = landmark_map::Forward(model_, slice_, before, progress);
    if (!beta) beta = UniformBeta(alphas.tables.back());
    CheckSameBoxes(*beta, alphas.tables.back());
    Blob partial = BackwardPartial(alphas, before, std::move(*beta), progress);
    if (inputs_.Has("guess")) partial.PutScalar<std::int32_t>("confirmed", 0);
    return partial;
  }

  // Both from a guess of alpha before the slice and of beta at its end, which come with them.
  Blob Guess(Progress& progress) const {
    const auto overlap = static_cast<int>(Overlap());
    const int start = std::max(0, slice_.first - overlap);
    LayeredGrid before = start == 0 ? AtTheStart() : Warm();
    if (start < slice_.first) {
      const Slice lead{steps_, start, slice_.first, slice_.robot};
      before = ForwardFor(model_, lead, std::move(before), kToTheEnd, progress).alpha;
    }
    const Alphas alphas = landmark_map::Forward(model_, slice_, before, progress);
    const LayeredGrid beta = GuessedBeta(alphas, overlap, progress);
    Blob guess;
    before.StoreSparse("before/", &guess);
    beta.StoreSparse("beta/", &guess);
    guess.PutAll("forward/", ForwardPartial(alphas.tables.back(), slice_.end));
    Blob partial = BackwardPartial(alphas, before, beta, progress);
    partial.PutScalar<std::int32_t>("confirmed", 1);
    guess.PutAll("backward/", partial);
    return guess;
  }

 private:
  const proto::Value& Param(const char* name) const { return task_.params().at(name); }
  std::int64_t Overlap() const { return IntegerOf(task_, "overlap", 0, kMostSteps); }

  LayeredGrid AtTheStart() const {
    if (!anywhere_) return DiracStart(model_.grid);
    if (!inputs_.Has("start")) return UniformStart(model_, slice_);
    const auto start = RowsIn<StartBox>(*inputs_.Get("start"));
    CheckStart(start, std::int64_t{robot_} + 1, model_.grid.headings);
    return UniformOver(Nearby(StartBoxes(model_, slice_), start, settings_.map));
  }

  // What a start within `before` adds to the log-likelihood. Where the frame lies is nobody's luck: what fits
  // as well in it as in the origin's is as likely. Of others all places count, those that the round before
  // has ruled out, too.
  double OfTheStart(const LayeredGrid& before) const {
    if (!anywhere_) return 0.0;
    double among = 0.0;
    for (const Box& box : StartBoxes(model_, slice_)) among += static_cast<double>(box.cells());
    return std::log(static_cast<double>(before.cells()) / (gauge_free_ ? 1.0 : among));
  }

  // alpha before the slice's first step.
  LayeredGrid Before() const {
    return inputs_.Has("before") ? HandedOver(inputs_, "before", "alpha/", settings_) : AtTheStart();
  }

  // The same from the round before, at the step where the overlap begins.
  LayeredGrid Warm() const {
    const auto slice = static_cast<std::size_t>(IntegerOf(task_, "slice", 0, kMostSteps));
    const Guesses guesses = Guesses::FromBlob(*inputs_.Get("guesses"));
    if (slice >= guesses.warm.size() || guesses.warm[slice].fields().empty())
      throw InputError("the input 'guesses' has no table for slice " + std::to_string(slice));
    LayeredGrid warm = LayeredGrid::LoadSparse("", guesses.warm[slice], settings_.MostCells());
    RequireSize("the headings of a guess", warm.layers.size(),
                static_cast<std::size_t>(model_.grid.headings));
    return warm;
  }

  // beta of the slice's last step, from what follows.
  LayeredGrid GuessedBeta(const Alphas& alphas, int overlap, Progress& progress) const {
    const LayeredGrid& alpha = alphas.tables.back();
    const int end = std::min(slice_.end + overlap, steps_.size());
    if (end == slice_.end || !options_.revise) return UniformBeta(alpha);
    EStepModel model = model_;
    model.memory_bytes -= sizeof(double) * static_cast<double>(alphas.Cells());
    const Slice trail{steps_, slice_.end, end, slice_.robot};
    const Alphas after = landmark_map::Forward(model, trail, alpha, progress);
    const Visitor nobody{[](int, const LayeredGrid&) {}, nullptr};
    return landmark_map::Backward(model, trail, after, alpha, UniformBeta(after.tables.back()), progress,
                                  nobody);
  }

  // The guess's answer, where there is one and the tables at its ends are the true ones.
  std::optional<Blob> WhatWasGuessed(const std::string& answer, const LayeredGrid& before,
                                     const LayeredGrid* beta) const {
    if (!inputs_.Has("guess")) return std::nullopt;
    const BlobPtr guess = inputs_.Get("guess");
    if (!guess->Has("before/box")) return std::nullopt;
    const auto agrees = [&](const char* prefix, const LayeredGrid& truth) {
      return Agree(HandedOver(inputs_, "guess", prefix, settings_), truth);
    };
    if (!agrees("before/", before) || (beta != nullptr && !agrees("beta/", *beta))) return std::nullopt;
    return guess->Sub(answer);
  }

  static Blob ForwardPartial(const LayeredGrid& alpha, int end) {
    Blob partial;
    alpha.StoreSparse("alpha/", &partial);
    partial.PutScalar<std::int32_t>("end", end);
    return partial;
  }

  Blob BackwardPartial(const Alphas& alphas, const LayeredGrid& before, LayeredGrid beta,
                       Progress& progress) const {
    std::vector<Landmark> landmarks;
    const bool summarise = Param("summarise").b();
    if (summarise) landmarks = LandmarksIn(*inputs_.Get("landmarks"), settings_.map);
    PartialBuilder builder(settings_, slice_, robot_, summarise ? &landmarks : nullptr,
                           NoCounts(settings_.map));
    if (options_.beliefs) builder.KeepBeliefs();
    if (anywhere_ && Param("joint").b()) builder.KeepStart();
    const Visitor visitor = CountingIn(&builder, sizeof(double) * static_cast<double>(alphas.Cells()));
    beta = options_.revise
               ? landmark_map::Backward(model_, slice_, alphas, before, std::move(beta), progress, visitor)
               : ForwardOnly(slice_, alphas, before, visitor);
    Blob partial = builder.Finish(alphas);
    if (slice_.first == 0)
      partial.PutScalar<double>("log_likelihood", alphas.log_likelihood + OfTheStart(before));
    if (slice_.first > 0) beta.StoreSparse("beta/", &partial);
    PutWarm(alphas, before, &partial);
    return partial;
  }

  // What a guess of the next slice in the next round begins from.
  void PutWarm(const Alphas& alphas, const LayeredGrid& before, Blob* partial) const {
    const std::int64_t overlap = Overlap(), at = slice_.end - slice_.first - overlap - 1;
    if (!Param("warm").b() || overlap == 0 || at < -1 || slice_.end == steps_.size()) return;
    (at < 0 ? before : alphas.tables[static_cast<std::size_t>(at)]).StoreSparse("warm/", partial);
  }

  static void CheckSameBoxes(const LayeredGrid& beta, const LayeredGrid& alpha) {
    for (std::size_t c = 0; c < beta.layers.size(); ++c) {
      if (beta.layers[c].box != alpha.layers[c].box)
        throw InputError("the input 'beta' does not lie where alpha does, in layer " + std::to_string(c));
    }
  }

  Visitor CountingIn(PartialBuilder* builder, double table_bytes) const {
    Visitor visitor;
    visitor.step = [this, builder, table_bytes](int step, const LayeredGrid& belief) {
      builder->Add(step, belief);
      const double counts = sizeof(double) * static_cast<double>(builder->counts().cells());
      RequireMemory("alphas and counts", table_bytes + counts, settings_.memory_mb);
    };
    if (options_.calibrate) {
      visitor.increment = [builder](int step, const HalfTurn& posterior) {
        builder->AddIncrement(step, posterior);
      };
    }
    return visitor;
  }

  static constexpr double kToTheEnd = std::numeric_limits<double>::infinity();

  const Options& options_;
  const Task& task_;
  const Inputs& inputs_;
  const OdometryFit odometry_;
  Settings settings_;
  const int robot_;
  const bool gauge_free_;  // the first robot, whose start is the frame's origin no more
  const bool anywhere_;
  const RobotSteps steps_;
  const Slice slice_;
  Perception perception_;
  EStepModel model_;
};

}  // namespace

Blob RunSlice(const Options& options, const Task& task, const Inputs& inputs, Progress& progress) {
  const auto [first, end] = SliceBounds(task, inputs);
  if (first == end) {  // an empty slice
    Blob partial;
    partial.PutScalar<std::int32_t>(task.kind() == "forward" ? "end" : "first", end);
    return partial;
  }
  const SliceTask slice(options, task, inputs, first, end);
  if (task.kind() == "forward") return slice.Forward(progress);
  if (task.kind() == "backward") return slice.Backward(progress);
  try {
    return slice.Guess(progress);
  } catch (const InputError&) {  // it began from a wrong guess; what is wrong with the input the others see
    return Blob();
  }
}

}  // namespace cairn::landmark_map
