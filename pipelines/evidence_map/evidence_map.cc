#include "pipelines/evidence_map/evidence_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "pipelines/common/checked_readings.h"
#include "pipelines/common/handed_over.h"
#include "pipelines/common/state_scalars.h"
#include "pipelines/evidence_map/cone_counts.h"
#include "pipelines/evidence_map/log_odds.h"
#include "pipelines/evidence_map/parts.h"
#include "pipelines/evidence_map/ray_counts.h"
#include "schema/kinds/grid_map.h"

namespace cairn::evidence_map {
namespace {

enum class Phase : std::uint8_t { kRanges, kCounts };

// What the rounds go on from.
struct Standing {
  Phase phase = Phase::kRanges;
  std::int64_t sensors = 0, scans = 0, unposed = 0;
  double x0_m = 0, y0_m = 0, x1_m = 0, y1_m = 0;  // where the robots were, or box_m
  double sonar_m = -1;                            // its spread, as the log says; negative: it does not

  static void Fields(const auto& field) {
    field("phase", &Standing::phase);
    field("sensors", &Standing::sensors);
    field("scans", &Standing::scans);
    field("unposed", &Standing::unposed);
    field("x0_m", &Standing::x0_m);
    field("y0_m", &Standing::y0_m);
    field("x1_m", &Standing::x1_m);
    field("y1_m", &Standing::y1_m);
    field("sonar_m", &Standing::sonar_m);
  }
};

constexpr std::int64_t kMostSensors = 10'000, kMostScans = std::int64_t{1} << 40;
constexpr const char* kPartsBlob = "parts";

Standing StandingIn(const State& state) {
  const auto standing = ScalarsIn<Standing>(state);
  RequireWithin("sensors", standing.sensors, 1, kMostSensors);
  RequireWithin("scans", standing.scans, 0, kMostScans);
  RequireWithin("unposed", standing.unposed, 0, kMostScans);
  for (const double at : {standing.x0_m, standing.y0_m, standing.x1_m, standing.y1_m})
    RequireWithin("where the robots were", at, -kFar_m, kFar_m);
  RequireWithin("sonar_m", standing.sonar_m, -1.0, kFar_m);
  return standing;
}

// A task of the first round reads so many bytes of ranges, or a twelfth of them. Each of the second brings
// home a map, so there are no more of a sensor than some, but for logs so long that tasks would take long:
// from 10 ms to a quarter of a second of a core.
constexpr double kTasks = 12, kLeastBytes = 8 << 20, kMostBytes = 64 << 20;
constexpr double kLeastCells = 1 << 23, kMostCells = 1 << 28;
// Where maps of both kinds of sensors, of the scans that the map is checked with, and the result are at hand.
constexpr double kBytesPerCell = 72;

// In a task's partial, beside the counts of all other scans, those of the scans that the map is checked with,
// and the readings of them that it is.
constexpr const char* kCheckedCounts = "checked/";
constexpr const char* kReadings = "reading/";

// Microseconds of a core: a reading that is looked at; a cell that a task goes over, by rays and by cones;
// one of its map; one of it that is added up, and one of the result.
constexpr double kLookUs = 5e-3, kRayUs = 1e-3, kConeUs = 0.15, kMapUs = 0.025, kAddedUs = 0.01,
                 kResultUs = 0.1;

// About how many cells a reading tells of.
double CellsOf(double range_m, double opening_rad, double cell_m) {
  const double length = range_m / cell_m;
  return 1 + length * (1 + opening_rad / 2 * length);
}

double WorkOf(const RangeScans& scans, double cell_m) {
  double cells = 0;
  for (const double measured : scans.range_m.As<double>())
    cells += CellsOf(std::isnan(measured) ? scans.max_range_m : measured, scans.opening_rad, cell_m);
  return std::min(cells, kMostWork);
}

GridBox GridIn(const Inputs& inputs, const Options& options) {
  const auto grid = cairn::Read<GridBox>(*inputs.Get("grid"));
  RequireGrid(grid, MostCells(options.grid, kBytesPerCell));
  return grid;
}

// By which results name the log: what people submit has no truth and no provenance in it.
Hash SourceOf(const Inputs& inputs, const Blob& head) {
  const bool is_all = head.Sub("truth/").fields().empty() && head.Sub("provenance/").fields().empty();
  return is_all ? inputs.HashOf("log") : inputs.Get("log")->SourceHash();
}

Counts CountsOf(const Options& options, const RangeScans& scans, const GridBox& grid, Progress& progress) {
  return scans.opening_rad > 0
             ? CountCones(scans, grid, {options.wall_m, options.graded}, options.use_no_return, progress)
             : CountRays(scans, grid, options.use_no_return, progress);
}

// Adds up partials of counts: those of rays and those of cones.
class Sums {
 public:
  Sums(const Options& options, const GridBox& grid) : options_(options), grid_(grid) {}

