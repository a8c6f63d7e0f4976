// How fast evidence_map takes in laser rays, beside MRPT's 2-D grid and OctoMap with the same rays, on one
// thread: rays a second, the best of some turns, and the ratios.
//   evidence_rate LOG.h5 [CELL_M]      # a log with lasers and poses, as `cairn import carmen` makes it
// Built with those of the two that are installed (libmrpt-maps-dev, liboctomap-dev).
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pipelines/common/range_scans.h"
#include "pipelines/evidence_map/ray_counts.h"
#include "schema/store/blob_file.h"
#include "tests/bench/bench_main.h"

#ifdef CAIRN_WITH_MRPT
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/poses/CPose3D.h>
#endif
#ifdef CAIRN_WITH_OCTOMAP
#include <octomap/octomap.h>
#endif

namespace cairn {
namespace {

struct NoProgress : Progress {
  void Tick() override {}
};

double ThreadSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Seconds of processor time of the quickest of some turns: at least three, and a second of them.
double Quickest(const std::function<void()>& work) {
  double least = std::numeric_limits<double>::infinity(), all = 0;
  for (int turn = 0; turn < 3 || all < 1; ++turn) {
    const double begin = ThreadSeconds();
    work();
    const double seconds = ThreadSeconds() - begin;
    least = std::min(least, seconds);
    all += seconds;
  }
  return least;
}

struct Measured {
  const RangeScans& scans;
  GridBox grid;
  double rays;  // with an answer; only those are given to all
};

double Ours(const Measured& m) {
  NoProgress progress;
  std::int64_t occupied = 0;
  const double seconds = Quickest([&] {
    const evidence_map::Counts counts = evidence_map::CountRays(m.scans, m.grid, false, progress);
    for (const std::int32_t count : counts.occupied) occupied += count;
  });
  std::printf("  evidence_map %12.4g rays/s\n", m.rays / seconds);
  if (occupied == 0) throw InputError("no ray met anything");
  return m.rays / seconds;
}

#ifdef CAIRN_WITH_MRPT
void Mrpt(const Measured& m, double ours) {
  const std::size_t beams = m.scans.beams.size();
  const auto range = m.scans.range_m.As<double>();
  std::vector<mrpt::obs::CObservation2DRangeScan> observations(m.scans.scans());
  std::vector<mrpt::poses::CPose3D> poses;
  for (std::size_t s = 0; s < m.scans.scans(); ++s) {
    auto& o = observations[s];
    o.aperture = static_cast<float>(m.scans.beams.back().heading_rad - m.scans.beams.front().heading_rad);
    o.rightToLeft = true;
    o.maxRange = static_cast<float>(m.scans.max_range_m);
    o.sensorPose = mrpt::poses::CPose3D(m.scans.beams[0].x_m, m.scans.beams[0].y_m, 0, 0, 0, 0);
    o.resizeScan(beams);
    for (std::size_t b = 0; b < beams; ++b) {
      const double measured = range[s * beams + b];
      o.setScanRange(b, std::isnan(measured) ? 0 : static_cast<float>(measured));
      o.setScanRangeValidity(b, !std::isnan(measured));
    }
    poses.emplace_back(m.scans.pose[s].x_m, m.scans.pose[s].y_m, 0, m.scans.pose[s].heading_rad, 0, 0);
  }
  const double seconds = Quickest([&] {
    mrpt::maps::COccupancyGridMap2D map(
        static_cast<float>(m.grid.origin_x_m),
        static_cast<float>(m.grid.origin_x_m + static_cast<double>(m.grid.columns) * m.grid.cell_m),
        static_cast<float>(m.grid.origin_y_m),
        static_cast<float>(m.grid.origin_y_m + static_cast<double>(m.grid.rows) * m.grid.cell_m),
        static_cast<float>(m.grid.cell_m));
    map.insertionOptions.maxDistanceInsertion = 1e3F;
    map.insertionOptions.considerInvalidRangesAsFreeSpace = false;
    for (std::size_t s = 0; s < observations.size(); ++s) map.insertObservation(observations[s], poses[s]);
  });
  std::printf("  MRPT         %12.4g rays/s, ratio %.2f\n", m.rays / seconds, ours * seconds / m.rays);
}
#endif

#ifdef CAIRN_WITH_OCTOMAP
void Octomap(const Measured& m, double ours) {
  const std::size_t beams = m.scans.beams.size();
  const auto range = m.scans.range_m.As<double>();
  std::vector<octomap::Pointcloud> clouds(m.scans.scans());
  std::vector<octomap::point3d> origins;
  for (std::size_t s = 0; s < m.scans.scans(); ++s) {
    for (std::size_t b = 0; b < beams; ++b) {
      if (std::isnan(range[s * beams + b])) continue;
      const Pose end = Compose(m.scans.BeamPose(s, b), {range[s * beams + b], 0, 0});
      clouds[s].push_back(static_cast<float>(end.x_m), static_cast<float>(end.y_m), 0);
    }
    const Pose from = m.scans.BeamPose(s, 0);
    origins.emplace_back(static_cast<float>(from.x_m), static_cast<float>(from.y_m), 0);
  }
  const double seconds = Quickest([&] {
    octomap::OcTree tree(m.grid.cell_m);
    for (std::size_t s = 0; s < clouds.size(); ++s) tree.insertPointCloud(clouds[s], origins[s]);
  });
  std::printf("  OctoMap      %12.4g rays/s, ratio %.1f\n", m.rays / seconds, ours * seconds / m.rays);
}
#endif

// As in a worker: memory that was freed is not given back, for all that are measured here.
void KeepMemory() {
  ::mallopt(M_MMAP_THRESHOLD, 64 << 20);
  ::mallopt(M_TRIM_THRESHOLD, 64 << 20);
}

int Main(const std::vector<std::string>& args) {
  KeepMemory();
  if (args.empty() || args.size() > 2) throw InputError("what is measured is LOG.h5 [CELL_M]");
  const auto file = ReadBlobFileWithoutTruth(args[0]);
  if (!file.ok()) throw InputError(file.status().message());
  const Blob& log = file.value().blob;
  GridOptions options;
  options.sensors = "laser";
  if (args.size() == 2) options.cell_m = std::strtod(args[1].c_str(), nullptr);
  const PosedScans scans = ReadRangeScans(log, nullptr, options);
  const RangeScans& laser = scans.sensors.at(0);
  Measured measured{laser, GridOf(scans, options, 8), 0};
  double cells = 0;
  for (const double range_m : laser.range_m.As<double>()) {
    if (std::isnan(range_m)) continue;
    ++measured.rays;
    cells += range_m / options.cell_m;
  }
  std::printf("%.0f rays, %.0f cells of %g m long in the mean, a grid of %ld by %ld\n", measured.rays,
              cells / measured.rays, options.cell_m, static_cast<long>(measured.grid.columns),
              static_cast<long>(measured.grid.rows));
  const double ours = Ours(measured);
#ifdef CAIRN_WITH_MRPT
  Mrpt(measured, ours);
#else
  std::printf("  MRPT         not installed (libmrpt-maps-dev)\n");
#endif
#ifdef CAIRN_WITH_OCTOMAP
  Octomap(measured, ours);
#else
  std::printf("  OctoMap      not installed (liboctomap-dev)\n");
#endif
  static_cast<void>(ours);
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return cairn::BenchMain("evidence_rate", cairn::Main, argc, argv); }
