#include "pipelines/evidence_map/counts.h"

#include <algorithm>
#include <cmath>

namespace cairn::evidence_map {
namespace {

// How far a scan tells of, from the robot.
double ReachOf(const RangeScans& scans, std::size_t scan) {
  const std::size_t beams = scans.beams.size();
  const auto range = scans.range_m.As<double>().subspan(scan * beams, beams);
  double reach_m = 0;
  for (std::size_t b = 0; b < beams; ++b) {
    const double length_m = std::isnan(range[b]) ? scans.max_range_m : range[b];
    reach_m = std::max(reach_m, length_m + std::hypot(scans.beams[b].x_m, scans.beams[b].y_m));
  }
  return reach_m;
}

}  // namespace

Counts CountsFor(const RangeScans& scans, const GridBox& grid, double beyond_m) {
  Extent extent;
  for (std::size_t s = 0; s < scans.scans(); ++s) {
    if (scans.held_out[s]) continue;
    const double reach_m = ReachOf(scans, s) + beyond_m;
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

void AddTo(const GridBox& grid, const Counts& counts, Totals* totals) {
  for (std::int64_t j = 0; j < counts.box.rows; ++j) {
    const std::int64_t row = counts.first_row + j;
    if (row < 0 || row >= grid.rows) continue;
    const std::int64_t begin = std::max<std::int64_t>(0, -counts.first_column);
    const std::int64_t end = std::min(counts.box.columns, grid.columns - counts.first_column);
    for (std::int64_t i = begin; i < end; ++i) {
      const auto from = static_cast<std::size_t>(j * counts.box.columns + i);
      const auto to = static_cast<std::size_t>(row * grid.columns + counts.first_column + i);
      totals->free[to] += counts.free[from];
      totals->occupied[to] += counts.occupied[from];
    }
  }
}

Blob ToBlob(const Counts& counts) {
  std::vector<std::int32_t> cell, count;
  for (std::size_t k = 0; k < counts.occupied.size(); ++k) {
    if (counts.occupied[k] == 0) continue;
    cell.push_back(static_cast<std::int32_t>(k));
    count.push_back(counts.occupied[k]);
  }
  Blob blob;
  PutGridBox("", counts.box, &blob);
  blob.PutScalar("first_column", counts.first_column);
  blob.PutScalar("first_row", counts.first_row);
  blob.PutVector("free", counts.free);
  blob.PutVector("occupied_cell", cell);
  blob.PutVector("occupied", count);
  return blob;
}

Counts CountsOf(const Blob& blob) {
  const auto free = blob.Get<std::int32_t>("free");
  const auto cell = blob.Get<std::int32_t>("occupied_cell"), count = blob.Get<std::int32_t>("occupied");
  Counts counts{GridBoxOf("", blob),
                blob.Scalar<std::int64_t>("first_column"),
                blob.Scalar<std::int64_t>("first_row"),
                {free.begin(), free.end()},
                std::vector<std::int32_t>(free.size())};
  for (std::size_t k = 0; k < cell.size(); ++k) counts.occupied[static_cast<std::size_t>(cell[k])] = count[k];
  return counts;
}

}  // namespace cairn::evidence_map
