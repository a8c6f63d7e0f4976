#include "pipelines/local_map/tasks/pass_task.h"

#include <cstdint>

#include "pipelines/local_map/path/motion_watch.h"
#include "pipelines/local_map/path/pass_watch.h"

namespace cairn::local_map {

Blob WatchPasses(ScanReader& scans, const std::vector<Scan>& rows, Progress& progress) {
  const auto laser = LaserOfMostBeams(scans.beams());
  if (!laser) return BlobOf(std::vector<Passing>());
  PassWatch watch(scans.beams()[*laser]);
  for (std::size_t s = 0; s < scans.size(); ++s) {
    if (s % 100 == 0) progress.Tick();
    const RingScan& read = scans.Read(s)[*laser];
    if (!read.range_m.empty() && !rows[s].unsure)
      watch.Add(static_cast<std::int64_t>(s), rows[s].pose, rows[s].path_m, read);
  }
  return BlobOf(watch.Compare(progress));
}

}  // namespace cairn::local_map
