#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/testing.h"
#include "datasets/evaluate/testing/grid.h"
#include "datasets/evaluate/testing/localization.h"
#include "datasets/evaluate/testing/networks.h"
#include "datasets/evaluate/testing/perfect_result.h"
#include "datasets/simulate/hall/hall.h"
#include "datasets/simulate/loop.h"
#include "datasets/testing.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {
namespace {

using datasets::ExpectContains;

// What `cairn evaluate …` says in a folder with networks, samples and a log.
class EvaluateCommand : public testing::Test {
 protected:
  EvaluateCommand() {
    Write("networks.h5", "networks", datasets::NetworksFile({{}}, {0, 1}, {0.9F, 0.2F}));
    Write("samples.h5", "samples", datasets::SamplesFile({{"a", {0, 1}, {5, 6}}, {"b", {0.5}, {5}}}));
  }

  void Write(const std::string& name, const std::string& kind, const Blob& blob) const {
    const Status status = WriteBlobFile(folder_ / name, kind, blob);
    ASSERT_TRUE(status.ok()) << status.message();
  }

  static Said Evaluate(std::vector<std::string> words) {
    words.insert(words.begin(), "evaluate");
    return Cairn(std::move(words));
  }

  void Refuses(const std::vector<std::string>& words, const std::string& complaint) const {
    const Said said = Evaluate(words);
    EXPECT_EQ(said.code, kExitBadInput);
    EXPECT_EQ(said.out, "");
    ExpectContains(said.complaint, complaint);
  }

