#include "pipelines/evidence_map/counts.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "pipelines/common/handed_over.h"
#include "pipelines/common/packed_bytes.h"
#include "schema/kinds/fields.h"

namespace cairn::evidence_map {
namespace {

// How far a scan tells of, from the robot; `from_robot_m`: where each beam begins.
double ReachOf(const RangeScans& scans, std::size_t scan, const std::vector<double>& from_robot_m) {
  const std::size_t beams = scans.beams.size();
  const auto range = scans.range_m.As<double>().subspan(scan * beams, beams);
  double reach_m = 0;
  for (std::size_t b = 0; b < beams; ++b) {
    const double length_m = std::isnan(range[b]) ? scans.max_range_m : range[b];
    reach_m = std::max(reach_m, length_m + from_robot_m[b]);
  }
  return reach_m;
}

// Counts of few cells, by their numbers in the window.
constexpr std::size_t kSparseBytes = 2 * sizeof(std::int32_t);
struct Sparse {
  std::vector<std::int32_t> cell, count;

  void Add(std::size_t k, std::int32_t n) {
    cell.push_back(static_cast<std::int32_t>(k));
    count.push_back(n);
  }
  void PutInto(const std::string& name, Blob* blob) const {
    blob->PutVector(name + "_cell", cell);
    blob->PutVector(name, count);
  }
};

// Where the window of a partial lies in the grid.
struct Place {
  Place(const GridBox& whole, const Blob& partial)
      : grid(whole),
        box(cairn::Read<GridBox>(partial)),
        column(partial.Scalar<std::int64_t>("first_column")),
        row(partial.Scalar<std::int64_t>("first_row")) {
    RequireWithin("a window's columns", box.columns, 0, whole.columns + 2);
    RequireWithin("a window's rows", box.rows, 0, whole.rows + 2);
    RequireWithin("a window's first_column", column, -whole.columns - 2, whole.columns);
    RequireWithin("a window's first_row", row, -whole.rows - 2, whole.rows);
  }

  bool HasRow(std::int64_t j) const { return row + j >= 0 && row + j < grid.rows; }
  std::int64_t first_inside() const { return std::max<std::int64_t>(0, -column); }
  std::int64_t end_inside() const { return std::min(box.columns, grid.columns - column); }
  std::int64_t CellOf(std::int64_t j, std::int64_t i) const { return (row + j) * grid.columns + column + i; }

  GridBox grid, box;
  std::int64_t column, row;  // of its first cell
};

void AddSparse(const Place& place, const Blob& partial, const std::string& name, std::int64_t unit,
               std::vector<std::int64_t>* totals) {
  const auto cell = partial.Get<std::int32_t>(name + "_cell"), count = partial.Get<std::int32_t>(name);
  RequireSize(name, count.size(), cell.size());
  RequireAllWithin(name + "_cell", cell, std::int64_t{0}, place.box.cells() - 1);
  for (std::size_t k = 0; k < cell.size(); ++k) {
    const std::int64_t j = cell[k] / place.box.columns, i = cell[k] % place.box.columns;
    if (!place.HasRow(j) || i < place.first_inside() || i >= place.end_inside()) continue;
    (*totals)[static_cast<std::size_t>(place.CellOf(j, i))] += unit * count[k];
  }
}

}  // namespace

Counts CountsFor(const RangeScans& scans, const GridBox& grid, double beyond_m) {
  std::vector<double> from_robot_m;
  for (const Pose& beam : scans.beams) from_robot_m.push_back(std::hypot(beam.x_m, beam.y_m));
  Extent extent;
  for (std::size_t s = 0; s < scans.scans(); ++s) {
    if (scans.held_out[s]) continue;
    const double reach_m = ReachOf(scans, s, from_robot_m) + beyond_m;
    extent.Add(scans.pose[s].x_m - reach_m, scans.pose[s].y_m - reach_m);
    extent.Add(scans.pose[s].x_m + reach_m, scans.pose[s].y_m + reach_m);
  }
  Counts counts;
  counts.box = {grid.origin_x_m, grid.origin_y_m, grid.cell_m, 0, 0};
  if (extent.empty()) return counts;
  counts.first_column = std::clamp<std::int64_t>(grid.ColumnOf(extent.x0_m()), 0, grid.columns) - 1;
  counts.first_row = std::clamp<std::int64_t>(grid.RowOf(extent.y0_m()), 0, grid.rows) - 1;
  const auto last_column = std::clamp<std::int64_t>(grid.ColumnOf(extent.x1_m()), -1, grid.columns - 1) + 1;
  const auto last_row = std::clamp<std::int64_t>(grid.RowOf(extent.y1_m()), -1, grid.rows - 1) + 1;
  counts.box.origin_x_m += static_cast<double>(counts.first_column) * grid.cell_m;
  counts.box.origin_y_m += static_cast<double>(counts.first_row) * grid.cell_m;
  counts.box.columns = last_column - counts.first_column + 1;
  counts.box.rows = last_row - counts.first_row + 1;
  counts.free.resize(static_cast<std::size_t>(counts.box.cells()));
  counts.occupied.resize(counts.free.size());
  return counts;
}

Blob ToBlob(const Counts& counts) {
  const std::size_t cells = counts.free.size();
  std::size_t many = 0;
  for (const std::int32_t free : counts.free) many += free >> 8 != 0;
  const bool has_high = many * kSparseBytes > cells;
  const int bits = has_high ? 16 : 8;
  std::vector<std::uint8_t> low(cells), high(has_high ? cells : 0);
  Sparse often, occupied;
  for (std::size_t k = 0; k < cells; ++k) {
    low[k] = static_cast<std::uint8_t>(counts.free[k]);
    if (has_high) high[k] = static_cast<std::uint8_t>(counts.free[k] >> 8);
    if (counts.free[k] >> bits != 0) often.Add(k, counts.free[k] >> bits);
    if (counts.occupied[k] != 0) occupied.Add(k, counts.occupied[k]);
  }
  Blob blob;
  PutFields("", counts.box, &blob);
  blob.PutScalar("first_column", counts.first_column);
  blob.PutScalar("first_row", counts.first_row);
  blob.PutVector("free_low", PackBytes(low));
  blob.PutVector("free_high", PackBytes(high));
  often.PutInto("free_often", &blob);
  occupied.PutInto("occupied", &blob);
  return blob;
}

void AddTo(const GridBox& grid, const Blob& partial, Totals* totals) {
  const Place place(grid, partial);
  const auto cells = static_cast<std::size_t>(place.box.cells());
  const auto packed_high = partial.Get<std::uint8_t>("free_high");
  const bool has_high = !packed_high.empty();
  const std::vector<std::uint8_t> low = UnpackBytes(partial.Get<std::uint8_t>("free_low"), cells),
                                  high = UnpackBytes(packed_high, has_high ? cells : 0);
  for (std::int64_t j = 0; j < place.box.rows; ++j) {
    if (!place.HasRow(j)) continue;
    const std::int64_t to = place.CellOf(j, 0), from = j * place.box.columns;
    for (std::int64_t i = place.first_inside(); i < place.end_inside(); ++i) {
      const auto k = static_cast<std::size_t>(from + i);
      totals->free[static_cast<std::size_t>(to + i)] += low[k] + (has_high ? 256 * std::int64_t{high[k]} : 0);
    }
  }
  AddSparse(place, partial, "free_often", has_high ? 65536 : 256, &totals->free);
  AddSparse(place, partial, "occupied", 1, &totals->occupied);
}

}  // namespace cairn::evidence_map
