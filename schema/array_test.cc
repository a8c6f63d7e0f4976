#include "schema/array.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace cairn {
namespace {

TEST(Array, KeepsShapeTypeAndValues) {
  const Array array = Array::Of<double>({2, 3}, std::vector<double>{1, 2, 3, 4, 5, 6});
  EXPECT_EQ(array.type(), DType::kF64);
  EXPECT_EQ(array.shape(), (Shape{2, 3}));
  EXPECT_EQ(array.size(), 6);
  EXPECT_EQ(array.As<double>()[4], 5.0);
  EXPECT_THROW(array.As<float>(), InputError);
}

TEST(Array, IsAlignedTo64BytesRowsToo) {
  const Array array = Array::Of<std::int32_t>({3, 1}, std::vector<std::int32_t>{1, 2, 3});
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.bytes().data()) % 64, 0U);
  const Array rows = array.Rows(1, 2);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(rows.bytes().data()) % 64, 0U);
  EXPECT_EQ(rows.shape(), (Shape{2, 1}));
  EXPECT_EQ(rows.As<std::int32_t>()[0], 2);
}

TEST(Array, TextsComeBack) {
  const std::vector<std::string> texts{"a", "", "Grüße"};
  EXPECT_EQ(Array::Texts(texts).AsTexts(), texts);
  EXPECT_EQ(Array::Text("hello").AsTexts(), std::vector<std::string>{"hello"});
  EXPECT_TRUE(Array::Text("hello").shape().empty());
}

TEST(Array, RefusesBytesThatDoNotFitTheShape) {
  const std::vector<std::byte> bytes(16);
  EXPECT_TRUE(Array::FromBytes(DType::kF64, 8, {2}, bytes).ok());
  EXPECT_FALSE(Array::FromBytes(DType::kF64, 8, {3}, bytes).ok());
  EXPECT_FALSE(Array::FromBytes(DType::kF64, 4, {4}, bytes).ok());
  EXPECT_FALSE(Array::FromBytes(DType::kF64, 8, {-2}, bytes).ok());
  EXPECT_FALSE(Array::FromBytes(static_cast<DType>(99), 8, {2}, bytes).ok());
  EXPECT_FALSE(Array::FromBytes(DType::kU8, 1, {INT64_MAX, INT64_MAX}, bytes).ok());
  EXPECT_FALSE(Array::FromBytes(DType::kText, 0, {2}, {}).ok());
}

TEST(Array, EqualityIsOfTypeShapeAndBytes) {
  const Array a = Array::Vector<double>({1, 2});
  EXPECT_EQ(a, Array::Vector<double>({1, 2}));
  EXPECT_FALSE(a == Array::Vector<double>({1, 3}));
  EXPECT_FALSE(a == Array::Of<double>({2, 1}, std::vector<double>{1, 2}));
}

}  // namespace
}  // namespace cairn
