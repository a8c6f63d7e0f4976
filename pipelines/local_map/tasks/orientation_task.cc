#include "pipelines/local_map/tasks/orientation_task.h"

#include <cmath>
#include <optional>
#include <vector>

#include "pipelines/local_map/grids/local_grids.h"
#include "pipelines/local_map/path/motion_watch.h"
#include "pipelines/local_map/path/orientation_track.h"
#include "pipelines/local_map/path/scale_watch.h"
#include "pipelines/local_map/path/way_watch.h"

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

Blob WatchWalls(ScanReader& scans, std::size_t own, const std::optional<std::size_t>& ahead,
                GridOptions options, Progress& progress) {
  options.align = false;  // edges in one frame; what that says of walls is decided over the whole run
  LocalGrids grids(options, scans.rings());
  ScaleWatch scale(scans.beams(), ahead ? ScaleWatch::Towards::kAhead : ScaleWatch::Towards::kAxes);
  MotionWatch motion(scans.beams());
  WayWatch ways(scans.beams());
  std::vector<float> all;
  all.reserve((scans.size() - own) * kBins);
  for (std::size_t s = 0; s < scans.size(); ++s) {
    if (s % 100 == 0) progress.Tick();
    const std::span<const RingScan> read = scans.Read(s);
    if (ahead)
      motion.Update(static_cast<std::int64_t>(s), scans.time_s(s), scans.pose(s), scans.unsure(s), read,
                    s >= own);
    if (ahead && s < *ahead) continue;
    grids.Update(scans.pose(s), read);
    if (s < own) continue;
    scale.Update(static_cast<std::int64_t>(s - own), scans.pose(s), read);
    if (ahead && !scans.unsure(s)) ways.Update(static_cast<std::int64_t>(s - own), scans.pose(s), read);
    EdgeHistogram edges{};
    for (const Edge& edge : grids.current_edges())
      AddEdge(edge.angle_rad + grids.frame_rad(), Counts(edge), &edges);
    all.insert(all.end(), edges.begin(), edges.end());
  }
  scale.Finish();
  Blob blob;
  PutRows("approaches/", scale.approaches(), &blob);
  blob.Put("edges_m", Array::Of<float>({static_cast<std::int64_t>(scans.size() - own), kBins}, all));
  PutRows("motion/", motion.found(), &blob);
  PutRows("ways/", ways.found(), &blob);
  return blob;
}

}  // namespace cairn::local_map
