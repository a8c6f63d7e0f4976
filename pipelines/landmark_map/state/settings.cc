#include "pipelines/landmark_map/state/settings.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string>

#include "pipelines/common/handed_over.h"

namespace cairn::landmark_map {
namespace {

// Calls f(name, field) for every figure: what ToBlob writes and FromBlob reads.
template <class S, class F>
void VisitSettings(S& s, const F& f) {
  f("cell_m", s.map.grid.cell_m);
  f("headings", s.map.grid.headings);
  f("types", s.map.types);
  f("classes", s.map.classes.count);
  f("partly_named", s.map.partly_named);
  f("named_later", s.map.named_later);
  f("observation_m", s.map.observation_m);
  f("radius_m", s.map.radius_m);
  f("core_m", s.map.core_m);
  f("prior_count", s.map.prior_count);
  f("no_landmark", s.map.no_landmark);
  f("false_rate_per_m2", s.map.false_rate_per_m2);
  f("exact", s.map.exact);
  f("heading_drift_rad_per_m", s.noise.heading_drift_rad_per_m);
  f("heading_walk_rad_per_sqrt_m", s.noise.heading_walk_rad_per_sqrt_m);
  f("drift_length_m", s.noise.drift_length_m);
  f("forward_ratio", s.noise.forward_ratio);
  f("turn_ratio", s.noise.turn_ratio);
  f("expected_walk_rad_per_sqrt_m", s.expected_walk_rad_per_sqrt_m);
  f("expected_turn_ratio", s.expected_turn_ratio);
  f("max_increment_m", s.steps.max_increment_m);
  f("frame_m", s.steps.frame_m);
  f("frame_rad", s.steps.frame_rad);
  f("step_types", s.steps.types);
  f("step_classes", s.steps.classes);
  f("until_s", s.steps.until_s);
  f("false_ratio", s.detection.false_ratio);
  f("miss_ratio", s.detection.miss_ratio);
  f("tells_passes", s.detection.tells_passes);
  f("contact_m", s.observation_noise.contact_m);
  f("range_m", s.observation_noise.range_m);
  f("bearing_rad", s.observation_noise.bearing_rad);
  f("in_image_m", s.in_image_m);
  f("triangular", s.shape);
  f("prune", s.prune);
  f("keep_kernels", s.keep_kernels);
  f("whole_tables", s.whole_tables);
  f("box_m", s.box_m);
  f("growth_start", s.growth_start);
  f("growth_factor", s.growth_factor);
  f("gauge_free", s.gauge_free);
  f("joins_by_geometry", s.joins_by_geometry);
  f("incremental", s.incremental);
  f("starts", s.starts);
  f("alike", s.alike);
  f("places", s.places);
  f("memory_mb", s.memory_mb);
}

}  // namespace

double DriftStep(int starts) {
  constexpr double kReach = 2.0;  // standard deviations
  const int drifts = (starts + 1) / 2;
  return drifts < 2 ? 2.0 * kReach : 2.0 * kReach / (drifts - 1);
}

EStepModel Settings::Model(const Perception* perception) const {
  Box limit;
  if (box_m > 0) {
    const int half = static_cast<int>(std::floor(box_m / 2 / map.grid.cell_m));
    limit = Box{0, 0, 1, 1}.Grown(half);
  }
  return {map.grid, noise, shape, prune, limit, memory_mb * 1e6, perception, keep_kernels, whole_tables};
}

Blob Settings::ToBlob() const {
  Blob blob;
  VisitSettings(
      *this, [&](const char* name, auto value) { blob.PutScalar<double>(name, static_cast<double>(value)); });
  blob.PutVector("confusion", map.classes.confusion);
  return blob;
}

void Settings::Check() const {
  constexpr double kMostCells = 1 << 27, kMostNoise = 1e6;
  constexpr std::int64_t kMostStarts = 1000;  // as the option has it
  const GridSpec& grid = map.grid;
  RequireWithin("cell_m", grid.cell_m, 1e-6, 1e9);
  RequireWithin("headings", std::int64_t{grid.headings}, 1, 1 << 16);
  RequireWithin("types", std::int64_t{map.types}, 0, 1 << 24);
  RequireWithin("classes", std::int64_t{map.classes.count}, 1, 256);
  const auto classes = static_cast<std::size_t>(map.classes.count);
  RequireSize("confusion", map.classes.confusion.size(), classes * classes);
  RequireAllWithin("confusion", map.classes.confusion, 0.0, 1.0 + 1e-6);
  for (const double length_m : {map.observation_m, map.radius_m, map.core_m, in_image_m, box_m})
    RequireWithin("a length of the map", length_m, 0.0, kMostCells * grid.cell_m);
  for (const double ratio :
       {noise.heading_drift_rad_per_m, noise.heading_walk_rad_per_sqrt_m, noise.forward_ratio,
        noise.turn_ratio, expected_walk_rad_per_sqrt_m, expected_turn_ratio})
    RequireWithin("noise", ratio, 0.0, kMostNoise);
  RequireWithin("drift_length_m", noise.drift_length_m, 0.0, kFar_m);
  RequireWithin("prune", prune, 0.0, 1.0);
  RequireWithin("starts", std::int64_t{starts}, 1, kMostStarts);
}

Settings Settings::FromBlob(const Blob& blob) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kMost = std::numeric_limits<std::int32_t>::max();
  Settings settings;
  VisitSettings(settings, [&]<class T>(const char* name, T& field) {
    const double value = blob.Scalar<double>(name);
    const double most = std::is_floating_point_v<T> ? kInfinity : std::is_same_v<T, int> ? kMost : 1;
    RequireWithin(name, value, std::is_floating_point_v<T> ? -kInfinity : 0, most);
    field = static_cast<T>(value);
  });
  const auto confusion = blob.Get<double>("confusion");
  settings.map.classes.confusion.assign(confusion.begin(), confusion.end());
  settings.Check();
  return settings;
}

Settings Settings::In(const Blob& blob, const Options& options) {
  Settings settings = FromBlob(blob);
  RequireWithin("memory_mb", settings.memory_mb, 0.0, options.memory_mb);
  return settings;
}

void RequireMemory(const std::string& what, double bytes, double memory_mb) {
  if (bytes <= 1e6 * memory_mb) return;
  throw InputError(
      fmt::format("{} would need about {:.0f} MB, more than memory_mb = {:.0f}: take a larger cell_m or "
                  "heading_deg, or a smaller slice_mcells",
                  what, std::ceil(bytes / 1e6), memory_mb));
}

}  // namespace cairn::landmark_map