  datasets::TestFolder folder_;
  std::string networks_ = folder_ / "networks.h5", samples_ = folder_ / "samples.h5";
};

TEST_F(EvaluateCommand, ScoresNetworksOnSamples) {
  const Said said = Evaluate({networks_, "--truth", samples_, "--json", "--nearest", "1"});
  ASSERT_EQ(said.code, kExitDone) << said.complaint;
  const auto json = nlohmann::json::parse(said.out);
  EXPECT_EQ(json["nearest"], 1);
  EXPECT_EQ(json["windows"].size(), 7U);
  EXPECT_DOUBLE_EQ(json["windows"][6]["prior_error_m"], 0.5);
  EXPECT_EQ(json["windows"][6]["error_reduction_95"].size(), 2U);
  const Said text = Evaluate({networks_, "--truth", samples_, "--nearest", "1"});
  EXPECT_EQ(text.code, kExitDone);
  ExpectContains(text.out, "global");
  ExpectContains(text.out, "bootstrap over 2 runs");
}

TEST_F(EvaluateCommand, FindsTheNetworksInAFolder) {
  ASSERT_TRUE(std::filesystem::create_directory(folder_ / "run"));
  std::filesystem::rename(networks_, folder_ / "run/networks.h5");
  EXPECT_EQ(Evaluate({folder_ / "run", "--truth", samples_, "--nearest", "2"}).code, kExitDone);
}

TEST_F(EvaluateCommand, ScoresALocalizationOnItsSamples) {
  ASSERT_TRUE(std::filesystem::create_directory(folder_ / "run"));
  Write("run/localization.h5", "localization", datasets::LocalizationFile());
  Write("localized.h5", "samples", datasets::LocalizedSamples());
  for (const std::string& result : {folder_ / "run", folder_ / "run/localization.h5"}) {
    const Said said = Evaluate({result, "--truth", folder_ / "localized.h5", "--json"});
    ASSERT_EQ(said.code, kExitDone) << said.complaint;
    EXPECT_EQ(nlohmann::json::parse(said.out)["rows"].size(), 3U);
  }
  Refuses({folder_ / "run", "--truth", samples_}, "made from other samples");
  Refuses({folder_ / "run", "--truth", folder_ / "localized.h5", "--seed", "2"}, "are for networks");
}

TEST_F(EvaluateCommand, ScoresAGridMapOnItsLogAndAgainstAnother) {
  ASSERT_TRUE(std::filesystem::create_directory(folder_ / "run"));
  Write("run/grid.h5", "grid_map", datasets::DrawnMap({"...", ".#.", "..."}));
  Write("reference.h5", "grid_map", datasets::DrawnMap({"...", "...", "..#"}));
  Write("log.h5", "log", datasets::SimulateHallway({.door_readings = 1, .closed = false, .seed = 1}));
  const Said said = Evaluate({folder_ / "run", "--truth", folder_ / "reference.h5", "--json"});
  ASSERT_EQ(said.code, kExitDone) << said.complaint;
  EXPECT_EQ(nlohmann::json::parse(said.out)["cells"]["due"], 1);
  Refuses({folder_ / "run", "--truth", folder_ / "log.h5"}, "at which poses");
  Refuses({folder_ / "run", "--truth", folder_ / "reference.h5", "--nearest", "3"}, "are for networks");
}

TEST_F(EvaluateCommand, WarnsOfTwoMapsThatWereMadeFromTwoLogs) {
  const auto map_of = [](const char* log) {
    Blob map = datasets::DrawnMap({"...", ".#.", "..."});
    map.Put("log_hash", Array::Text(log));
    return map;
  };
  Write("map.h5", "grid_map", map_of("0123"));
  Write("same.h5", "grid_map", map_of("0123"));
  Write("other.h5", "grid_map", map_of("4567"));
  Write("older.h5", "grid_map", map_of("0123").Without("log_hash"));
  for (const char* fitting : {"same.h5", "older.h5"})
    EXPECT_EQ(Evaluate({folder_ / "map.h5", "--truth", folder_ / fitting}).complaint, "") << fitting;
  const Said said = Evaluate({folder_ / "map.h5", "--truth", folder_ / "other.h5"});
  EXPECT_EQ(said.code, kExitDone);
  ExpectContains(said.complaint, "other.h5 were made from two logs: they are compared as if of one place");
}

TEST_F(EvaluateCommand, RefusesWhatDoesNotBelongTogether) {
  const std::string log = folder_ / "log.h5";
  Write("log.h5", "log", datasets::SimulateLoop({.seed = 3}));
  Refuses({networks_, "--truth", log},
          "networks.h5: networks, where landmark_map, grid_map, local_map can be held against a log");
  Refuses({log, "--truth", samples_},
          "log.h5: a log, where networks, localization can be held against samples");
  Refuses({networks_, "--truth", networks_}, "networks, where a log, samples or a grid_map are needed");
  Write("map.h5", "landmark_map", datasets::PerfectLandmarkMap(datasets::SimulateLoop({.seed = 3})));
  Refuses({folder_ / "map.h5", "--truth", log, "--nearest", "3"},
          "--nearest, --seed and --heading-window-deg are for networks");
  Refuses({networks_, "--truth", samples_}, "nearest: 5; allowed: from 1 to 2");
  Refuses({networks_, "--truth", samples_, "--seed", "-1"}, "seed");
}

// Two runs that see the same two places, and a light at one of them.
Blob WithLights() {
  Blob file = datasets::SamplesFile({{"a", {0, 1}, {5, 6}}, {"b", {0, 1}, {5, 6}}});
  file.Put("feature_name", Array::Texts({"light", "detected"}));
  for (const char* run : {"run/0/feature", "run/1/feature"})
    file.Put(run, Array::Of<float>({2, 2}, std::vector<float>{0, 0, 1, 1}));
  return file;
}

TEST_F(EvaluateCommand, TakesThePointThatTheTruthIsOf) {
  Blob log = datasets::SimulateLoop({.seed = 3});
  const Blob map = datasets::PerfectLandmarkMap(log);
  Write("log.h5", "log", log);
  Write("map.h5", "landmark_map", map);
  const std::string map_file = folder_ / "map.h5", log_file = folder_ / "log.h5";
  EXPECT_EQ(Evaluate({map_file, "--truth", log_file, "--reference-point", "0.1,0"}).code, kExitDone);
  Refuses({map_file, "--truth", log_file, "--reference-point", "0.1"}, "'estimate', or X,Y");
  const Said estimated = Evaluate({map_file, "--truth", log_file, "--reference-point", "estimate"});
  ExpectContains(estimated.out, "calibration.reference.scale     1.0000");
  for (const char* name : {"time_s", "x_m", "y_m", "heading_rad"})
    log.PutVector("truth/robot/0/poses/" + std::string(name), std::vector<double>{0});
  Write("log.h5", "log", log);
  Refuses({map_file, "--truth", log_file, "--reference-point", "estimate"}, "do not tell of which point");
  Refuses({networks_, "--truth", samples_, "--reference-point", "estimate"}, "of a landmark_map");
}

TEST_F(EvaluateCommand, ScoresHandMadeFeatures) {
  Write("lights.h5", "samples", WithLights());
  const std::string lights = folder_ / "lights.h5";
  const Said said = Evaluate({lights, "--feature", "light", "--json", "--nearest", "1"});
  ASSERT_EQ(said.code, kExitDone) << said.complaint;
  const auto json = nlohmann::json::parse(said.out);
  EXPECT_DOUBLE_EQ(json["windows"][6]["error_reduction"], 1);
  EXPECT_EQ(json["in_turn"], true);
  EXPECT_FALSE(json.contains("detection"));
  const Said held_out =
      Evaluate({lights, "--feature", "detected", "--holdout", "b", "--nearest", "1", "--against", "light"});
  ASSERT_EQ(held_out.code, kExitDone) << held_out.complaint;
  ExpectContains(held_out.out, "name  samples\n  b     2\n");
  ExpectContains(held_out.out, "detection.recall                100.0%, of 4 samples");
}

TEST_F(EvaluateCommand, RefusesFeaturesThatAreNotThere) {
  Write("lights.h5", "samples", WithLights());
  const std::string lights = folder_ / "lights.h5";
  Refuses({lights, "--feature", "door", "--nearest", "1"},
          "lights.h5: no feature 'door'; there are 'light', 'detected'");
  Refuses({samples_, "--feature", "door"}, "samples.h5: there are no hand-made features");
  Refuses({networks_, "--feature", "light"}, "networks, where samples are needed");
  Refuses({lights, "--feature", "light", "--truth", lights, "--nearest", "1"}, "none is held out");
  Refuses({lights, "--feature", "light", "--truth", lights, "--holdout", "b"}, "one will do");
  Refuses({lights, "--feature", "light", "--holdout", "z", "--nearest", "1"}, "no run 'z'");
  Refuses({lights, "--feature", "light"}, "nearest: 5; allowed: from 1 to 2");
  Refuses({networks_, "--truth", samples_, "--holdout", "b"}, "name one by --feature");
  Refuses({lights}, "--truth is needed");
}

TEST_F(EvaluateCommand, NamesTheFileThatIsBad) {
  Write("empty.h5", "samples", datasets::SamplesFile({}));
  Refuses({networks_, "--truth", folder_ / "empty.h5", "--nearest", "1"}, "empty.h5: there are no samples");
  Blob bad = datasets::NetworksFile({{}}, {0, 1}, {0.9F, 0.2F});
  bad.PutVector("networks/output_bias", std::vector<double>{0, 0});
  Write("bad.h5", "networks", bad);
  Refuses({folder_ / "bad.h5", "--truth", samples_}, "bad.h5: 'networks/output_bias' has the shape [2]");
  Blob backwards = datasets::SamplesFile({{"a", {0, 1}, {5, 6}}, {"b", {0.5}, {5}}});
  backwards.PutVector<double>("run/0/time_s", {1, 0});
  Write("backwards.h5", "samples", backwards);
  Refuses({networks_, "--truth", folder_ / "backwards.h5"},
          "backwards.h5: 'run/0/time_s', entry 1: 0 after 1");
}

}  // namespace
}  // namespace cairn::cli
