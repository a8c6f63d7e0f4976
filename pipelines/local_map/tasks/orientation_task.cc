#include "pipelines/local_map/tasks/orientation_task.h"

#include <cmath>
#include <vector>

#include "pipelines/local_map/grids/local_grids.h"
#include "pipelines/local_map/path/orientation_track.h"
#include "pipelines/local_map/path/scale_watch.h"

namespace cairn::local_map {
namespace {

// What an edge says of the walls' orientation goes with the inverse variance of its direction: one that is
// this certain counts as a metre of wall.
constexpr double kMetreSd_deg = 0.55;

double Counts(const Edge& edge) {
  const double ratio = kMetreSd_deg / DegOf(edge.sd_rad);
  return ratio * ratio;
}

}  // namespace

Blob WatchWalls(SweepReader& sweeps, std::size_t own, GridOptions options, Progress& progress) {
  options.align = false;  // edges in one frame; what that says of walls is decided over the whole run
  LocalGrids grids(options, sweeps.rings());
  ScaleWatch scale(sweeps.beams());
  std::vector<float> all;
  all.reserve((sweeps.size() - own) * kBins);
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    if (s % 100 == 0) progress.Tick();
    const std::span<const RingSweep> read = sweeps.Read(s);
    grids.Update(sweeps.pose(s), read);
    if (s < own) continue;
    scale.Update(sweeps.pose(s), read);
    EdgeHistogram edges{};
    for (const Edge& edge : grids.current_edges())
      AddEdge(edge.angle_rad + grids.frame_rad(), Counts(edge), &edges);
    all.insert(all.end(), edges.begin(), edges.end());
  }
  scale.Finish();
  std::vector<double> way2, way_distance;
  for (const Approach& approach : scale.approaches()) {
    way2.push_back(approach.way2_m2);
    way_distance.push_back(approach.way_distance_m2);
  }
  Blob blob;
  blob.PutVector("way2_m2", way2);
  blob.PutVector("way_distance_m2", way_distance);
  blob.Put("edges_m", Array::Of<float>({static_cast<std::int64_t>(sweeps.size() - own), kBins}, all));
  return blob;
}

}  // namespace cairn::local_map
