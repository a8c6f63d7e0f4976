#include "pipelines/forward_map/tile_task.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipelines/common/checked_readings.h"
#include "pipelines/forward_map/beams.h"
#include "pipelines/forward_map/dynamic.h"

namespace cairn::forward_map {
namespace {

constexpr std::size_t kReadingsOfTick = 256;
constexpr std::int32_t kFreeElsewhere = -2;

// Whether a beam may meet the tile: by the ray, or by the triangle around the cone.
bool MayMeet(const GridBox& tile, const Pose& from, double opening_rad, double reach_m) {
  const double length_m = reach_m + 2 * tile.cell_m;
  if (opening_rad <= 0) {
    const RayPart part = ClipRay(tile, from, length_m);
    return part.first_m < part.last_m;
  }
  Extent extent;
  extent.Add(from.x_m, from.y_m);
  for (const double side : {-0.5, 0.5}) {
    const double heading = from.heading_rad + side * opening_rad,
                 edge_m = length_m / std::cos(opening_rad / 2);
    extent.Add(from.x_m + edge_m * std::cos(heading), from.y_m + edge_m * std::sin(heading));
  }
  extent.Grow(tile.cell_m);
  const double x1 = tile.origin_x_m + static_cast<double>(tile.columns) * tile.cell_m;
  const double y1 = tile.origin_y_m + static_cast<double>(tile.rows) * tile.cell_m;
  return extent.x0_m() <= x1 && extent.x1_m() >= tile.origin_x_m && extent.y0_m() <= y1 &&
         extent.y1_m() >= tile.origin_y_m;
}

Patch PatchOf(const MapState& map, const Tile& tile) {
  Patch patch = Patch::Empty(tile.columns, tile.rows);
  std::size_t at = 0;
  for (std::int64_t row = tile.row - 1; row <= tile.row + tile.rows; ++row) {
    for (std::int64_t column = tile.column - 1; column <= tile.column + tile.columns; ++column, ++at) {
      if (map.box.Holds(column, row))
        patch.rimmed[at] = map.occupied[static_cast<std::size_t>(row * map.box.columns + column)];
    }
  }
  return patch;
}

// The cells of one beam after the other, as FlipGains takes them.
class BeamsOfTile {
 public:
  BeamsOfTile(const MapState& map, const Tile& tile)
      : map_(map),
        // With a cell around it: the first test must not lose a beam to rounding.
        around_{map.box.origin_x_m + (tile.column - 1) * map.box.cell_m,
                map.box.origin_y_m + (tile.row - 1) * map.box.cell_m, map.box.cell_m, tile.columns + 2,
                tile.rows + 2} {
    for (const std::uint8_t occupied : map.occupied)
      own_.push_back(occupied != 0 ? kElsewhere : kFreeElsewhere);
    for (std::int32_t own = 0; own < tile.columns * tile.rows; ++own) {
      const std::int64_t row = tile.row + own / tile.columns, column = tile.column + own % tile.columns;
      own_[static_cast<std::size_t>(row * map.box.columns + column)] = own;
    }
  }

  // The beam's cells of the tile, and obstacles elsewhere; empty where it meets none of the tile's.
  const std::vector<Crossing>& Of(const Pose& from, double opening_rad, double reach_m) {
    beam_.clear();
    if (!MayMeet(around_, from, opening_rad, reach_m)) return beam_;
    bool meets = false;
    VisitBeam(
        map_.box, from, opening_rad, reach_m,
        [&](std::int64_t cell) { return own_[static_cast<std::size_t>(cell)] != kFreeElsewhere; },
        [&](std::int64_t cell, double distance_m) {
          const std::int32_t own = own_[static_cast<std::size_t>(cell)];
          beam_.push_back({own, distance_m});
          meets = meets || own != kElsewhere;
        });
    if (!meets) beam_.clear();
    return beam_;
  }

  // Has an obstacle elsewhere explain `z_m`, if nothing of the tile can and nothing in the map does.
  void ExplainElsewhere(double z_m, double window_m) {
    for (const Crossing& crossing : beam_)
      if (std::abs(crossing.distance_m - z_m) <= window_m) return;
    beam_.push_back({kElsewhere, z_m});
  }

