#include "pipelines/landmark_learning/networks/arrays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "schema/kinds/kind.h"

namespace cairn::landmark_learning {
namespace {

Parameters<float> SomeParameters(const NetworkShape& shape) {
  Rng rng(5);
  return RandomParameters<float>(shape, 1.0, rng);
}

using FileWeights = kinds::Networks::Weights;

Blob FileOf(const FileWeights& weights) {
  Blob file;
  PutFields("networks/", weights, &file);
  return file;
}

std::string NetworkArraysComplaint(const Blob& file) {
  try {
    CheckKind(file, "networks");
    NetworksIn(FieldsIn<FileWeights>("networks/", file));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(NetworkArrays, ComeBackAsTheyWere) {
  for (const int hidden_2 : {0, 5}) {
    const auto parameters = SomeParameters({.networks = 2, .inputs = 3, .hidden = 4, .hidden_2 = hidden_2});
    const FileWeights file = WeightsOf(parameters);
    const auto back = NetworksIn(file);
    EXPECT_TRUE(back.shape == parameters.shape) << hidden_2;
    EXPECT_TRUE(std::ranges::equal(back.values, parameters.values)) << hidden_2;
    EXPECT_EQ(static_cast<bool>(file.hidden_2_weight), hidden_2 > 0);
  }
}

// [networks][units][what they see], each network's units together.
TEST(NetworkArrays, AreWhatTheFormatSays) {
  Parameters<float> p({.networks = 2, .inputs = 1, .hidden = 2, .hidden_2 = 2});
  for (std::size_t i = 0; i < p.values.size(); ++i) p.values[i] = static_cast<float>(i);
  const Blob file = FileOf(WeightsOf(p));
  EXPECT_EQ(file.at("networks/hidden_2_weight").shape(), (Shape{2, 2, 2}));
  const auto second = file.Get<double>("networks/hidden_2_weight");
  // The parameters have, from 8 on, of network 0 the weights of unit 0 of the first layer to both of the
  // second, then those of its unit 1.
  const std::vector<double> expected{8, 10, 9, 11, 12, 14, 13, 15};
  EXPECT_TRUE(std::ranges::equal(second, expected));
  EXPECT_EQ(file.at("networks/output_weight").shape(), (Shape{2, 2}));
  EXPECT_EQ(file.Get<double>("networks/output_bias")[1], 25.0);
}

TEST(NetworkArrays, OfShapesThatDoNotFitAreRefusedByName) {
  FileWeights weights = WeightsOf(SomeParameters({.networks = 2, .inputs = 3, .hidden = 4, .hidden_2 = 5}));
  weights.input_mean = std::vector<double>{0, 0, 0};
  weights.input_scale = std::vector<double>{1, 1, 1};
  weights.input_name = std::vector<std::string>{"a", "b", "c"};
  const Blob file = FileOf(weights);
  EXPECT_EQ(NetworkArraysComplaint(file), "");
  const auto with = [&](const char* name, const Shape& shape) {
    std::int64_t count = 1;
    for (const std::int64_t length : shape) count *= length;
    Blob torn = file;
    torn.Put(name, Array::Of<double>(shape, std::vector<double>(static_cast<std::size_t>(count), 0.5)));
    return NetworkArraysComplaint(torn);
  };
  EXPECT_EQ(with("networks/hidden_weight", {8, 3}),
            "'networks/hidden_weight' has the shape [8,3], where [n,H,I] is needed");
  EXPECT_EQ(with("networks/hidden_2_weight", {2, 20}),
            "'networks/hidden_2_weight' has the shape [2,20], where [n,H2,H] is needed");
  EXPECT_EQ(with("networks/hidden_2_weight", {2, 0, 4}),
            "'networks/hidden_2_bias' has the shape [2,5], where [n,H2] is needed: H2 is 0 by "
            "'networks/hidden_2_weight'");
  EXPECT_EQ(with("networks/hidden_2_weight", {2, 5, 3}),
            "'networks/hidden_2_weight' has the shape [2,5,3], where [n,H2,H] is needed: H is 4 by "
            "'networks/hidden_weight'");
  EXPECT_EQ(with("networks/output_weight", {2, 4}),
            "'networks/output_weight' is not of as many units as the last hidden layer has");
  FileWeights none = weights;
  none.hidden_weight = {{0, 4, 3}, {}};
  EXPECT_THROW(NetworksIn(none), InputError);
  EXPECT_NE(NetworkArraysComplaint(file.Without("networks/hidden_2_bias")).find("networks/hidden_2_bias"),
            std::string::npos);
}

}  // namespace
}  // namespace cairn::landmark_learning
