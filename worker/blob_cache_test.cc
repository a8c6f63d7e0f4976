#include "worker/blob_cache.h"

#include <gtest/gtest.h>

namespace cairn::worker {
namespace {

// A blob of 8 * `doubles` bytes.
wire::NamedBlob BlobOf(int value, std::size_t doubles) {
  Blob blob;
  blob.PutVector<double>("v", std::vector<double>(doubles, value));
  return wire::NameBlob(std::make_shared<const Blob>(std::move(blob)));
}

// What a blob with the one array "v" takes beside that array's bytes.
constexpr std::size_t kBeside = BlobCache::kBlobBytes + BlobCache::kArrayBytes + 1;

TEST(BlobCache, GivesBackWhatItHolds) {
  BlobCache cache(1000);
  const wire::NamedBlob a = BlobOf(1, 10);
  EXPECT_EQ(cache.Get(a.hash), nullptr);
  cache.Put(a);
  EXPECT_EQ(cache.Get(a.hash), a.blob);
  EXPECT_EQ(cache.bytes(), 80 + kBeside);
}

TEST(BlobCache, TheLeastRecentlyUsedGoFirst) {
  BlobCache cache(240 + 3 * kBeside);
  const wire::NamedBlob a = BlobOf(1, 10), b = BlobOf(2, 10), c = BlobOf(3, 10), d = BlobOf(4, 40);
  for (const wire::NamedBlob& blob : {a, b, c}) cache.Put(blob);
  ASSERT_NE(cache.Get(a.hash), nullptr);
  cache.Put(d);
  EXPECT_NE(cache.Get(a.hash), nullptr);
  EXPECT_EQ(cache.Get(b.hash), nullptr);
  EXPECT_EQ(cache.Get(c.hash), nullptr);
  EXPECT_NE(cache.Get(d.hash), nullptr);
  EXPECT_EQ(cache.bytes(), 80 + 320 + 2 * kBeside);
}

TEST(BlobCache, NeverHoldsMoreThanItsCap) {
  BlobCache cache(3000);
  for (int i = 0; i < 200; ++i) {
    cache.Put(BlobOf(i, static_cast<std::size_t>(i % 37)));
    ASSERT_LE(cache.bytes(), 3000u);
  }
  EXPECT_GT(cache.size(), 1u);
  const std::size_t before = cache.size();
  cache.Put(BlobOf(1, 1000));
  EXPECT_EQ(cache.size(), before) << "a blob that can never fit pushes nothing out";
}

TEST(BlobCache, OfBlobsWithoutBytesItHoldsNoMoreThanItHasRoomFor) {
  BlobCache cache(10'000);
  for (int i = 0; i < 1000; ++i) {
    Blob blob;
    blob.PutVector<double>("name " + std::to_string(i), {});
    cache.Put(wire::NameBlob(std::make_shared<const Blob>(std::move(blob))));
  }
  EXPECT_GT(cache.size(), 1u);
  EXPECT_LT(cache.size(), 30u);
}

TEST(BlobCache, PuttingTwiceCountsOnce) {
  BlobCache cache(1000);
  cache.Put(BlobOf(1, 10));
  cache.Put(BlobOf(1, 10));
  EXPECT_EQ(cache.bytes(), 80 + kBeside);
  EXPECT_EQ(cache.size(), 1u);
}

}  // namespace
}  // namespace cairn::worker
