#include "datasets/verdicts/networks_verdict.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace cairn::datasets {
namespace {

Blob TrainedNetworks(const std::vector<double>& training, const std::vector<double>& held_out) {
  Blob result;
  result.PutVector("history/training_error_m", training);
  result.PutVector("history/validation_error_m", held_out);
  result.PutScalar<double>("prior_error_m", 10);
  result.PutScalar<double>("validation_prior_error_m", std::isnan(held_out[0]) ? NAN : 8);
  return result;
}

TEST(NetworksVerdict, IsByTheRunThatWasHeldOut) {
  Verdict verdict = NetworksVerdict(TrainedNetworks({9, 6, 5}, {8, 6, 7}));
  EXPECT_EQ(verdict.trust, Confidence::kFair);
  EXPECT_EQ(verdict.numbers[0].second, 0.25);
  EXPECT_EQ(verdict.numbers[1].second, 0.4);
  EXPECT_EQ(verdict.why.find("on the run that was held out they take 25.0% off"), 0U) << verdict.why;
  EXPECT_EQ(NetworksVerdict(TrainedNetworks({9, 3, 2}, {8, 6, 7})).trust, Confidence::kLow);
  verdict = NetworksVerdict(TrainedNetworks({9, 6}, {8, 9}));
  EXPECT_EQ(verdict.trust, Confidence::kLow);
  EXPECT_NE(verdict.why.find("a detector that always says the same"), std::string::npos) << verdict.why;
  verdict = NetworksVerdict(TrainedNetworks({10, 9.99}, {8, 7.99}));
  EXPECT_EQ(verdict.trust, Confidence::kLow) << "half of nothing is nothing";
  verdict = NetworksVerdict(TrainedNetworks({9, 6}, {NAN, NAN}));
  EXPECT_EQ(verdict.trust, Confidence::kNone);
  EXPECT_NE(verdict.why.find("no run was held out"), std::string::npos) << verdict.why;
}

TEST(NetworksVerdict, IsLowWhereAnInputTellsTheTime) {
  Blob result = TrainedNetworks({9, 6, 5}, {8, 6, 7});
  result.Put("input_doubts", Array::Texts({"input 'seq' only grows"}));
  const Verdict verdict = NetworksVerdict(result);
  EXPECT_EQ(verdict.trust, Confidence::kLow);
  EXPECT_NE(verdict.why.find("input 'seq' only grows"), std::string::npos) << verdict.why;
}

TEST(NetworksVerdict, IsLowWhereWhatIsHeldOutHadBeenTrainedOn) {
  Blob result = TrainedNetworks({9, 6, 5}, {8, 6, 7});
  result.PutScalar<double>("held_out/known_share", 0.5);
  const Verdict verdict = NetworksVerdict(result);
  EXPECT_EQ(verdict.trust, Confidence::kLow);
  EXPECT_NE(verdict.why.find("50% of the samples that were held out"), std::string::npos) << verdict.why;
}

TEST(NetworksVerdict, IsLowWhereWhatIsHeldOutAgreesWithTheMapByChance) {
  Blob result = TrainedNetworks({9, 6, 5}, {8, 6, 7});
  result.PutScalar<double>("held_out/agreement_sigmas", 2.1);
  EXPECT_EQ(NetworksVerdict(result).trust, Confidence::kFair);
  result.PutScalar<double>("held_out/agreement_sigmas", 1.9);
  const Verdict verdict = NetworksVerdict(result);
  EXPECT_EQ(verdict.trust, Confidence::kLow);
  EXPECT_NE(verdict.why.find("by 1.9 standard deviations of chance"), std::string::npos) << verdict.why;
}

TEST(NetworksVerdict, IsLowWhereWhatIsHeldOutIsACopyButForRounding) {
  Blob result = TrainedNetworks({9, 6, 5}, {8, 6, 7});
  result.PutScalar<double>("held_out/same_share", 0.1);
  EXPECT_EQ(NetworksVerdict(result).trust, Confidence::kFair);
  result.PutScalar<double>("held_out/same_share", 0.97);
  const Verdict verdict = NetworksVerdict(result);
  EXPECT_EQ(verdict.trust, Confidence::kLow);
  EXPECT_NE(verdict.why.find("97% of the samples that were held out are, but for rounding"),
            std::string::npos)
      << verdict.why;
}

TEST(NetworksVerdict, IsNotKnownWhereFewOfTheSamplesThatAreHeldOutAreInReach) {
  Blob result = TrainedNetworks({9, 6, 5}, {8, 6, 7});
  result.PutScalar<std::int64_t>("held_out/samples", 120);
  result.PutScalar<std::int64_t>("held_out/in_reach", 5);
  const Verdict verdict = NetworksVerdict(result);
  EXPECT_EQ(verdict.trust, Confidence::kNone);
  EXPECT_NE(verdict.why.find("of the 120 samples that were held out of their training 5"), std::string::npos)
      << verdict.why;
}

TEST(NetworksVerdict, IsNotKnownWhereFewSamplesAreHeldOut) {
  Blob result = TrainedNetworks({9, 6, 5}, {8, 6, 7});
  result.PutScalar<std::int64_t>("held_out/samples", 3);
  const Verdict verdict = NetworksVerdict(result);
  EXPECT_EQ(verdict.trust, Confidence::kNone);
  EXPECT_NE(verdict.why.find("3 samples were held out"), std::string::npos) << verdict.why;
}

}  // namespace
}  // namespace cairn::datasets
