#include "pipelines/forward_map/advance.h"

#include <fmt/format.h>

#include <cmath>

#include "pipelines/common/handed_over.h"
#include "pipelines/forward_map/history.h"
#include "pipelines/forward_map/plan.h"
#include "pipelines/forward_map/tile_task.h"
#include "schema/error.h"
#include "schema/kinds/map_so_far.h"

namespace cairn::forward_map {
namespace {

constexpr std::int64_t kFirstSteps = 3, kMostSteps = 10;  // of the parameters
// Nats a reading: parameters whose step gains less have settled, those that gain less together change no map,
// and a search that gains less is as good as one that finds nothing.
constexpr double kSettledStep = 1e-3, kSettledPhase = 5e-3, kSettledSearch = 1e-5;
constexpr double kRounding = 1e-9;  // of the target, between the search and the weighing

// Below this the cells' own size is all that ranges tell of.
double LeastSigma(const GridBox& box) { return box.cell_m / 2; }

class Turn {
 public:
  Turn(const Options& options, const State& state, Partials& partials, const Inputs& inputs)
      : options_(options),
        partials_(partials),
        inputs_(inputs),
        schedule_(ScalarsIn<Schedule>(state)),
        map_(MapIn(options.grid, inputs)) {
    *step_.plan.mutable_state() = state;
  }

  Step Take() && {
    switch (schedule_.phase) {
      case Phase::kBegin:
        Begin();
        break;
      case Phase::kSearch:
        WeighProposals();
        break;
      case Phase::kWeigh:
        AcceptOrHalve();
        break;
      case Phase::kParameters:
        KeepParametersOrNot();
        break;
      case Phase::kCertainty:
        CAIRN_DEMAND(false, "the result follows");
    }
    PutScalars(schedule_, "", step_.plan.mutable_state());
    PlanTasks(&step_.plan);
    step_.plan.set_note(Note());
    ExpectRest(options_.rounds, options_.estimate, &step_.plan);
    return std::move(step_);
  }

 private:
  void Begin() {
    const std::vector<Evidence> evidence = Weighed();
    Keep(evidence, TargetOf(evidence, map_));
    NextSearch();
  }

  void WeighProposals() {
    std::vector<Proposal> proposals;
    for (std::size_t i = 0; i < partials_.size(); ++i) {
      std::vector<Proposal> of_tile = ProposalsOf(*partials_.Get(i));
      RequireSize("the proposals of a tile", of_tile.size(), 1);
      if (!of_tile.front().cells.empty()) proposals.push_back(std::move(of_tile.front()));
    }
    if (proposals.empty()) return NothingFound();
    Share(kProposalsBlob, ToBlob(proposals));
    schedule_.phase = Phase::kWeigh;
    schedule_.taken = static_cast<std::int64_t>(proposals.size());
  }

  // Proposals of tiles side by side may explain the same readings; together they must gain.
  void AcceptOrHalve() {
    const std::vector<Evidence> evidence = Weighed();
    const std::vector<Proposal> proposals = ProposalsOf(*inputs_.Get(kProposalsBlob));
    MapState candidate = map_;
    Apply(proposals, static_cast<std::size_t>(schedule_.taken), &candidate.occupied);
    const double target = TargetOf(evidence, candidate), gain = target - schedule_.target_nats;
    if (schedule_.taken == 1 && schedule_.searches > 1) {
      CAIRN_DEMAND(std::abs(gain - proposals[0].gain) <= kRounding * (1 + std::abs(target)),
                   "what a tile's search gains is what weighing finds");
    }
    if (gain <= 0) {
      schedule_.taken /= 2;
      if (schedule_.taken == 0) NothingFound();
      return;
    }
    map_ = std::move(candidate);
    Share(kMapBlob, cairn::BlobOf(map_));
    Keep(evidence, target);
    // The only tile has searched until nothing gained.
    const bool ended = !SeveralTiles() || gain < kSettledSearch * SumOf(evidence).readings;
    if (schedule_.searches > 1 && ended) return NothingFound();
    schedule_.taken = 0;
    schedule_.quiet = 0;
    if (options_.estimate && schedule_.searches == 1) return ImproveParameters();
    NextSearch();
  }

  // Or next to nothing.
  void NothingFound() {
    schedule_.taken = 0;
    ++schedule_.quiet;
    if (SeveralTiles() && schedule_.quiet < kSplits) return NextSearch();
    const bool parameters_open = options_.estimate && !schedule_.settled;
    if (parameters_open && MaySearch()) return ImproveParameters();
    schedule_.cut_short = parameters_open;
    schedule_.phase = Phase::kCertainty;
  }

  bool MaySearch() const { return schedule_.searches < options_.rounds; }

  void NextSearch() {
    if (!MaySearch()) {
      schedule_.cut_short = true;
      schedule_.phase = Phase::kCertainty;
      return;
    }
    schedule_.phase = Phase::kSearch;
    schedule_.split = schedule_.searches % kSplits;
    ++schedule_.searches;
    schedule_.steps = 0;
  }

