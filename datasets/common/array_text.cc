#include "datasets/common/array_text.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>

namespace cairn::datasets {

std::string TypeText(const Array& array) {
  return DTypeName(array.type()) +
         (array.type() == DType::kText ? std::to_string(array.item_bytes()) : std::string());
}

std::string ShapeText(const std::vector<std::int64_t>& shape) {
  std::string text;
  for (const std::int64_t n : shape) text += (text.empty() ? "" : ",") + std::to_string(n);
  return "[" + text + "]";
}

std::string ElementText(const Array& array, std::int64_t index) {
  const auto i = static_cast<std::size_t>(index);
  switch (array.type()) {
    case DType::kU8:
      return std::to_string(array.As<std::uint8_t>()[i]);
    case DType::kI32:
      return std::to_string(array.As<std::int32_t>()[i]);
    case DType::kI64:
      return std::to_string(array.As<std::int64_t>()[i]);
    case DType::kF32:
      return fmt::format("{:.9g}", array.As<float>()[i]);
    case DType::kF64:
      return NumberText(array.As<double>()[i]);
    case DType::kText: {
      const char* text = reinterpret_cast<const char*>(array.bytes().data()) + i * array.item_bytes();
      return "'" + std::string(text, strnlen(text, array.item_bytes())) + "'";
    }
  }
  return {};
}

double ElementNumber(const Array& array, std::int64_t index) {
  const auto i = static_cast<std::size_t>(index);
  switch (array.type()) {
    case DType::kU8:
      return array.As<std::uint8_t>()[i];
    case DType::kI32:
      return array.As<std::int32_t>()[i];
    case DType::kI64:
      return static_cast<double>(array.As<std::int64_t>()[i]);
    case DType::kF32:
      return static_cast<double>(array.As<float>()[i]);
    case DType::kF64:
      return array.As<double>()[i];
    case DType::kText:
      break;
  }
  return NAN;
}

std::string NumberText(double value) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

std::string ShortNumber(double value) {
  // Seconds since 1970 would all look alike in four digits.
  return fmt::format("{:.{}g}", value, std::abs(value) < 1e5 ? 4 : 12);
}

}  // namespace cairn::datasets
