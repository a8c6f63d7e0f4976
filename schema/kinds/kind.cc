#include "schema/kinds/kind.h"

#include <algorithm>

#include "schema/kinds/grid_map.h"
#include "schema/kinds/learning.h"
#include "schema/kinds/local_map.h"
#include "schema/kinds/log.h"
#include "schema/kinds/map_so_far.h"
#include "schema/kinds/provenance.h"

namespace cairn {
namespace {

constexpr std::string_view kSoFar = "map_so_far";

constexpr Kind kKinds[] = {
    {.name = kSoFar, .mark = "so_far/what", .arrays = ArraysOf<kinds::MapSoFar>},
    {.name = "landmark_map", .mark = "map/landmark_x_m", .arrays = ArraysOf<kinds::LandmarkMap>},
    {.name = "grid_map", .mark = "map/grid/probability", .arrays = ArraysOf<kinds::GridMap>},
    {.name = "networks",
     .mark = "networks/hidden_weight",
     .is_plural = true,
     .arrays = ArraysOf<kinds::Networks>},
    {.name = "localization", .mark = "belief/position", .arrays = ArraysOf<kinds::Localization>},
    {.name = "local_map", .mark = "traces/first_z", .arrays = ArraysOf<kinds::LocalMap>},
    {.name = "log",
     .mark = "robot/0/odometry/time_s",
     .is_given = true,
     .has_units = true,
     .arrays = ArraysOf<kinds::Log>},
    {.name = "poses",
     .mark = "robot/0/poses/time_s",
     .is_plural = true,
     .is_given = true,
     .has_units = true,
     .arrays = ArraysOf<kinds::Poses>},
    {.name = "samples",
     .mark = "run/0/input",
     .is_plural = true,
     .is_given = true,
     .has_units = true,
     .arrays = ArraysOf<kinds::Samples>},
    {.name = "errors",
     .mark = "error",
     .is_plural = true,
     .is_given = true,
     .arrays = ArraysOf<kinds::Errors>},
};

}  // namespace

std::span<const Kind> Kinds() { return kKinds; }

const Kind* FindKind(std::string_view name) {
  const Kind* kind = std::ranges::find(kKinds, name, &Kind::name);
  return kind == std::end(kKinds) ? nullptr : kind;
}

std::span<const ArraySpec> ProvenanceArrays() {
  static const std::vector<ArraySpec> arrays = ArraysUnder<kinds::Provenance>("provenance/");
  return arrays;
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

void CheckInput(const Blob& blob, const std::string& role) {
  try {
    const std::string kind = KindOf(blob);
    if (kind == kSoFar) throw InputError("it is " + WithArticle(kind));
    CheckKind(blob, kind);
    if (role != kind && FindKind(role) != nullptr) CheckKind(blob, role);
  } catch (const InputError& error) {
    throw InputError("input '" + role + "': " + error.what());
  }
}

std::string WithArticle(std::string_view name) {
  const Kind* kind = FindKind(name);
  const char* const but = name == kSoFar ? " (a map that is still being made: no result)" : "";
  return (kind != nullptr && kind->is_plural ? "" : "a ") + std::string(name) + but;
}

std::string IsNeeded(std::string_view name) {
  const Kind* kind = FindKind(name);
  return WithArticle(name) + (kind != nullptr && kind->is_plural ? " are needed" : " is needed");
}

}  // namespace cairn