  void Add(const Blob& partial, bool is_of_cones) {
    const auto cells = static_cast<std::size_t>(grid_.cells());
    Totals& sum = totals_[is_of_cones ? 1 : 0];
    if (sum.free.empty()) sum = {std::vector<std::int64_t>(cells), std::vector<std::int64_t>(cells)};
    AddTo(grid_, partial, &sum);
  }

  void Add(const Sums& more) {
    const auto add = [](std::vector<std::int64_t>* to, const std::vector<std::int64_t>& what) {
      if (to->empty()) to->resize(what.size());
      for (std::size_t k = 0; k < what.size(); ++k) (*to)[k] += what[k];
    };
    for (std::size_t kind = 0; kind < totals_.size(); ++kind) {
      add(&totals_[kind].free, more.totals_[kind].free);
      add(&totals_[kind].occupied, more.totals_[kind].occupied);
    }
  }

  std::vector<double> LogOdds() const {
    std::vector<Evidence> evidence;
    if (!totals_[0].free.empty()) evidence.push_back({totals_.data(), options_.laser, 1});
    if (!totals_[1].free.empty()) evidence.push_back({&totals_[1], options_.sonar, kWhole});
    return LogOddsOf(evidence, static_cast<std::size_t>(grid_.cells()), options_.prior, options_.clamp_nats);
  }

 private:
  const Options& options_;
  const GridBox& grid_;
  std::array<Totals, 2> totals_;  // of rays, of cones
};

// What readings of the sensor are like: [Thr01]'s figures, as forward_map begins with them.
ReadingModel ModelOf(const Options& options, const RangeScans& sensor, double sonar_m) {
  ReadingModel model;
  const bool stated = sensor.opening_rad > 0 && sonar_m >= 0;
  model.sigma_m = std::max(stated ? sonar_m : model.sigma_m, options.grid.cell_m / 2);
  model.no_echo_m = model.sigma_m;
  model.z_max_m = sensor.max_range_m;
  model.no_echo = options.use_no_return;
  return model;
}

// Readings that the map is checked with, by sensor.
class Checked {
 public:
  explicit Checked(std::int64_t sensors) : taken_(static_cast<std::size_t>(sensors)) {}

  void Add(const Blob& partial) {
    const std::int64_t sensor = partial.Scalar<std::int64_t>("sensor");
    RequireWithin("a partial's sensor", sensor, 0, static_cast<std::int64_t>(taken_.size()) - 1);
    const auto from = RowsIn<Pose>(partial, kReadings);
    const auto range_m = partial.Get<double>(std::string(kReadings) + kRanges);
    RequirePoses("a reading's beam", from);
    RequireSize(kRanges, range_m.size(), from.size());
    std::vector<TakenReading>& of = taken_[static_cast<std::size_t>(sensor)];
    RequireWithin("readings", static_cast<std::int64_t>(of.size() + from.size()), 0,
                  static_cast<std::int64_t>(kMostChecked));
    for (std::size_t k = 0; k < from.size(); ++k) {
      if (!std::isnan(range_m[k])) RequireWithin(kRanges, range_m[k], 0.0, kFar_m);
      of.push_back({from[k], range_m[k]});
    }
  }

  // Of a map without the scans that it is checked with.
  CheckedReadings Sum(const Options& options, double sonar_m, const Inputs& inputs, const GridBox& grid,
                      std::vector<double> log_odds) const {
    for (double& l : log_odds) l = std::isnan(l) ? l : Probability(l);
    CheckedReadings all;
    for (std::size_t k = 0; k < taken_.size(); ++k) {
      const RangeScans sensor = SensorIn(*inputs.Get(SensorName(static_cast<std::int64_t>(k))));
      all.Add(Check(taken_[k], sensor.opening_rad, grid, log_odds, ModelOf(options, sensor, sonar_m)));
    }
    return all;
  }

