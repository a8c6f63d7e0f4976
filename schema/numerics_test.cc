#include "schema/numerics.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <thread>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace cairn {
namespace {

TEST(Numerics, TheSelfTestIsTheSameInEveryThread) {
  FixNumericsOfProcess();
  FixNumericsOfThread();
  const Hash here = NumericSelfTest();
  Hash there;
  std::thread other([&] {
    FixNumericsOfThread();
    there = NumericSelfTest();
  });
  other.join();
  EXPECT_EQ(here, there);
  EXPECT_FALSE(here.empty());
}

#if defined(__x86_64__)
TEST(Numerics, TheSelfTestSeesThatSubnormalNumbersAreFlushed) {
  FixNumericsOfThread();
  const Hash right = NumericSelfTest();
  _mm_setcsr(_mm_getcsr() | 0x8040);
  const Hash flushed = NumericSelfTest();
  FixNumericsOfThread();
  EXPECT_NE(right, flushed);
  EXPECT_EQ(NumericSelfTest(), right);
}
#endif

TEST(Numerics, ProductsDoNotFollowTheCachesOfThisCpu) {
  FixNumericsOfProcess();
  const Hash fixed = NumericSelfTest();
  Eigen::setCpuCacheSizes(1024, 4096, 8192);
  const Hash tiny = NumericSelfTest();
  FixNumericsOfProcess();
  EXPECT_NE(fixed, tiny) << "the product is too small to notice the caches: this test looks at nothing";
  EXPECT_EQ(NumericSelfTest(), fixed);
}

}  // namespace
}  // namespace cairn
