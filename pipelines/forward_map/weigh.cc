#include "pipelines/forward_map/weigh.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "pipelines/forward_map/beams.h"

namespace cairn::forward_map {
namespace {

constexpr double kLeastHit = 0.02, kMostHit = 0.99, kLeastRandom = 1e-4, kMostRandom = 0.9;
constexpr std::size_t kReadingsOfATick = 256;

// visit(reading, cells of the obstacles in its beam, their distances).
template <class Visit>
void ForEachExplained(const RangeScans& scans, std::size_t first, std::size_t end, const GridBox& box,
                      std::span<const std::uint8_t> occupied, const SensorModel& model, bool no_echo,
                      Progress& progress, Visit&& visit) {
  std::vector<BeamCell> obstacles;
  std::vector<std::int64_t> cells;
  std::vector<double> distances_m;
  std::size_t readings = 0;
  ForEachReading(scans, first, end, box, model, no_echo, [&](const BeamOfScan& reading) {
    if (readings++ % kReadingsOfATick == 0) progress.Tick();
    obstacles.clear();
    VisitBeam(
        box, reading.from, scans.opening_rad, ReachOf(reading.z_m, model),
        [&](std::int64_t cell) { return occupied[static_cast<std::size_t>(cell)] != 0; },
        [&](std::int64_t cell, double distance_m) { obstacles.push_back({cell, distance_m}); });
    std::ranges::sort(obstacles, [](const BeamCell& a, const BeamCell& b) {
      return std::tie(a.distance_m, a.cell) < std::tie(b.distance_m, b.cell);
    });
    cells.clear();
    distances_m.clear();
    for (const auto& [cell, distance_m] : obstacles) {
      cells.push_back(cell);
      distances_m.push_back(distance_m);
    }
    visit(reading, cells, distances_m);
  });
}

}  // namespace

void Evidence::Add(const Evidence& other) {
  readings += other.readings;
  log_likelihood += other.log_likelihood;
  entropy += other.entropy;
  random += other.random;
  lost += other.lost;
  hits += other.hits;
  misses += other.misses;
  squares_m2 += other.squares_m2;
}

Evidence Weigh(const RangeScans& scans, std::size_t first, std::size_t end, const GridBox& box,
               std::span<const std::uint8_t> occupied, const SensorModel& model, bool no_echo,
               Progress& progress) {
  Evidence sum;
  ForEachExplained(scans, first, end, box, occupied, model, no_echo, progress,
                   [&](const BeamOfScan& reading, const std::vector<std::int64_t>&,
                       const std::vector<double>& distances_m) {
                     // [Thr01] eq. 13
                     const Causes causes = Responsibilities(reading.z_m, distances_m, model, reading.end);
                     ++sum.readings;
                     // [Thr01] eqs 2, 10, the correspondences summed out: log p(Z | m)
                     sum.log_likelihood += std::log(Density(reading.z_m, distances_m, model, reading.end));
                     sum.entropy += Entropy(causes);
                     sum.random += causes.random;
                     sum.lost += causes.lost;
                     for (std::size_t k = 0; k < distances_m.size(); ++k) {
                       const double hit = causes.obstacle[k], off_m = reading.z_m - distances_m[k];
                       sum.hits += hit;
                       sum.misses += hit * static_cast<double>(k);
                       sum.squares_m2 += hit * off_m * off_m;
                     }
                     sum.misses += causes.none * static_cast<double>(distances_m.size());
                   });
  return sum;
}

std::vector<std::int32_t> ExplainAll(const RangeScans& scans, const GridBox& box,
                                     std::span<const std::uint8_t> occupied, const SensorModel& model,
                                     bool no_echo, Progress& progress) {
  std::vector<std::int32_t> cause(scans.scans() * scans.beams.size(), kNotUsed);
  ForEachExplained(scans, 0, scans.scans(), box, occupied, model, no_echo, progress,
                   [&](const BeamOfScan& reading, const std::vector<std::int64_t>& cells,
                       const std::vector<double>& distances_m) {
                     const Causes causes = Responsibilities(reading.z_m, distances_m, model, reading.end);
                     double most = causes.random;
                     std::int32_t& best = cause[reading.scan * scans.beams.size() + reading.beam];
                     best = kRandomCause;
                     for (std::size_t k = 0; k < cells.size(); ++k) {
                       if (causes.obstacle[k] <= most) continue;
                       most = causes.obstacle[k];
                       best = static_cast<std::int32_t>(cells[k]);
                     }
                     if (causes.none > most) best = reading.end == End::kBeyond ? kBeyondCause : kNoEchoCause;
                     if (causes.lost > std::max(most, causes.none)) best = kLostCause;
                   });
  return cause;
}

SensorModel Improved(const SensorModel& model, const Evidence& evidence, double least_sigma_m) {
  SensorModel improved = model;
  if (evidence.readings == 0) return improved;
  // Of what is not lost: p_lost is given.
  const double heard = evidence.readings - evidence.lost;
  if (heard > 0) {
    const double random = (1 - model.p_lost) * evidence.random / heard;
    improved.p_rand = std::clamp(random, kLeastRandom, std::min(kMostRandom, kMostFailures - model.p_lost));
  }
  if (evidence.hits + evidence.misses > 0)
    improved.p_hit = std::clamp(evidence.hits / (evidence.hits + evidence.misses), kLeastHit, kMostHit);
  if (evidence.hits > 0)
    improved.sigma_m = std::max(least_sigma_m, std::sqrt(evidence.squares_m2 / evidence.hits));
  return improved;
}

}  // namespace cairn::forward_map
