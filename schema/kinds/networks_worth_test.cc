#include "schema/kinds/networks_worth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace cairn {
namespace {

TEST(NetworksWorth, IsThatOfTheStepWhoseWeightsAreKept) {
  kinds::Networks networks;
  networks.history.training_error_m = std::vector<double>{9, 6, 5};
  networks.history.validation_error_m = std::vector<double>{NAN, 6, 7};
  networks.prior_error_m = 10.0;
  networks.validation_prior_error_m = 8.0;
  networks.held_out.samples = std::int64_t{12};
  networks.input_doubts = std::vector<std::string>{"seq only grows"};
  const kinds::NetworksWorth worth = WorthOf(networks);
  EXPECT_EQ(worth.held_out_reduction.Scalar(), 0.25);
  EXPECT_EQ(worth.training_reduction.Scalar(), 0.4);
  EXPECT_EQ(worth.held_out.samples.Scalar(), 12);
  EXPECT_EQ(worth.input_doubts.values(), std::vector<std::string>{"seq only grows"});
}

TEST(NetworksWorth, IsNotKnownWhereNoRunWasHeldOut) {
  kinds::Networks networks;
  networks.history.training_error_m = std::vector<double>{9, 6};
  networks.history.validation_error_m = std::vector<double>{NAN, NAN};
  networks.prior_error_m = 10.0;
  networks.validation_prior_error_m = NAN;
  EXPECT_FALSE(WorthOf(networks).held_out_reduction);
  EXPECT_FALSE(WorthOf({}).held_out_reduction);
}

}  // namespace
}  // namespace cairn
