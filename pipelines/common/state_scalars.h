// A struct with a list of fields (schema/kinds/fields.h) as scalars of a State: what a round goes on from.
#pragma once

#include <string>
#include <type_traits>

#include "pipelines/pipeline.h"
#include "schema/kinds/fields.h"

namespace cairn {

// Of every field "NAMEsuffix": a truth value, a whole number or an enum, a number.
template <class T>
void PutScalars(const T& value, const std::string& suffix, State* state) {
  T::Fields([&](const Field& field, const auto& member) {
    const auto& of = std::invoke(member, value);
    using F = std::remove_cvref_t<decltype(of)>;
    proto::Value& scalar = (*state->mutable_scalars())[std::string(field.name) + suffix];
    if constexpr (std::is_same_v<F, bool>)
      scalar.set_b(of);
    else if constexpr (std::is_floating_point_v<F>)
      scalar.set_d(of);
    else
      scalar.set_i(static_cast<std::int64_t>(of));
  });
}

// Throws std::out_of_range where the State has none of the name.
template <class T>
T ScalarsIn(const State& state, const std::string& suffix = "") {
  T value;
  T::Fields([&](const Field& field, const auto& member) {
    auto& of = std::invoke(member, value);
    using F = std::remove_cvref_t<decltype(of)>;
    const proto::Value& scalar = state.scalars().at(std::string(field.name) + suffix);
    if constexpr (std::is_same_v<F, bool>)
      of = scalar.b();
    else if constexpr (std::is_floating_point_v<F>)
      of = scalar.d();
    else
      of = static_cast<F>(scalar.i());
  });
  return value;
}

}  // namespace cairn
