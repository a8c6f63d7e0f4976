#include "pipelines/landmark_learning/data/ancestry.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>

#include "pipelines/landmark_learning/landmark_learning.h"
#include "pipelines/landmark_learning/testing.h"
#include "pipelines/testing/in_process.h"

namespace cairn::landmark_learning {
namespace {

const Options kFew{.networks = 2, .rate = 0.02, .init_width = 0.5, .steps = 60};

BlobPtr Learn(const Blob& samples, const Options& options, const BlobPtr& parent) {
  std::map<std::string, BlobPtr> inputs{{"samples", std::make_shared<const Blob>(samples)}};
  if (parent) inputs["weights"] = parent;
  return RunInProcess(LandmarkLearning(options, 7), inputs);
}

std::string AncestryComplaint(const Options& options, const Blob& parent,
                              const Blob& samples = CorridorSamples().Make()) {
  try {
    Learn(samples, options, std::make_shared<const Blob>(parent));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

class Ancestry : public ::testing::Test {
 protected:
  const Blob samples_ = CorridorSamples().Make();
  const BlobPtr parent_ = Learn(samples_, kFew, nullptr);
};

TEST_F(Ancestry, AFinishedRunGoesOnWhereItEnded) {
  const BlobPtr child = Learn(samples_, kFew, parent_);
  const auto before = parent_->Get<double>("history/training_error_m"),
             after = child->Get<double>("history/training_error_m");
  EXPECT_NEAR(after.front(), before.back(), 1e-6 * before.back());
  EXPECT_LT(after.back(), before.back());
}

TEST_F(Ancestry, TwoHiddenLayersGoOnToo) {
  Options deep = kFew;
  deep.hidden_2 = 3;
  const BlobPtr parent = Learn(samples_, deep, nullptr), child = Learn(samples_, deep, parent);
  EXPECT_EQ(parent->at("networks/hidden_2_weight").shape(), (Shape{2, 3, 6}));
  const auto before = parent->Get<double>("history/training_error_m"),
             after = child->Get<double>("history/training_error_m");
  EXPECT_NEAR(after.front(), before.back(), 1e-6 * before.back());
  EXPECT_FALSE(child->at("networks/hidden_2_weight") == parent->at("networks/hidden_2_weight"));
  EXPECT_NE(AncestryComplaint(kFew, *parent).find("2 networks of 6 and 3 hidden units"), std::string::npos);
}

// Other runs, another window: the map is the new runs', the normalisation is still the first run's.
TEST_F(Ancestry, OtherDataAndAnotherWindowAreTakenAsTheyAre) {
  Options wide = kFew;
  wide.window_m = 8.0;
  wide.steps = 1;
  const BlobPtr child = Learn(CorridorSamples{.runs = 5, .seed = 9}.Make(), wide, parent_);
  EXPECT_EQ(child->Get<double>("map/x_m").size(), 400U);
  EXPECT_TRUE(child->at("networks/input_mean") == parent_->at("networks/input_mean"));
  EXPECT_TRUE(child->at("networks/input_scale") == parent_->at("networks/input_scale"));
  EXPECT_TRUE(child->at("networks/hidden_weight") == parent_->at("networks/hidden_weight"));
  EXPECT_GT(child->Scalar<double>("prior_error_m"), parent_->Scalar<double>("prior_error_m"));
}

TEST_F(Ancestry, IsRecordedFromTheFirstRunOn) {
  EXPECT_FALSE(parent_->Has("ancestry/hash"));
  Options slower = kFew;
  slower.rate = 0.01;
  slower.steps = 5;
  Blob published = *parent_;
  published.PutScalar("provenance/seconds_s", 3.0);  // of no account
  const BlobPtr child = Learn(samples_, slower, std::make_shared<const Blob>(published));
  const BlobPtr grandchild = Learn(samples_, kFew, child);
  const auto hashes = grandchild->Texts("ancestry/hash"), options = grandchild->Texts("ancestry/options");
  ASSERT_EQ(hashes.size(), 2U);
  EXPECT_EQ(hashes[0], parent_->ContentHash().Hex());
  EXPECT_EQ(hashes[1], child->ContentHash().Hex());
  EXPECT_NE(options[0].find(" rate=0.02 "), std::string::npos) << options[0];
  EXPECT_NE(options[1].find(" rate=0.01 "), std::string::npos) << options[1];
  EXPECT_EQ(grandchild->Get<std::int64_t>("ancestry/steps")[0], 60);
  EXPECT_EQ(grandchild->Get<std::int64_t>("ancestry/steps")[1], 5);
  EXPECT_EQ(grandchild->Get<double>("ancestry/training_error_m")[0],
            parent_->Get<double>("history/training_error_m").back());
}

// In whichever generation, and whatever a run is called there.
TEST_F(Ancestry, WhatIsHeldOutIsKnownWhereNetworksBeforeHadLearnedFromIt) {
  Options held_out = kFew;
  held_out.steps = 5;
  held_out.unseen = "run 2";
  const BlobPtr unrelated = Learn(CorridorSamples{.seed = 9}.Make(), held_out, nullptr);
  const BlobPtr first = Learn(samples_, held_out, nullptr);
  held_out.unseen = "";
  Blob renamed = samples_;
  renamed.Put("runs", Array::Texts({"x", "y", "z"}));
  held_out.holdout = "x";
  EXPECT_FALSE(Learn(renamed, held_out, nullptr)->Has("held_out/known_share"));
  EXPECT_FALSE(Learn(renamed, held_out, unrelated)->Has("held_out/known_share"));
  const BlobPtr second = Learn(renamed, held_out, first);
  EXPECT_EQ(second->Scalar<double>("held_out/known_share"), 1);
  held_out.holdout = "z";
  EXPECT_FALSE(Learn(renamed, held_out, first)->Has("held_out/known_share")) << "it was unseen";
  EXPECT_EQ(Learn(renamed, held_out, second)->Scalar<double>("held_out/known_share"), 1);
}

TEST_F(Ancestry, WeightsOfAnotherShapeAreRefused) {
  Options other = kFew;
  other.networks = 3;
  EXPECT_EQ(AncestryComplaint(other, *parent_),
            "the input 'weights': 2 networks of 6 hidden units over 5 inputs, where the options and the "
            "samples ask for "
            "3 networks of 6 hidden units over 5 inputs");
  other = kFew;
  other.hidden = 4;
  EXPECT_NE(AncestryComplaint(other, *parent_).find("ask for 2 networks of 4 hidden units"),
            std::string::npos);
  other = kFew;
  other.hidden_2 = 4;
  EXPECT_NE(AncestryComplaint(other, *parent_).find("ask for 2 networks of 6 and 4 hidden units"),
            std::string::npos);
  Blob renamed = samples_;
  renamed.Put("input_name", Array::Texts({"door", "lamp", "bin", "noise", "constant"}));
  EXPECT_EQ(AncestryComplaint(kFew, *parent_, renamed),
            "the input 'weights': its input 1 is 'light', not the samples' 'lamp'");
  EXPECT_NE(AncestryComplaint(kFew, samples_).find("no networks in it"), std::string::npos);
  Blob torn = *parent_;
  torn.PutVector<double>("networks/output_bias", {1.0});
  EXPECT_EQ(AncestryComplaint(kFew, torn),
            "input 'weights': 'networks/output_bias' has the shape [1], where [n] is needed: n is 2 by "
            "'networks/hidden_weight'");
  torn.PutVector<double>("networks/output_bias", {1.0, std::numeric_limits<double>::quiet_NaN()});
  EXPECT_EQ(AncestryComplaint(kFew, torn),
            "input 'weights': 'networks/output_bias', entry 1: nan, where a finite number is needed");
}

}  // namespace
}  // namespace cairn::landmark_learning
