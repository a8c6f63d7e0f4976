// Arrays for people: types, shapes, elements.
#pragma once

#include <cstdint>
#include <string>

#include "schema/array.h"

namespace cairn::datasets {

std::string TypeText(const Array& array);                       // "float64"; texts with their width: "text12"
std::string ShapeText(const std::vector<std::int64_t>& shape);  // "[3,4]"; also of an index
std::string ElementText(const Array& array, std::int64_t index);
double ElementNumber(const Array& array, std::int64_t index);  // NaN for a text
// The shortest text that reads back as the same number, whatever the locale.
std::string NumberText(double value);
std::string ShortNumber(double value);  // four digits, "0.08333"; of large numbers twelve

}  // namespace cairn::datasets
