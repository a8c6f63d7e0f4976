#include "pipelines/landmark_map/incremental.h"

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pipelines/common/handed_over.h"
#include "pipelines/landmark_map/estimate.h"
#include "pipelines/landmark_map/model/e_step.h"
#include "pipelines/landmark_map/model/m_step.h"
#include "pipelines/landmark_map/result.h"
#include "pipelines/landmark_map/round.h"
#include "pipelines/landmark_map/state/partial.h"

namespace cairn::landmark_map {
namespace {

// The map as it grows.
class GrowingMap {
 public:
  explicit GrowingMap(const Settings& settings) : settings_(settings), counts_(NoCounts(settings.map)) {}

  // What the next observations are looked up in; nullptr before the first ones.
  const Perception* perception() const { return seen_ ? &perception_ : nullptr; }
  const LayeredGrid& counts() const { return counts_; }

  // [TBF98] eqs 19 to 21 of what was seen so far, each weighed by what was believed when it was seen.
  void Take(const RobotSteps& steps, int step, const LayeredGrid& belief) {
    if (steps.first_observation[step] == steps.first_observation[step + 1]) return;
    for (int k = steps.first_observation[step]; k < steps.first_observation[step + 1]; ++k)
      Count(steps.observations[k], settings_.map.grid, belief, &counts_);
    RequireMemory("the map", MStepBytes(counts_, settings_.map), settings_.memory_mb);
    perception_ = MakePerception(MapFromCounts(counts_, settings_.map), settings_.map);
    seen_ = true;
  }

 private:
  const Settings& settings_;
  LayeredGrid counts_;
  Perception perception_;
  bool seen_ = false;
};

// [TBF98] eqs 15 and 16, each step in the map of those before it.
Alphas Pass(const Settings& settings, const Slice& slice, GrowingMap* map, Progress& progress) {
  Alphas alphas;
  std::int64_t held = 0;  // cells of the tables that are kept
  const LayeredGrid start = DiracStart(settings.map.grid);
  for (int step = slice.first; step < slice.end; ++step) {
    EStepModel model = settings.Model(map->perception());
    model.memory_bytes -= sizeof(double) * static_cast<double>(held);
    Alphas one = Forward(model, {slice.steps, step, step + 1, slice.robot},
                         alphas.tables.empty() ? start : alphas.tables.back(), progress);
    alphas.log_likelihood += one.log_likelihood;
    alphas.work += one.work;
    held += one.tables.back().cells();
    alphas.tables.push_back(std::move(one.tables.back()));
    map->Take(slice.steps, step, alphas.tables.back());
  }
  return alphas;
}

// The stage's inputs, but for what the pass has found.
class Found : public Inputs {
 public:
  Found(const Inputs& inputs, Blob landmarks, Blob counts)
      : inputs_(inputs),
        landmarks_(std::make_shared<const Blob>(std::move(landmarks))),
        counts_(std::make_shared<const Blob>(std::move(counts))) {}
  bool Has(const std::string& name) const override { return inputs_.Has(name); }
  BlobPtr Get(const std::string& name) const override {
    return name == "landmarks" ? landmarks_ : name == "counts" ? counts_ : inputs_.Get(name);
  }

 private:
  const Inputs& inputs_;
  BlobPtr landmarks_, counts_;
};

}  // namespace

Blob RunIncremental(const Options& options, const Task& task, const Inputs& inputs, Progress& progress) {
  const Settings settings = Settings::In(*inputs.Get("settings"), options);
  const RobotSteps steps =
      RobotSteps::In(*inputs.Get("steps"), settings.map.layers(), settings.map.grid.cell_m);
  const Slice slice{steps, 0, steps.size(), task.params().at("name").s()};
  GrowingMap map(settings);
  // [TBF98] section 6: a routine that does not revise past estimates
  const Alphas alphas = Pass(settings, slice, &map, progress);
  const std::vector<Landmark> landmarks = ExtractLandmarks(map.counts(), settings.map);
  PartialBuilder builder(settings, slice, 0, &landmarks, NoCounts(settings.map));
  if (options.beliefs) builder.KeepBeliefs();
  const Visitor visitor{[&](int step, const LayeredGrid& belief) { builder.Add(step, belief); }, nullptr};
  ForwardOnly(slice, alphas, DiracStart(settings.map.grid), visitor);
  Blob partial = builder.Finish(alphas);
  partial.PutAll("landmarks/", BlobOf(landmarks));
  return partial;
}

cairn::Step IncrementalResult(const Options& options, const State& state, Partials& partials,
                              const Inputs& inputs) {
  const Settings settings = Settings::In(*inputs.Get("settings"), options);
  RequireSize("the tasks of one pass", partials.size(), 1);
  const BlobPtr partial = partials.Get(0);
  RoundSum sum(settings, 1);
  sum.Add(*partial);
  const Found found(inputs, partial->Sub("landmarks/"), StoredCounts(sum.counts()));
  const std::vector<OdometryFit> odometry = RobotStates::Load(state, 1).odometry;
  const BlobPtr log = inputs.Get("log");
  return MakeResult(*log, settings, found, sum, odometry,
                    Extended(*inputs.Get("history"), Schedule::Load(state, 1), sum, {}),
                    RefineMapOf(*log, settings, found, sum, odometry,
                                "not tried: the incremental baseline revises nothing", false, {}));
}

void CheckIncremental(const Options& options, const Inputs& inputs) {
  if (!options.incremental) return;
  if (inputs.Has("map")) throw InputError("incremental makes a map of its own: leave the input 'map' out");
  if (options.model == "exact")
    throw InputError("incremental meets landmarks that its map does not have, which model exact rules out");
  if (inputs.Get("log")->Texts("robots").size() > 1)
    throw InputError("incremental is one robot's pass; this log has several");
}

Options OnePass(Options options) {
  if (!options.incremental) return options;
  options.iterations = 0;
  options.starts = 1;
  options.calibrate = options.refine = options.speculate = false;
  return options;
}

}  // namespace cairn::landmark_map
