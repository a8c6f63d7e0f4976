// Real logs whose landmarks have no identity, against what was measured of them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "datasets/evaluate/evaluate.h"
#include "datasets/import/recorded/mrclam.h"
#include "datasets/import/recorded/recorded.h"
#include "pipelines/registry.h"
#include "pipelines/testing/in_process.h"
#include "tests/bench/stage_option.h"

namespace cairn {
namespace {

class RecordedWorlds : public testing::Test {
 protected:
  std::string folder_;
  void SetUp() override {
    const char* folder = std::getenv("CAIRN_DATA");
    if (folder == nullptr) GTEST_SKIP() << "CAIRN_DATA is not set (docs/datasets.md)";
    folder_ = folder;
  }
};

datasets::Evaluation ScoreOf(const Blob& log) {
  proto::Stage stage;
  stage.set_name("landmarks");
  stage.set_pipeline("landmark_map");
  SetOption("starts=1", &stage);  // to be quick
  return datasets::Evaluate(
      *RunInProcess(*MakePipeline(stage, 1), {{"log", std::make_shared<const Blob>(log.Without("truth/"))}}),
      log);
}

// Five robots, fifteen landmarks, in groups of two and three that are 0.18 m apart.
TEST_F(RecordedWorlds, Mrclam6WithItsIdentitiesWithheld) {
  datasets::MrclamImportOptions options;
  options.folder = folder_ + "/mrclam6";
  options.withhold_identities = true;
  Blob log;
  datasets::ImportMrclam(options, &log);
  const datasets::Evaluation score = ScoreOf(log);
  EXPECT_LE(score.landmarks->missed + score.landmarks->spurious, 1);
  EXPECT_GE(score.landmarks->found, 14);
  EXPECT_LE(score.landmarks->rmse_m.value(), 0.17);
  EXPECT_LE(score.trajectory_rmse_m.value(), 0.4) << "good landmarks may hide a wrong path";
}

TEST_F(RecordedWorlds, TheLegoRobotsPolesAndPath) {
  datasets::RecordedImportOptions options;
  options.folder = folder_ + "/lego-robot";
  Blob log;
  datasets::ImportLegoRobot(options, &log);
  const datasets::Evaluation score = ScoreOf(log);
  EXPECT_EQ(score.landmarks->found, 6);
  EXPECT_LE(score.landmarks->rmse_m.value(), 0.08);
  EXPECT_LE(score.trajectory_rmse_m.value(), 0.12);
}

}  // namespace
}  // namespace cairn
