// Logs that no map explains end with the reason, not with a map.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/simulate/loop.h"
#include "pipelines/registry.h"
#include "pipelines/testing/in_process.h"
#include "schema/error.h"

namespace cairn {
namespace {

Blob WorldOf(std::uint64_t seed, const std::string& sensor, bool identities) {
  datasets::SimulateLoopOptions options;
  options.difficulty = "base";
  options.seed = seed;
  options.sensing.sensor = sensor;
  options.sensing.identities = identities;
  return datasets::SimulateLoop(options).Without("truth/");
}

std::string ReasonOf(const Blob& log) {
  proto::Stage stage;
  stage.set_name("landmarks");
  stage.set_pipeline("landmark_map");
  try {
    RunInProcess(*MakePipeline(stage, 1), {{"log", std::make_shared<const Blob>(log)}});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ContradictoryWorlds, IdentitiesSwappedHalfWayAreRefused) {
  Blob log = WorldOf(3, "range-bearing", true);
  EXPECT_EQ(ReasonOf(log), "");
  const auto named = log.Get<std::int32_t>("robot/0/observations/landmark");
  std::vector<std::int32_t> swapped(named.begin(), named.end());
  const auto names = static_cast<std::int32_t>(log.Texts("landmarks").size());
  for (std::size_t i = swapped.size() / 2; i < swapped.size(); ++i) {
    if ((swapped[i] ^ 1) < names) swapped[i] ^= 1;
  }
  log.PutVector("robot/0/observations/landmark", swapped);
  const std::string reason = ReasonOf(log);
  EXPECT_NE(reason.find("stands in two places"), std::string::npos) << reason;
}

// Any junction may be any other, so that the second robot finds a place for its first contact detection.
TEST(ContradictoryWorlds, ARobotOfAnotherWorldIsRefused) {
  const Blob one = WorldOf(1, "contact", false);
  for (const std::uint64_t seed : {2, 3}) {
    Blob log = one;
    log.Put("robots", Array::Texts({"one", "stranger"}));
    log.PutAll("robot/1/", WorldOf(seed, "contact", false).Sub("robot/0/"));
    const std::string reason = ReasonOf(log);
    EXPECT_NE(reason.find("was one of them somewhere else?"), std::string::npos) << reason;
  }
}

}  // namespace
}  // namespace cairn
