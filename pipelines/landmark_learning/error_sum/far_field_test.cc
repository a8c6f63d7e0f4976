#include "pipelines/landmark_learning/error_sum/far_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "schema/rng.h"

namespace cairn::landmark_learning {
namespace {

// Positions of a box of side 1: on a lattice with the corners, where a series is worst, and anywhere.
struct InBox {
  std::vector<double> u, v, terms;  // terms: [kTerms][positions]

  explicit InBox(std::uint64_t seed) {
    Rng rng(seed);
    for (int i = 0; i <= 8; ++i) {
      for (int j = 0; j <= 8; ++j) {
        u.push_back(i / 4.0 - 1.0);
        v.push_back(j / 4.0 - 1.0);
      }
    }
    for (int i = 0; i < 119; ++i) {
      u.push_back(rng.Uniform(-1.0, 1.0));
      v.push_back(rng.Uniform(-1.0, 1.0));
    }
    terms.resize(kTerms * u.size());
    FillTerms(count(), u.data(), v.data(), count(), terms.data());
  }
  int count() const { return static_cast<int>(u.size()); }
};

// Distances of all pairs of positions in two boxes, by the series: each of the source's positions a feature.
TEST(FarField, IsWithinItsBoundForEveryOffsetThatIsNotNear) {
  const InBox target(1), source(2);
  const auto count = static_cast<std::size_t>(target.count());
  ASSERT_EQ(count % 4, 0U);
  double worst = 0.0;
  int offsets = 0;
  for (int dx = -kFarthest; dx <= kFarthest; ++dx) {
    for (int dy = -kFarthest; dy <= kFarthest; ++dy) {
      if (IsNear(dx, dy)) continue;
      ++offsets;
      std::vector<double> local(kTerms * count, 0.0), distance(count * count, 0.0);
      const FarField<double>& field = FarField<double>::Get();
      field.Meet({field.MeetingAt(dx, dy, source.terms.data())}, 1.0, target.count(), local.data());
      AddTransposed<double>({kTerms, target.count(), target.count(), target.terms.data()}, target.count(),
                            local.data(), distance.data());
      for (std::size_t a = 0; a < count; ++a) {
        for (std::size_t k = 0; k < count; ++k) {
          const double expected =
              std::hypot(dx + (source.u[k] - target.u[a]) / 2, dy + (source.v[k] - target.v[a]) / 2);
          worst = std::max(worst, std::abs(distance[a * count + k] / expected - 1.0));
        }
      }
    }
  }
  EXPECT_EQ(offsets, 100);
  EXPECT_LT(worst, kFarBound);
  EXPECT_GT(worst, 0.3 * kFarBound);  // the bound says what it costs
}

// A parent's polynomials are exactly sums of its children's.
TEST(FarField, AParentsTermsAreItsChildrens) {
  const InBox child(3);
  const auto count = static_cast<std::size_t>(child.count());
  for (int which = 0; which < 4; ++which) {
    std::vector<double> u, v, direct(kTerms * count), sums(kTerms * count, 0.0);
    for (std::size_t k = 0; k < count; ++k) {
      u.push_back((child.u[k] + ((which & 1) != 0 ? 1 : -1)) / 2);
      v.push_back((child.v[k] + ((which & 2) != 0 ? 1 : -1)) / 2);
    }
    FillTerms(child.count(), u.data(), v.data(), child.count(), direct.data());
    AddProduct(FarField<double>::Get().ChildOf(which & 1, which >> 1), child.count(), child.terms.data(),
               sums.data());
    for (std::size_t i = 0; i < direct.size(); ++i) EXPECT_NEAR(sums[i], direct[i], 1e-13) << which;
  }
}

}  // namespace
}  // namespace cairn::landmark_learning
