#include "pipelines/forward_map/result.h"

#include <cmath>
#include <limits>

#include "pipelines/common/checked_readings.h"
#include "pipelines/common/handed_over.h"
#include "pipelines/forward_map/beams.h"
#include "pipelines/forward_map/weigh.h"
#include "schema/kinds/grid_map.h"

namespace cairn::forward_map {
namespace {

struct Cells {
  std::vector<std::uint8_t> occupied;
  std::vector<double> difference;
  std::vector<std::uint8_t> dynamic;
  std::vector<double> unchecked;  // the difference without the readings that the map is checked with
};

void TakeTile(const Blob& certainty, const Tile& tile, const GridBox& box, Cells* cells) {
  const auto difference = certainty.Get<double>("difference_nats");
  const auto of_checked = certainty.Get<double>("of_checked_nats");
  const auto came_and_went = certainty.Get<std::uint8_t>("came_and_went");
  const auto cells_of_tile = static_cast<std::size_t>(tile.rows) * static_cast<std::size_t>(tile.columns);
  RequireSize("difference_nats", difference.size(), cells_of_tile);
  RequireSize("of_checked_nats", of_checked.size(), cells_of_tile);
  RequireSize("came_and_went", came_and_went.size(), cells_of_tile);
  for (std::size_t own = 0; own < difference.size(); ++own) {
    const auto at = static_cast<std::int64_t>(own);
    const auto cell = static_cast<std::size_t>((tile.row + at / tile.columns) * box.columns + tile.column +
                                               at % tile.columns);
    cells->difference[cell] = difference[own];
    cells->unchecked[cell] = difference[own] - of_checked[own];
    // What was an obstacle while sigma was larger, and no reading tells of any more.
    if (std::isnan(difference[own])) cells->occupied[cell] = 0;
    if (came_and_went[own] != 0) cells->dynamic[cell] = kCameAndWent;
  }
}

// Of what the other readings say of each cell, all other cells as in the map.
CheckedReadings CheckOf(const Options& options, const PosedScans& scans, const MapState& map,
                        const Cells& cells) {
  constexpr double kSaysNothing = 0.01;
  std::vector<double> probability;
  for (const double difference : cells.unchecked)
    probability.push_back(std::abs(difference) >= kSaysNothing ? ProbabilityOf(difference, options.prior)
                                                               : std::numeric_limits<double>::quiet_NaN());
  CheckedReadings all;
  for (std::size_t k = 0; k < scans.sensors.size(); ++k) {
    const SensorModel& m = map.models[k];
    const ReadingModel model{m.p_hit, m.p_rand, m.p_lost, m.sigma_m, m.no_echo_m, m.z_max_m, options.no_echo};
    all.Add(Check(scans.sensors[k], map.box, probability, model));
  }
  return all;
}

// Marks where readings ended that are of nothing in the map, in cells that are known to be free: on rays the
// cell, in cones the arc, on which somebody was somewhere.
void MarkPassers(const RangeScans& scans, std::span<const std::int32_t> cause, const Options& options,
                 const SensorModel& model, const GridBox& box, Cells* cells) {
  const double beside_m = std::max(model.sigma_m, box.cell_m / 2);
  ForEachReading(scans, 0, scans.scans(), box, model, false, [&](const BeamOfScan& reading) {
    if (cause[reading.scan * scans.beams.size() + reading.beam] != kRandomCause) return;
    VisitBeam(
        box, reading.from, scans.opening_rad, reading.z_m + beside_m,
        [&](std::int64_t cell) {
          return cells->difference[static_cast<std::size_t>(cell)] < -options.dynamic_nats;
        },
        [&](std::int64_t cell, double distance_m) {
          if (std::abs(distance_m - reading.z_m) <= beside_m)
            cells->dynamic[static_cast<std::size_t>(cell)] = kPassed;
        });
  });
}

void PutMap(const Options& options, const MapState& map, const Cells& cells, Blob* result) {
  const GridBox& box = map.box;
  std::vector<double> probability;
  for (const double difference : cells.difference) {
    probability.push_back(std::isnan(difference) ? difference : ProbabilityOf(difference, options.prior));
  }
  const Shape shape = {box.rows, box.columns};
  kinds::GridMap::Grid grid{kinds::GridPlace::Of(box), {}, {}, {}, {}, {}};
  grid.probability = {shape, probability};
  grid.log_odds_difference = {shape, cells.difference};
  grid.occupied = {shape, cells.occupied};
  grid.dynamic = {shape, cells.dynamic};
  PutFields("map/grid/", grid, result);
}

}  // namespace

double ProbabilityOf(double difference_nats, double prior) {
  // [Thr01] section 3.4: differences translated into posterior probabilities
  return 1 / (1 + std::exp(-difference_nats) * (1 - prior) / prior);
}

Blob ResultOf(const Options& options, const PosedScans& scans, const Blob& log, const MapState& map,
              const std::vector<Tile>& tiles, const Blob& history, const Schedule& schedule,
              Partials& partials) {
  Cells cells{.occupied = map.occupied, .difference = {}, .dynamic = {}, .unchecked = {}};
  cells.difference.assign(map.occupied.size(), std::numeric_limits<double>::quiet_NaN());
  cells.unchecked = cells.difference;
  cells.dynamic.assign(map.occupied.size(), kStays);
  RequireSize("the sensors of the map", map.models.size(), scans.sensors.size());
  for (const Tile& tile : tiles) tile.Check(map.box);
  for (std::size_t i = 0; i < tiles.size(); ++i) TakeTile(*partials.Get(i), tiles[i], map.box, &cells);
  Blob result = history;
  result.PutScalar("search/searches", schedule.searches);
  result.PutScalar<std::uint8_t>("search/cut_short", schedule.cut_short ? 1 : 0);
  PutScanPoses(scans, log, &result);
  for (std::size_t k = 0; k < scans.sensors.size(); ++k) {
    const RangeScans& sensor = scans.sensors[k];
    const BlobPtr explained = partials.Get(tiles.size() + k);
    RequireSize("cause", explained->Get<std::int32_t>("cause").size(), sensor.scans() * sensor.beams.size());
    result.Put(sensor.name + "cause", explained->at("cause"));
    PutFields(sensor.name, map.models[k], &result);
    MarkPassers(sensor, explained->Get<std::int32_t>("cause"), options, map.models[k], map.box, &cells);
  }
  PutMap(options, map, cells, &result);
  PutCheck(CheckOf(options, scans, map, cells), &result);
  return result;
}

}  // namespace cairn::forward_map