  void ImproveParameters() {
    const std::vector<Evidence> evidence = RowsIn<Evidence>(*BlobOf(kEvidenceBlob));
    RequireSize("the sensors' evidence", evidence.size(), map_.models.size());
    if (schedule_.steps == 0) schedule_.begun_nats = schedule_.target_nats;
    Share(kBeforeBlob, cairn::BlobOf(map_));
    for (std::size_t k = 0; k < map_.models.size(); ++k)
      map_.models[k] = Improved(map_.models[k], evidence[k], LeastSigma(map_.box));
    Share(kMapBlob, cairn::BlobOf(map_));
    schedule_.phase = Phase::kParameters;
    ++schedule_.steps;
  }

  // EM cannot lose, but for its bounds and for where the Gaussians end; then the step is taken back.
  void KeepParametersOrNot() {
    const std::vector<Evidence> evidence = Weighed();
    const double target = TargetOf(evidence, map_), gain = target - schedule_.target_nats;
    const double readings = SumOf(evidence).readings;
    if (gain <= 0) {
      const std::size_t cells = map_.occupied.size(), sensors = map_.models.size();
      map_ = MapIn(options_.grid, inputs_, kBeforeBlob);
      RequireSize("the cells of the map before", map_.occupied.size(), cells);
      RequireSize("the sensors of the map before", map_.models.size(), sensors);
      Share(kMapBlob, cairn::BlobOf(map_));
    } else {
      Keep(evidence, target);
    }
    const std::int64_t most = schedule_.searches == 1 ? kFirstSteps : kMostSteps;
    if (gain > kSettledStep * readings && schedule_.steps < most) return ImproveParameters();
    const bool changed = schedule_.target_nats - schedule_.begun_nats > kSettledPhase * readings;
    schedule_.settled = schedule_.searches > 1 && !changed;
    schedule_.quiet = 0;
    NextSearch();
  }

  bool SeveralTiles() const { return step_.plan.state().scalars().at(TilesKey(0)).i() > 1; }

  std::vector<Evidence> Weighed() {
    std::vector<Evidence> evidence(map_.models.size());
    for (std::size_t i = 0; i < partials_.size(); ++i) {
      const BlobPtr partial = partials_.Get(i);
      const auto sensor = partial->Scalar<std::int64_t>("sensor");
      RequireWithin("sensor", sensor, 0, static_cast<std::int64_t>(evidence.size()) - 1);
      evidence[static_cast<std::size_t>(sensor)].Add(Read<Evidence>(*partial));
    }
    return evidence;
  }

  double TargetOf(const std::vector<Evidence>& evidence, const MapState& map) const {
    return SumOf(evidence).log_likelihood + map.LogPrior(PriorOf(options_));
  }

  // The evidence of the map that the search now holds.
  void Keep(const std::vector<Evidence>& evidence, double target) {
    schedule_.target_nats = target;
    Share(kEvidenceBlob, cairn::BlobOf(evidence));
    const BlobPtr history = inputs_.Has(kHistoryBlob) ? inputs_.Get(kHistoryBlob) : nullptr;
    Share(kHistoryBlob, WithRow(history.get(), SumOf(evidence), target, map_));
    step_.plan.mutable_state()->set_so_far(step_.Share(SoFar()));
  }

  // For people to look at while the stage runs.
  Blob SoFar() const {
    kinds::MapSoFar map;
    map.history = FieldsIn<kinds::MapSoFar::History>("history/", *BlobOf(kHistoryBlob));
    map.what = fmt::format("map {}, of search {}", map.history.log_likelihood.size(), schedule_.searches);
    map.map.grid.occupied = {Shape{map_.box.rows, map_.box.columns}, map_.occupied};
    static_cast<kinds::GridPlace&>(map.map.grid) = kinds::GridPlace::Of(map_.box);
    return cairn::BlobOf(map);
  }

  void Share(const char* name, Blob blob) {
    (*step_.plan.mutable_state()->mutable_blobs())[name] = step_.Share(std::move(blob));
  }

  // As this turn shared it, else as it was.
  BlobPtr BlobOf(const char* name) const {
    const std::string& hash = step_.plan.state().blobs().at(name);
    for (const BlobPtr& blob : step_.blobs)
      if (blob->ContentHash().Binary() == hash) return blob;
    return inputs_.Get(name);
  }

  const char* What() const {
    switch (schedule_.phase) {
      case Phase::kBegin:
        break;
      case Phase::kSearch:
        return "searching";
      case Phase::kWeigh:
        return "weighing";
      case Phase::kParameters:
        return "the sensors' parameters";
      case Phase::kCertainty:
        return schedule_.cut_short ? "cut short by 'rounds'; how sure the map is" : "how sure the map is";
    }
    return "";
  }

  std::string Note() const {
    // That of the empty map is so low that beside it the others' curve is flat.
    if (map_.CountOccupied() == 0)
      return fmt::format("search {}, an empty map; {}", schedule_.searches, What());
    return fmt::format("search {}, log-likelihood {:.1f}, {:.0f} obstacles; {}", schedule_.searches,
                       schedule_.target_nats, map_.CountOccupied(), What());
  }

  const Options& options_;
  Partials& partials_;
  const Inputs& inputs_;
  Schedule schedule_;
  MapState map_;
  Step step_;
};

}  // namespace

Step AdvanceSearch(const Options& options, const State& state, Partials& partials, const Inputs& inputs) {
  return Turn(options, state, partials, inputs).Take();
}

}  // namespace cairn::forward_map
