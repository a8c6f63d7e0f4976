#include "pipelines/landmark_learning/agreement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "schema/rng.h"

namespace cairn::landmark_learning {
namespace {

constexpr std::size_t kRows = 120, kColumns = 4;

std::vector<double> Walk(Rng& rng) {
  std::vector<double> walk(kRows * kColumns);
  for (std::size_t k = 0; k < walk.size(); ++k)
    walk[k] = (k < kColumns ? 0.0 : walk[k - kColumns]) + rng.Normal();
  return walk;
}

// Two random walks are alike in their longest waves half of the time, and then correlated by 0.9.
TEST(Agreement, OfRandomWalksIsOneStandardDeviation) {
  Rng rng(1);
  double squares = 0.0;
  int above_2 = 0;
  constexpr int kTrials = 400;
  for (int trial = 0; trial < kTrials; ++trial) {
    const double sigmas = AgreementSigmas(Walk(rng), Walk(rng), kColumns);
    squares += sigmas * sigmas;
    above_2 += sigmas > 2.0 ? 1 : 0;
  }
  EXPECT_NEAR(squares / kTrials, 1.0, 0.2);
  EXPECT_LT(above_2, 0.05 * kTrials);
}

TEST(Agreement, OfOneWaveIsOneWhateverItsSize) {
  std::vector<double> wave;
  for (std::size_t k = 0; k < kRows; ++k)
    wave.push_back(7 + 100 * std::cos(3.14159265358979 * 2 * (static_cast<double>(k) + 0.5) / kRows));
  EXPECT_NEAR(AgreementSigmas(wave, wave, 1), 1.0, 1e-4);
  std::vector<double> against;
  for (const double value : wave) against.push_back(-value);
  EXPECT_NEAR(AgreementSigmas(wave, against, 1), -1.0, 1e-4);
}

TEST(Agreement, CountsColumnsThatSayTheSameOnce) {
  Rng rng(3);
  const std::vector<double> all = Walk(rng);
  std::vector<double> one, twice;
  for (std::size_t k = 0; k < all.size(); k += kColumns) {
    one.push_back(all[k]);
    twice.insert(twice.end(), {all[k], 3 * all[k]});
  }
  EXPECT_NEAR(AgreementSigmas(twice, twice, 2), AgreementSigmas(one, one, 1), 1e-3);
}

TEST(Agreement, OfWhatIsTheSameButForNoiseIsMany) {
  Rng rng(2);
  const std::vector<double> one = Walk(rng);
  std::vector<double> other;
  for (const double value : one) other.push_back(value + rng.Normal());
  EXPECT_GT(AgreementSigmas(one, other, kColumns), 3.0);
  EXPECT_EQ(AgreementSigmas(std::vector<double>(kRows, 3.0), std::vector<double>(kRows, 0.7), 1), 0.0);
}

}  // namespace
}  // namespace cairn::landmark_learning
