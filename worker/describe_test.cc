#include "worker/describe.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "worker/testing/toy_pipeline.h"

namespace cairn::worker {
namespace {

TEST(Describe, NamesInputsAndOptionsWithTheirRanges) {
  PipelineInfo info = testing::ToyInfo();
  info.inputs = {"log", "poses?"};
  const nlohmann::json json = nlohmann::json::parse(DescribePipelines({info}));
  ASSERT_EQ(json["pipelines"].size(), 1u);
  const nlohmann::json& toy = json["pipelines"][0];
  EXPECT_EQ(toy["name"], "toy");
  EXPECT_EQ(toy["inputs"], (std::vector<std::string>{"log", "poses?"}));
  ASSERT_EQ(toy["options"].size(), info.options.size());
  EXPECT_EQ(toy["options"][0]["name"], "rounds");
  EXPECT_EQ(toy["options"][0]["type"], "integer");
  EXPECT_EQ(toy["options"][0]["default"], 3);
  EXPECT_EQ(toy["options"][0]["low"], 1);
}

TEST(Describe, NothingRegisteredIsAnEmptyList) {
  EXPECT_TRUE(nlohmann::json::parse(DescribePipelines({}))["pipelines"].empty());
}

}  // namespace
}  // namespace cairn::worker
