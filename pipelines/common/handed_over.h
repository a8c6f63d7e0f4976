// What a task is handed others have planned and computed, and one of those workers may lie: parameters, sizes
// and indices are checked where they come in, and numbers are within what the task can compute with.
// All throw InputError that names what is wrong.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include "schema/blob.h"
#include "schema/geometry.h"
#include "schema/job.pb.h"

namespace cairn {

inline constexpr double kFar_m = 1e12;  // GridBox tells no further places apart

namespace handed_over_internal {

[[noreturn]] void Refuse(std::string_view name, std::int64_t value, std::int64_t least, std::int64_t most);
[[noreturn]] void Refuse(std::string_view name, double value, double least, double most);

}  // namespace handed_over_internal

// Within [least, most]; NaN is not.
inline void RequireWithin(std::string_view name, std::int64_t value, std::int64_t least, std::int64_t most) {
  if (value < least || value > most) handed_over_internal::Refuse(name, value, least, most);
}
inline void RequireWithin(std::string_view name, double value, double least, double most) {
  if (!(value >= least && value <= most)) handed_over_internal::Refuse(name, value, least, most);
}
template <class Values, class T>
void RequireAllWithin(std::string_view name, const Values& values, T least, T most) {
  for (const auto& value : values) RequireWithin(name, static_cast<T>(value), least, most);
}
void RequireSize(std::string_view name, std::size_t size, std::size_t needed);
void RequirePoses(std::string_view name, std::span<const Pose> poses, double most_m = kFar_m);
// Of cells that one can count, at most `most_cells` of them.
void RequireGrid(const GridBox& grid, double most_cells);

// Of one of the kinds that the pipeline plans.
void RequireKind(const proto::Task& task, std::initializer_list<std::string_view> kinds);

// A parameter within [least, most].
std::int64_t IntegerOf(const proto::Task& task, const std::string& name, std::int64_t least,
                       std::int64_t most);

}  // namespace cairn
