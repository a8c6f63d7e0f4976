#include "schema/kinds/kind.h"

#include <algorithm>

#include "schema/kinds/tables.h"

namespace cairn {
namespace {

constexpr Kind kKinds[] = {
    {.name = "landmark_map", .mark = "map/landmark_x_m", .arrays = LandmarkMapArrays},
    {.name = "grid_map", .mark = "map/grid/probability", .arrays = GridMapArrays},
    {.name = "networks", .mark = "networks/hidden_weight", .is_plural = true, .arrays = NetworkArrays},
    {.name = "localization", .mark = "belief/position", .arrays = LocalizationArrays},
    {.name = "local_map", .mark = "traces/first_z", .arrays = LocalMapArrays},
    {.name = "log",
     .mark = "robot/0/odometry/time_s",
     .is_given = true,
     .has_units = true,
     .arrays = LogArrays},
    {.name = "poses",
     .mark = "robot/0/poses/time_s",
     .is_plural = true,
     .is_given = true,
     .has_units = true,
     .arrays = PoseArrays},
    {.name = "samples",
     .mark = "run/0/input",
     .is_plural = true,
     .is_given = true,
     .has_units = true,
     .arrays = SamplesArrays},
    {.name = "errors", .mark = "error", .is_plural = true, .is_given = true, .arrays = ErrorArrays},
};

}  // namespace

std::span<const Kind> Kinds() { return kKinds; }

const Kind* FindKind(std::string_view name) {
  const Kind* kind = std::ranges::find(kKinds, name, &Kind::name);
  return kind == std::end(kKinds) ? nullptr : kind;
}

std::string KindOf(const Blob& blob) {
  const Kind* kind =
      std::ranges::find_if(kKinds, [&](const Kind& k) { return blob.Has(std::string(k.mark)); });
  return std::string(kind == std::end(kKinds) ? "result" : kind->name);
}

void CheckKind(const Blob& blob, std::string_view name) {
  if (const Kind* kind = FindKind(name)) CheckArrays(blob, kind->arrays());
  CheckArrays(blob, ProvenanceArrays());
}

std::string WithArticle(std::string_view name) {
  const Kind* kind = FindKind(name);
  return (kind != nullptr && kind->is_plural ? "" : "a ") + std::string(name);
}

std::string IsNeeded(std::string_view name) {
  const Kind* kind = FindKind(name);
  return WithArticle(name) + (kind != nullptr && kind->is_plural ? " are needed" : " is needed");
}

}  // namespace cairn