 private:
  std::vector<std::vector<TakenReading>> taken_;
};

Blob ResultOf(const GridBox& grid, const std::vector<double>& log_odds) {
  std::vector<double> probability;
  std::vector<float> stored;
  probability.reserve(log_odds.size());
  stored.reserve(log_odds.size());
  for (const double l : log_odds) {
    probability.push_back(std::isnan(l) ? l : Probability(l));
    stored.push_back(static_cast<float>(l));
  }
  const Shape shape{grid.rows, grid.columns};
  kinds::GridMap map;
  map.grid = {kinds::GridPlace::Of(grid), {shape, probability}, {}, {shape, stored}, {}, {}};
  return BlobOf(map);
}

std::string NoteOf(const Standing& standing, const GridBox* grid) {
  std::string note = std::to_string(standing.scans) + " scans";
  if (grid != nullptr)
    note += ", " + std::to_string(grid->columns) + " by " + std::to_string(grid->rows) + " cells";
  if (standing.unposed > 0)
    note += "; " + std::to_string(standing.unposed) + " scans without a pose left out";
  return note;
}

// [Thr01] eq. 1 adds log p(m|z) / (1 - p(m|z)) - log p(m) / (1 - p(m)): what tells of an obstacle must be
// more than is expected anyway, and what tells of none less.
void CheckPrior(const Options& options, const std::vector<RangeScans>& sensors) {
  for (const RangeScans& sensor : sensors) {
    const bool is_sonar = sensor.opening_rad > 0;
    const InverseModel& model = is_sonar ? options.sonar : options.laser;
    if (model.p_free < options.prior && options.prior < model.p_occupied) continue;
    throw InputError(
        fmt::format("option 'prior': {0:g} does not lie between {1}_p_free = {2:g} and {1}_p_occupied = "
                    "{3:g}: readings of "
                    "obstacles would speak against them, or free ones for them",
                    options.prior, is_sonar ? "sonar" : "laser", model.p_free, model.p_occupied));
  }
}

// Before the ranges are known: of a sensor whose readings are a third of its reach long.
void ExpectCounts(const Options& options, const PosedScans& scans, proto::Step* plan) {
  double cost = 0;
  for (const RangeScans& sensor : scans.sensors)
    cost += static_cast<double>(sensor.scans() * sensor.beams.size()) *
            CellsOf(sensor.max_range_m / 3, sensor.opening_rad, options.grid.cell_m) *
            (sensor.opening_rad > 0 ? kConeUs : kRayUs);
  ExpectRounds(1, cost, 0, plan);
}

void PlanLook(const std::vector<RangeScans>& sensors, const std::vector<Part>& parts, const std::string& log,
              proto::Step* plan) {
  std::vector<double> bytes;
  for (const Part& part : parts)
    bytes.push_back(static_cast<double>(part.rows) * sizeof(double) *
                    static_cast<double>(sensors[static_cast<std::size_t>(part.sensor)].beams.size()));
  for (const Group& sensor : OfSensors(parts, bytes)) {
    const std::string ranges = sensors[static_cast<std::size_t>(parts[sensor.first].sensor)].name + kRanges;
    const double of_a_task = std::clamp(sensor.weight / kTasks, kLeastBytes, kMostBytes);
    for (const Group& group : GroupParts(bytes, of_a_task, sensor))
      AddTask("look", group.weight / sizeof(double) * kLookUs, group, parts, log, ranges, plan);
  }
}

Blob Look(const Options& options, const std::vector<RangeScans>& parts, Progress& progress) {
  std::vector<PartFacts> facts;
  for (const RangeScans& part : parts) {
    progress.Tick();
    const Extent ends = EndsOf(part);
    facts.push_back({ends.x0_m(), ends.y0_m(), ends.x1_m(), ends.y1_m(), WorkOf(part, options.grid.cell_m),
                     CountReadings(part, ModelOf(options, part, -1))});
  }
  return BlobOfFacts(facts);
}

Blob Count(const Options& options, const Task& task, RangeScans scans, const GridBox& grid,
           Progress& progress) {
  constexpr std::int64_t kMost = std::int64_t{1} << 50;
  const std::int64_t all = IntegerOf(task, "readings", 0, kMost);
  const auto taken =
      TakeReadings(scans, ModelOf(options, scans, -1), IntegerOf(task, "readings_before", 0, kMost), all);
  const RangeScans checked = CheckedOnly(scans);
  const std::uint8_t is_of_cones = scans.opening_rad > 0 ? 1 : 0;
  Blob partial = ToBlob(CountsOf(options, WithoutChecked(std::move(scans)), grid, progress));
  partial.PutScalar("sensor", IntegerOf(task, "sensor", 0, kMostSensors));
  partial.PutScalar("cone", is_of_cones);
  PutRows(kReadings, ColumnOf(taken, &TakenReading::from), &partial);
  partial.PutVector(std::string(kReadings) + kRanges, ColumnOf(taken, &TakenReading::range_m));
  if (std::ranges::find(checked.held_out, 0) != checked.held_out.end())
    partial.PutAll(kCheckedCounts, ToBlob(CountsOf(options, checked, grid, progress)));
  return partial;
}

// What the first round found out, and behind which parts each of its tasks ended.
struct Facts {
  std::vector<PartFacts> of_part;
  std::set<std::size_t> ends;
};

Facts FactsOf(Partials& partials, std::size_t parts) {
  Facts facts;
  for (std::size_t k = 0; k < partials.size(); ++k) {
    const BlobPtr partial = partials.Get(k);
    const std::vector<PartFacts> some = FactsIn(*partial, partial->at("work").size());
    facts.of_part.insert(facts.of_part.end(), some.begin(), some.end());
    facts.ends.insert(facts.of_part.size());
  }
  RequireSize("what is said of parts", facts.of_part.size(), parts);
  return facts;
}

// Time slices of about equal work, each within what a task has looked at: who did that has these ranges, and
// need not fetch them again.
void PlanCounts(const std::vector<Part>& parts, const Facts& facts, const GridBox& grid, const Inputs& inputs,
                proto::Step* plan) {
  const std::string log = inputs.HashOf("log").Binary();
  const std::vector<double> work = ColumnOf(facts.of_part, &PartFacts::work);
  for (const Group& of_sensor : OfSensors(parts, work)) {
    const RangeScans sensor = SensorIn(*inputs.Get(SensorName(parts[of_sensor.first].sensor)));
    std::int64_t all = 0, before = 0;
    for (std::size_t k = of_sensor.first; k < of_sensor.end; ++k) all += facts.of_part[k].readings;
    const double of_a_task = std::clamp(of_sensor.weight / kTasks, kLeastCells, kMostCells);
    for (const Group& group : GroupParts(work, of_a_task, of_sensor, facts.ends)) {
      const double cost = (sensor.opening_rad > 0 ? kConeUs : kRayUs) * group.weight +
                          kMapUs * static_cast<double>(grid.cells());
      AddTask("counts", cost, group, parts, log, sensor.name + kRanges, plan)
          .Set("readings", all)
          .Set("readings_before", before)
          .Read("grid");
      for (std::size_t k = group.first; k < group.end; ++k) before += facts.of_part[k].readings;
    }
  }
}

Step BeginCounts(const Options& options, const State& state, Partials& partials, const Inputs& inputs) {
  Standing standing = StandingIn(state);
  const std::vector<Part> parts = PartsIn(*inputs.Get(kPartsBlob), standing.sensors);
  const Facts facts = FactsOf(partials, parts.size());
  Extent frame, ends;
  frame.Add(standing.x0_m, standing.y0_m);
  frame.Add(standing.x1_m, standing.y1_m);
  for (const PartFacts& of : facts.of_part) {
    if (of.x1_m < of.x0_m) continue;
    ends.Add(of.x0_m, of.y0_m);
    ends.Add(of.x1_m, of.y1_m);
  }
  const GridBox grid = GridOf(frame, ends, options.grid, kBytesPerCell);
  Step step;
  Blob box;
  PutFields("", grid, &box);
  *step.plan.mutable_state() = state;
  step.plan.mutable_state()->mutable_blobs()->erase(kPartsBlob);
  (*step.plan.mutable_state()->mutable_blobs())["grid"] = step.Share(std::move(box));
  standing.phase = Phase::kCounts;
  PutScalars(standing, "", step.plan.mutable_state());
  PlanCounts(parts, facts, grid, inputs, &step.plan);
  step.plan.set_advance_cost(static_cast<double>(grid.cells()) *
                             (kAddedUs * step.plan.tasks_size() + kResultUs));
  step.plan.set_note(NoteOf(standing, &grid));
  return step;
}

}  // namespace

Step EvidenceMap::Start(const Inputs& inputs) const {
  const BlobPtr head = inputs.GetHead("log", kRanges);
  const BlobPtr poses_input = inputs.Has("poses") ? inputs.Get("poses") : nullptr;
  const Hash source = SourceOf(inputs, *head);
  const PosedScans scans = ReadScanHeads(*head, source, poses_input.get(), options_.grid);
  CheckPrior(options_, scans.sensors);
  const Extent frame = FrameOf(scans, options_.grid);
  GridOf(frame, {}, options_.grid, kBytesPerCell);  // the grid is no smaller: too large a one shows at once
  Step step;
  Standing standing{.sensors = static_cast<std::int64_t>(scans.sensors.size()),
                    .unposed = static_cast<std::int64_t>(scans.unposed),
                    .x0_m = frame.x0_m(),
                    .y0_m = frame.y0_m(),
                    .x1_m = frame.x1_m(),
                    .y1_m = frame.y1_m()};
  for (const RangeScans& sensor : scans.sensors) standing.scans += static_cast<std::int64_t>(sensor.scans());
  if (head->Has("noise/sonar_m")) standing.sonar_m = head->Scalar<double>("noise/sonar_m");
  PutScalars(standing, "", step.plan.mutable_state());
  const std::vector<Part> parts = CutParts(scans.sensors, &step);
  Blob poses;
  PutScanPoses(scans, *head, source, &poses);
  auto& blobs = *step.plan.mutable_state()->mutable_blobs();
  blobs[kPartsBlob] = step.Share(BlobOfParts(parts));
  blobs["scan poses"] = step.Share(std::move(poses));
  PlanLook(scans.sensors, parts, inputs.HashOf("log").Binary(), &step.plan);
  ExpectCounts(options_, scans, &step.plan);
  step.plan.set_note(NoteOf(standing, nullptr));
  return step;
}

Blob EvidenceMap::Run(const Task& task, const Inputs& inputs, Progress& progress) const {
  RequireKind(task, {"look", "counts"});
  std::vector<RangeScans> parts = ScansOfTask(task, inputs);
  if (task.kind() == "look") return Look(options_, parts, progress);
  return Count(options_, task, Joined(std::move(parts)), GridIn(inputs, options_), progress);
}

Step EvidenceMap::Advance(const State& state, Partials& partials, const Inputs& inputs) const {
  const Standing standing = StandingIn(state);
  if (standing.phase == Phase::kRanges) return BeginCounts(options_, state, partials, inputs);
  const GridBox grid = GridIn(inputs, options_);
  Sums sums(options_, grid);
  auto of_checked = std::make_unique<Sums>(options_, grid);
  Checked readings(standing.sensors);
  for (std::size_t k = 0; k < partials.size(); ++k) {
    const BlobPtr partial = partials.Get(k);
    const bool is_of_cones = partial->Scalar<std::uint8_t>("cone") != 0;
    sums.Add(*partial, is_of_cones);
    readings.Add(*partial);
    const Blob checked = partial->Sub(kCheckedCounts);
    if (!checked.fields().empty()) of_checked->Add(checked, is_of_cones);
  }
  const CheckedReadings check = readings.Sum(options_, standing.sonar_m, inputs, grid, sums.LogOdds());
  sums.Add(*of_checked);
  of_checked.reset();
  Blob result = ResultOf(grid, sums.LogOdds());
  result.PutAll("", *inputs.Get("scan poses"));
  PutCheck(check, &result);
  Step step;
  step.plan.set_result(step.Share(std::move(result)));
  return step;
}

}  // namespace cairn::evidence_map
