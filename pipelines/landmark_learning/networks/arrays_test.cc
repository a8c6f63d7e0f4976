#include "pipelines/landmark_learning/networks/arrays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace cairn::landmark_learning {
namespace {

Parameters<float> SomeParameters(const NetworkShape& shape) {
  Rng rng(5);
  return RandomParameters<float>(shape, 1.0, rng);
}

std::string NetworkArraysComplaint(const Blob& file) {
  try {
    NetworksIn(file);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(NetworkArrays, ComeBackAsTheyWere) {
  for (const int hidden_2 : {0, 5}) {
    const auto parameters = SomeParameters({.networks = 2, .inputs = 3, .hidden = 4, .hidden_2 = hidden_2});
    Blob file;
    PutNetworkArrays(parameters, &file);
    const auto back = NetworksIn(file);
    EXPECT_TRUE(back.shape == parameters.shape) << hidden_2;
    EXPECT_TRUE(std::ranges::equal(back.values, parameters.values)) << hidden_2;
    EXPECT_EQ(file.Has("networks/hidden_2_weight"), hidden_2 > 0);
  }
}

// [networks][units][what they see], each network's units together.
TEST(NetworkArrays, AreWhatTheFormatSays) {
  Parameters<float> p({.networks = 2, .inputs = 1, .hidden = 2, .hidden_2 = 2});
  for (std::size_t i = 0; i < p.values.size(); ++i) p.values[i] = static_cast<float>(i);
  Blob file;
  PutNetworkArrays(p, &file);
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
  Blob file;
  PutNetworkArrays(SomeParameters({.networks = 2, .inputs = 3, .hidden = 4, .hidden_2 = 5}), &file);
  const auto with = [&](const char* name, const Shape& shape) {
    std::int64_t count = 1;
    for (const std::int64_t length : shape) count *= length;
    Blob torn = file;
    torn.Put(name, Array::Of<double>(shape, std::vector<double>(static_cast<std::size_t>(count), 0.5)));
    return NetworkArraysComplaint(torn);
  };
  EXPECT_EQ(with("networks/hidden_weight", {8, 3}),
            "'networks/hidden_weight' is not [networks, hidden, inputs]");
  EXPECT_EQ(with("networks/hidden_2_weight", {2, 20}),
            "'networks/hidden_2_weight' is not [networks, hidden_2, hidden]");
  EXPECT_EQ(with("networks/hidden_2_weight", {2, 0, 4}),
            "'networks/hidden_2_weight' is not [networks, hidden_2, hidden]");
  EXPECT_EQ(with("networks/hidden_2_weight", {2, 5, 3}),
            "'networks/hidden_2_weight' does not have the other arrays' shape");
  EXPECT_EQ(with("networks/output_weight", {2, 4}),
            "'networks/output_weight' does not have the other arrays' shape");
  EXPECT_NE(NetworkArraysComplaint(file.Without("networks/hidden_2_bias")).find("networks/hidden_2_bias"),
            std::string::npos);
}

}  // namespace
}  // namespace cairn::landmark_learning