 private:
  const MapState& map_;
  GridBox around_;
  std::vector<std::int32_t> own_;  // [cells of the map] number in the tile, kElsewhere, kFreeElsewhere
  std::vector<Crossing> beam_;
};

// The first search of all, with parameters that are guessed, only climbs: the next ones have the moves.
Moves MovesOf(const Options& options, const Tile& tile, Elsewhere elsewhere) {
  const bool first = elsewhere == Elsewhere::kExplained;
  return {options.swaps && !first, tile.columns * tile.rows <= options.pair_cells && !first};
}

std::vector<SensorModel> Widened(std::vector<SensorModel> models, double factor) {
  for (SensorModel& model : models) model.sigma_m *= factor;
  return models;
}

// Searches with sigma `factor` times as large from the tile's map; its map then.
std::vector<std::uint8_t> SearchWidened(const Options& options, const MapState& map, const Tile& tile,
                                        const std::vector<RangeScans>& sensors, Elsewhere elsewhere,
                                        double factor, const std::vector<std::uint8_t>& start,
                                        Progress& progress) {
  TileGains wide =
      GainsOfTile(map, Widened(map.models, factor), tile, sensors, options.no_echo, elsewhere, progress);
  MapSearch search(&wide.gains, wide.patch, PriorOf(options));
  for (std::int32_t cell = 0; cell < wide.patch.cells(); ++cell)
    if (start[static_cast<std::size_t>(cell)] != wide.gains.occupied()[static_cast<std::size_t>(cell)])
      search.Flip(cell);
  search.Run(MovesOf(options, tile, elsewhere), [&] { progress.Tick(); });
  return wide.gains.occupied();
}

Proposal ProposalOf(const std::vector<std::uint8_t>& before, const std::vector<std::uint8_t>& after,
                    double gain, const Tile& tile, const GridBox& box) {
  Proposal proposal{{}, gain};
  for (std::size_t cell = 0; cell < before.size(); ++cell) {
    if (before[cell] == after[cell]) continue;
    const auto own = static_cast<std::int64_t>(cell);
    proposal.cells.push_back((tile.row + own / tile.columns) * box.columns + tile.column +
                             own % tile.columns);
  }
  return proposal;
}

}  // namespace

MapPrior PriorOf(const Options& options) {
  return {std::log(options.prior / (1 - options.prior)), options.smoothness};
}

TileGains GainsOfTile(const MapState& map, const std::vector<SensorModel>& models, const Tile& tile,
                      const std::vector<RangeScans>& sensors, bool no_echo, Elsewhere elsewhere,
                      Progress& progress) {
  TileGains made{FlipGains(tile.columns * tile.rows, models), PatchOf(map, tile), {}};
  BeamsOfTile beams(map, tile);
  std::size_t readings = 0;
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    const RangeScans& scans = sensors[k];
    const SensorModel& model = models[k];
    ForEachReading(scans, 0, scans.scans(), map.box, model, no_echo, [&](const BeamOfScan& reading) {
      if (readings++ % kReadingsOfTick == 0) progress.Tick();
      const auto& beam = beams.Of(reading.from, scans.opening_rad, ReachOf(reading.z_m, model));
      if (beam.empty()) return;
      const bool ends_in_map = reading.z_m < model.z_max_m && reading.end == End::kInMap;
      if (elsewhere == Elsewhere::kExplained && ends_in_map)
        beams.ExplainElsewhere(reading.z_m, kReach * model.sigma_m);
      made.gains.Add(reading.z_m, k, beam, reading.end);
      made.time_s.push_back(scans.time_s[reading.scan]);
    });
  }
  made.gains.Start(made.patch.Inside());
  return made;
}

Proposal SearchTile(const Options& options, const MapState& map, const Tile& tile,
                    const std::vector<RangeScans>& sensors, Elsewhere elsewhere, Progress& progress) {
  const auto tick = [&] { progress.Tick(); };
  const Moves moves = MovesOf(options, tile, elsewhere);
  TileGains tile_gains = GainsOfTile(map, map.models, tile, sensors, options.no_echo, elsewhere, progress);
  const std::vector<std::uint8_t> before = tile_gains.gains.occupied();
  std::vector<std::uint8_t> wide = before;
  for (double factor = options.anneal; factor > 1; factor = factor > 2 ? factor / 2 : 1)
    wide = SearchWidened(options, map, tile, sensors, elsewhere, factor, wide, progress);
  MapSearch search(&tile_gains.gains, tile_gains.patch, PriorOf(options));
  const double gain = search.Run(moves, tick);
  const Proposal direct = ProposalOf(before, tile_gains.gains.occupied(), gain, tile, map.box);
  if (options.anneal <= 1) return direct;
  double by_way_of_wide = gain;
  for (std::int32_t cell = 0; cell < tile_gains.patch.cells(); ++cell) {
    if (wide[static_cast<std::size_t>(cell)] == search.occupied(cell)) continue;
    by_way_of_wide += search.GainOf(cell);
    search.Flip(cell);
  }
  by_way_of_wide += search.Run(moves, tick);
  if (by_way_of_wide <= gain) return direct;
  return ProposalOf(before, tile_gains.gains.occupied(), by_way_of_wide, tile, map.box);
}

Certainty CertaintyOfTile(const Options& options, const MapState& map, const Tile& tile,
                          const std::vector<RangeScans>& sensors, Progress& progress) {
  const auto gains_of = [&](const std::vector<RangeScans>& of) {
    return GainsOfTile(map, map.models, tile, of, options.no_echo, Elsewhere::kAsInTheMap, progress);
  };
  const TileGains made = gains_of(sensors);
  std::vector<RangeScans> checked;
  for (const RangeScans& sensor : sensors) checked.push_back(CheckedOnly(sensor));
  const TileGains of_checked = gains_of(checked);  // a flip's gain is a sum over readings
  Certainty certainty;
  for (std::int32_t cell = 0; cell < made.patch.cells(); ++cell) {
    const bool occupied = made.gains.occupied()[static_cast<std::size_t>(cell)] != 0;
    const double gain = made.gains.GainOf(cell);
    // [Thr01] section 3.4: the difference by the cell, occupied less empty
    certainty.difference_nats.push_back(!made.gains.Seen(cell) ? std::numeric_limits<double>::quiet_NaN()
                                        : occupied             ? -gain
                                                               : gain);
    const bool passing = occupied && CameAndWentNats(made.gains, made.time_s, cell) > options.dynamic_nats;
    certainty.came_and_went.push_back(passing ? 1 : 0);
    const double checked_gain = of_checked.gains.Seen(cell) ? of_checked.gains.GainOf(cell) : 0;
    certainty.of_checked_nats.push_back(occupied ? -checked_gain : checked_gain);
  }
  return certainty;
}

}  // namespace cairn::forward_map
