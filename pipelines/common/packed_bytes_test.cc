#include "pipelines/common/packed_bytes.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <span>
#include <vector>

#include "schema/error.h"

namespace cairn {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(PackedBytes, ComeBackAndRunsAreSmall) {
  Bytes bytes(100'000);
  for (std::size_t k = 0; k < 300; ++k) bytes[331 * k] = static_cast<std::uint8_t>(k);
  const Bytes packed = PackBytes(bytes);
  EXPECT_LT(packed.size(), 5'000U);
  EXPECT_EQ(UnpackBytes(packed, bytes.size()), bytes);
  EXPECT_EQ(UnpackBytes(PackBytes({}), 0), Bytes());
  std::uint32_t random = 1;
  for (std::uint8_t& byte : bytes)
    byte = static_cast<std::uint8_t>((random = random * 1664525 + 1013904223) >> 24);
  EXPECT_EQ(UnpackBytes(PackBytes(bytes), bytes.size()), bytes) << "of what cannot be made small";
}

TEST(PackedBytes, OfAnotherSizeOrDamagedAreRefused) {
  const Bytes bytes(1'000, 7);
  Bytes packed = PackBytes(bytes);
  EXPECT_THROW(UnpackBytes(packed, 999), InputError);
  EXPECT_THROW(UnpackBytes(packed, 1'001), InputError);
  EXPECT_THROW(UnpackBytes({}, 1), InputError);
  EXPECT_THROW(UnpackBytes(packed, 0), InputError);
  packed.pop_back();
  EXPECT_THROW(UnpackBytes(packed, 1'000), InputError);
}

TEST(PackedBytes, NumbersOfAllSizesComeBackAndLikeOnesAreSmall) {
  const std::vector<std::int32_t> few = {0, 1, -1, 255, 256, -256, 1 << 24, INT32_MAX, INT32_MIN};
  EXPECT_EQ(UnpackNumbers(PackNumbers(few), few.size()), few);
  EXPECT_EQ(UnpackNumbers(PackNumbers({}), 0), std::vector<std::int32_t>());
  std::vector<std::int32_t> steps;  // none follows from the ones before
  for (std::uint32_t k = 0, random = 1; k < 10'000; ++k)
    steps.push_back(static_cast<std::int32_t>((random = random * 1664525 + 1013904223) >> 24) - 20);
  const Bytes packed = PackNumbers(steps);
  const std::span as_they_are(reinterpret_cast<const std::uint8_t*>(steps.data()), 4 * steps.size());
  EXPECT_LT(packed.size(), PackBytes(as_they_are).size() / 2);
  EXPECT_EQ(UnpackNumbers(packed, steps.size()), steps);
  EXPECT_THROW(UnpackNumbers(packed, 9'999), InputError);
}

}  // namespace
}  // namespace cairn
