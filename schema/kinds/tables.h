// The tables of schema/FORMAT.md, one a kind: rows as there, in its order.
#pragma once

#include <span>

#include "schema/kinds/array_spec.h"

namespace cairn {

// As the page calls them.
inline constexpr DType u8 = DType::kU8, i32 = DType::kI32, i64 = DType::kI64, f32 = DType::kF32,
                       f64 = DType::kF64, text = DType::kText;

std::span<const ArraySpec> LogArrays();
std::span<const ArraySpec> PoseArrays();
std::span<const ArraySpec> LandmarkMapArrays();
std::span<const ArraySpec> GridMapArrays();
std::span<const ArraySpec> LocalMapArrays();
std::span<const ArraySpec> SamplesArrays();
std::span<const ArraySpec> ErrorArrays();
std::span<const ArraySpec> NetworkArrays();
std::span<const ArraySpec> LocalizationArrays();
std::span<const ArraySpec> ProvenanceArrays();  // in a file of any kind

}  // namespace cairn
