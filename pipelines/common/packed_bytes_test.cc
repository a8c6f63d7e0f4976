#include "pipelines/common/packed_bytes.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace cairn
