#include "pipelines/common/handed_over.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "schema/error.h"
#include "schema/text.h"

namespace cairn {
namespace {

[[noreturn]] void RefuseHandedOver(const std::string& why) {
  throw InputError("the plan hands over what cannot be: " + why);
}

template <class T>
[[noreturn]] void RefuseRange(std::string_view name, T value, T least, T most) {
  RefuseHandedOver(fmt::format("{} is {}, where {} to {} are allowed", name, value, least, most));
}

}  // namespace

namespace handed_over_internal {

void Refuse(std::string_view name, std::int64_t value, std::int64_t least, std::int64_t most) {
  RefuseRange(name, value, least, most);
}
void Refuse(std::string_view name, double value, double least, double most) {
  RefuseRange(name, value, least, most);
}

}  // namespace handed_over_internal

void RequireSize(std::string_view name, std::size_t size, std::size_t needed) {
  if (size == needed) return;
  RefuseHandedOver(fmt::format("{} has {} elements, where {} are needed", name, size, needed));
}

void RequirePoses(std::string_view name, std::span<const Pose> poses, double most_m) {
  constexpr double kMost_rad = 1e9;
  for (const Pose& pose : poses) {
    RequireWithin(name, pose.x_m, -most_m, most_m);
    RequireWithin(name, pose.y_m, -most_m, most_m);
    RequireWithin(name, pose.heading_rad, -kMost_rad, kMost_rad);
  }
}

void RequireGrid(const GridBox& grid, double most_cells) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  RequireWithin("a grid's cell_m", grid.cell_m, 1e-6, 1e6);
  RequireWithin("a grid's origin_x_m", grid.origin_x_m, -kFar_m, kFar_m);
  RequireWithin("a grid's origin_y_m", grid.origin_y_m, -kFar_m, kFar_m);
  RequireWithin("a grid's columns", grid.columns, 1, kMost);
  RequireWithin("a grid's rows", grid.rows, 1, kMost);
  RequireWithin("a grid's cells", static_cast<double>(grid.cells()), 1.0, most_cells);
}

void RequireKind(const proto::Task& task, std::initializer_list<std::string_view> kinds) {
  constexpr std::size_t kMostShown = 100;
  if (std::ranges::find(kinds, task.kind()) != kinds.end()) return;
  RefuseHandedOver(fmt::format("a task of the kind '{}', which this pipeline does not have",
                               Printable(task.kind(), kMostShown)));
}

std::int64_t IntegerOf(const proto::Task& task, const std::string& name, std::int64_t least,
                       std::int64_t most) {
  const auto param = task.params().find(name);
  if (param == task.params().end()) RefuseHandedOver(fmt::format("a task without '{}'", name));
  RequireWithin(name, param->second.i(), least, most);
  return param->second.i();
}

}  // namespace cairn
