#include "pipelines/landmark_learning/starts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pipelines/landmark_learning/landmark_learning.h"
#include "pipelines/landmark_learning/testing.h"
#include "pipelines/testing/in_process.h"

namespace cairn::landmark_learning {
namespace {

constexpr double kNothing = std::numeric_limits<double>::infinity();

BlobPtr Learn(const Options& options, int* rounds = nullptr) {
  return RunInProcess(LandmarkLearning(options, 7),
                      {{"samples", std::make_shared<const Blob>(CorridorSamples().Make())}},
                      [&](const proto::Step&) {
                        if (rounds != nullptr) ++*rounds;
                      });
}

std::string StartsComplaint(const Options& options) {
  try {
    Learn(options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Starts, AreScoredByTheLastStepsOrTheHeldOutRun) {
  std::vector<double> errors(30, 5.0);
  errors.resize(40, 3.0);
  EXPECT_EQ(ScoreOf(errors, kNothing), 4.0);
  EXPECT_EQ(ScoreOf({2.0, 4.0}, kNothing), 3.0);
  EXPECT_EQ(ScoreOf(errors, 7.0), 7.0);
}

TEST(Starts, TheBestGoesOn) {
  for (const char* method : {"adam", "pseudo"}) {
    Options options{
        .networks = 2, .method = method, .init_width = 2.0, .steps = 30, .starts = 4, .start_steps = 10};
    options.pattern_steps = 20;
    const BlobPtr result = Learn(options);
    const auto scores = result->Get<double>("starts/error_m");
    ASSERT_EQ(scores.size(), 4U) << method;
    const auto chosen = static_cast<std::size_t>(result->Scalar<std::int64_t>("starts/chosen"));
    for (const double score : scores) EXPECT_GE(score, scores[chosen]) << method;
    EXPECT_LT(scores[chosen], *std::ranges::max_element(scores)) << method;
    const auto errors = result->Get<double>("history/training_error_m");
    ASSERT_EQ(errors.size(), 30U) << method;
    EXPECT_NEAR(ScoreOf({errors.begin(), errors.begin() + 10}, kNothing), scores[chosen], 1e-12) << method;
  }
}

// The first of several is the start that there is alone, and goes on as it would: same steps, same bits.
TEST(Starts, GoOnAsTheyWouldAlone) {
  for (const char* holdout : {"", "run 1"}) {
    Options options{.networks = 2, .input_noise = 0.1, .steps = 30, .holdout = holdout, .validate_every = 3};
    options.starts = 2;
    options.start_steps = 7;
    bool found = false;
    for (const double width : {0.1, 0.3, 1.0, 3.0}) {  // until the first is the best
      options.init_width = width;
      int rounds = 0;
      const BlobPtr of_two = Learn(options, &rounds);
      EXPECT_EQ(rounds, 31);
      if (of_two->Scalar<std::int64_t>("starts/chosen") != 0) continue;
      options.starts = 1;
      const BlobPtr one = Learn(options);
      options.starts = 2;
      found = true;
      for (const char* name : {"networks/hidden_weight", "networks/output_bias", "history/training_error_m",
                               "history/validation_error_m"})
        EXPECT_TRUE(of_two->at(name) == one->at(name)) << name;
      EXPECT_FALSE(one->Has("starts/chosen"));
    }
    EXPECT_TRUE(found) << "the first start was never the best";
  }
}

TEST(Starts, AreRefusedWhereTheyMeanNothing) {
  EXPECT_EQ(StartsComplaint({.steps = 30, .starts = 2, .sequential = true}),
            "starts does not go with sequential, nor with method=conjugate");
  EXPECT_NE(StartsComplaint({.method = "conjugate", .steps = 30, .starts = 2}), "");
  EXPECT_EQ(StartsComplaint({.steps = 30, .starts = 2, .start_steps = 30}),
            "start_steps = 30: starts are compared before the last of all steps, of which there are 30");
  EXPECT_EQ(StartsComplaint({.steps = 1, .starts = 2}).substr(0, 15), "start_steps = 1");
}

}  // namespace
}  // namespace cairn::landmark_learning
