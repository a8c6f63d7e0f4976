#include "datasets/inspect/inspect.h"

#include <nlohmann/json.hpp>

#include "datasets/common/samples.h"
#include "datasets/evaluate/testing/grid.h"
#include "datasets/evaluate/testing/localization.h"
#include "datasets/simulate/loop.h"
#include "datasets/testing.h"
#include "datasets/testing_result.h"

namespace cairn::datasets {
namespace {

Inspection Inspected(const Blob& blob, const std::string& kind) {
  const TestFolder folder;
  EXPECT_TRUE(WriteBlobFile(folder / "a.h5", kind, blob).ok());
  return Inspect(folder / "a.h5").value();
}

TEST(Inspect, TellsOfGridMaps) {
  Blob map = DrawnMap({"#.. ", ".. #"}, 0.5, -1, 2);
  map.PutVector<double>("history/log_likelihood", {-9, -4});
  map.Put("robots", Array::Texts({"Rosa", "Ugo"}));
  for (const char* column : {"time_s", "x_m", "y_m", "heading_rad"})
    map.PutVector<double>(std::string("robot/0/sonar/") + column, {0, 1, 2.5});
  map.PutVector<std::uint8_t>("robot/0/sonar/held_out", {0, 1, 0});
  const std::string text = InspectText(Inspected(map, "grid_map"));
  ExpectContains(text, "  grid        4 by 2 cells of 0.5 m from (-1, 2) m; 2 occupied, 4 free\n");
  ExpectContains(text, "  iterations  2, log-likelihood -9 to -4\n");
  ExpectContains(text, "  robot Rosa  3 scans of sonar over 2.5 s, 1 of them held out\n");
  EXPECT_EQ(text.find("robot Ugo"), std::string::npos) << "nothing of it was used: " << text;
  EXPECT_EQ(text.find("0 poses"), std::string::npos) << text;
}

TEST(Inspect, CellsOfWhichNothingIsKnownAreNeitherOccupiedNorFree) {
  Blob map = DrawnMap({"##..", "#.##"});
  map.Put("map/grid/log_odds_difference", Array::Of<double>({2, 4}, {3, -2, 0.009, 0, 4, -0.005, -5, 0.01}));
  ExpectContains(InspectText(Inspected(map, "grid_map")), "; 2 occupied, 3 free\n");
}

TEST(Inspect, SaysOfEachResultHowFarItCanBeTrusted) {
  ExpectContains(InspectText(Inspected(DrawnMap({"##..", "#.##"}), "grid_map")), "  verdict  not known: ");
  ExpectContains(InspectText(Inspected(LocalizationFile(), "localization")), "  verdict");
  Blob networks;
  networks.Put("networks/hidden_weight", Array::Of<double>({1, 1, 1}, {1}));
  ExpectContains(InspectText(Inspected(networks, "networks")), "  verdict  not known: no run was held out");
}

TEST(Inspect, TellsWhatALogHolds) {
  const std::string text = InspectText(Inspected(SmallLog(), "log"));
  EXPECT_TRUE(text.starts_with("log, format 1, content " + SmallLog().ContentHash().Hex() + "\n")) << text;
  ExpectContains(text, "  robot Rosa  3 controls over 2 s, 3 m, 3 observations (1 at the robot)\n");
  ExpectContains(text, "  robot a/b   3 controls over 2 s, 3 m, 0 observations\n");
  ExpectContains(text, "  identities  1 landmark\n");
  ExpectContains(text, "  warning: robot 'a/b' has no observations");
  ExpectContains(text,
                 "  robot/0/observations/range_m      float64  [3]           m      1 to 2, 1 not finite\n");
  ExpectContains(text, "  robots                            text     [2]                  'Rosa', 'a/b'\n");
  ExpectContains(text, "  noise/range_m                     float64  []            m      0.1\n");
}

TEST(Inspect, WarnsOfObservationsThatNoMapIsMadeOf) {
  Blob log = SmallLog();
  log.Put("landmarks", Array::Texts({"Rosa"}));
  const auto seen = log.Get<double>("robot/0/observations/bearing_rad");
  std::vector<double> bearings(seen.begin(), seen.end());
  EXPECT_FALSE(std::isnan(bearings[0]));
  bearings[0] = std::nan("");
  log.PutVector("robot/0/observations/bearing_rad", bearings);
  const std::string text = InspectText(Inspected(log, "log"));
  ExpectContains(text, "  warning: robots and landmarks have names in common: 'Rosa'");
  ExpectContains(text, "  warning: 1 observation has a range without a bearing");
}

TEST(Inspect, NamesAreAsWideAsTheirCharacters) {
  Blob log = SmallLog();
  log.Put("robots", Array::Texts({"Öß", "a/b"}));
  const std::string text = InspectText(Inspected(log, "log"));
  ExpectContains(text, "  robot Öß    3 controls");
  ExpectContains(text, "  robot a/b   3 controls");
}

TEST(Inspect, TellsOfTurretsAndHints) {
  Blob log = SmallLog();
  log.PutVector<double>("robot/0/sonar/beam_x_m", {0, 0});
  log.PutVector<double>("robot/0/sonar/time_s", {1, 2});
  EXPECT_EQ(InspectText(Inspected(log, "log")).find("turret"), std::string::npos);
  log.PutVector<double>("robot/0/sonar/turret_rad", {0, 0.1});
  log.PutVector<double>("robot/0/hints/time_s", {1.5});
  ExpectContains(InspectText(Inspected(log, "log")), "2 scans of 2 beams (sonar, on a turret), 1 hint");
}

TEST(Inspect, TellsOfTracesAndTheirLoops) {
  Blob map;
  map.Put("robots", Array::Texts({"ann"}));
  map.PutVector<std::int32_t>("traces/robot", {0, 0, 0});
  map.PutVector<std::int32_t>("connections/kind", {0, 2, 2, 1});
  map.PutVector<std::int32_t>("connections/from", {0, 1, 2, 1});
  map.PutVector<double>("connections/from_s", {1, 5, 6, 7});
  map.PutVector<double>("connections/to_s", {1, 2, 2, 7});
  map.PutVector<std::uint8_t>("connections/used", {1, 1, 0, 1});
  const std::string text = InspectText(Inspected(map, "local_map"));
  ExpectContains(text, "3, joined by 2 loops; the path follows 1\n");
  ExpectContains(text, "low: 1 of 2 loops contradict the path; what comes after");
}

TEST(Inspect, TellsWhatAMapHolds) {
  Blob blob = SmallResult();
  blob.PutVector<double>("history/log_likelihood", {-512.5, -100, -99.25});
  const std::string text = InspectText(Inspected(blob, "landmark_map"));
  ExpectContains(text, "robot Rosa     3 poses over 2 s, 2 of 3 observations associated\n");
  ExpectContains(text, "map landmarks  2\n");
  ExpectContains(text, "iterations     3, log-likelihood -512.5 to -99.25\n");
  EXPECT_EQ(text.find("refinement  "), std::string::npos) << "older files do not say";
  blob.Put("refinement/reason", Array::Text(""));
  ExpectContains(InspectText(Inspected(blob, "landmark_map")), "refinement     done\n");
  blob.Put("refinement/reason", Array::Text("refused: the least squares has no solution"));
  ExpectContains(InspectText(Inspected(blob, "landmark_map")),
                 "refinement     refused: the least squares has no solution\n");
}

TEST(Inspect, TellsWhatSamplesHold) {
  const SampleRun monday{"monday", {1, 2, 4}, {0, 3, 3}, {0, 4, 4}, {}, {1, 2, 3, 4, 5, 6}};
  const SampleRun tuesday{"tuesday", {5, 9}, {-1, 0}, {2, 2}, {0, 0}, {7, 8, 9, 10}};
  Blob blob = MakeSamples({{"red", "range 1"}, {monday, tuesday}});
  const std::string text = InspectText(Inspected(blob, "samples"));
  ExpectContains(text, "  run monday   3 samples over 3 s, 5 m\n");
  ExpectContains(text, "  run tuesday  2 samples over 4 s, 1 m\n");
  ExpectContains(text, "  samples      5 samples in 2 runs, 2 inputs each\n");
  EXPECT_EQ(text.find("images"), std::string::npos);
  blob.Put("run/0/image", Array::Of({3, 2, 4, 3}, std::vector<std::uint8_t>(72)));
  ExpectContains(InspectText(Inspected(blob, "samples")), "  images       2 by 4 pixels");
  ExpectContains(text, "  extent       x -1 to 3 m, y 0 to 4 m\n");
}

TEST(Inspect, TellsOfHandMadeFeatures) {
  SampleRun run{"monday", {1, 2}, {0, 3}, {0, 4}, {}, {1, 2}};
  run.feature = {0, 0.5F, 1, 0.25F};
  run.true_x_m = run.true_y_m = run.true_heading_rad = {0, 1};
  Samples samples{{"red"}, {run}};
  samples.feature_name = {"door", "light"};
  samples.label_error_m = 0.1;
  const std::string text = InspectText(Inspected(MakeSamples(samples), "samples"));
  ExpectContains(text, "  hand-made features  door, light\n");
  ExpectContains(text, "  label error         0.1 m\n");
  EXPECT_EQ(MakeSamples(samples).at("run/0/feature").shape(), (Shape{2, 2}));
  EXPECT_EQ(MakeSamples(samples).Get<double>("truth/run/0/x_m").size(), 2U);
}

TEST(Inspect, JsonHoldsEveryDataset) {
  const Blob log = SimulateLoop({.difficulty = "paper", .robots = 2, .seed = 1});
  const auto json = nlohmann::json::parse(InspectJson(Inspected(log, "log")));
  EXPECT_EQ(json["kind"], "log");
  EXPECT_EQ(json["content"], log.ContentHash().Hex());
  ASSERT_EQ(json["datasets"].size(), log.fields().size());
  for (const auto& dataset : json["datasets"]) {
    EXPECT_EQ(dataset["shape"], log.at(dataset["name"].get<std::string>()).shape());
  }
  EXPECT_EQ(json["facts"].size(), 4U);  // two robots, identities, true landmarks
}

TEST(Inspect, ForgivesAFileThatIsNotAsItsKindSays) {
  Blob odd;
  odd.PutVector<double>("robots", {1, 2});
  odd.PutVector<float>("map/landmark_x_m", {1});
  odd.Put("landmarks", Array::Text("x"));
  EXPECT_EQ(Inspected(odd, "log").datasets.size(), 3U);
  Blob other;
  other.Put("runs", Array::Texts({"a", "b"}));
  other.PutVector<std::int32_t>("run/0/input", {1});
  other.PutVector<double>("run/0/x_m", {1, 2});
  ExpectContains(InspectText(Inspected(other, "samples")), "samples  0 samples in 2 runs, 0 inputs each\n");
  EXPECT_EQ(Inspected(Blob(), "").datasets.size(), 0U);
}

TEST(Inspect, SaysWhatIsNotAsItsKindShouldBe) {
  Blob log = SmallLog();
  EXPECT_EQ(Inspected(log, "log").wrong, "");
  log.PutVector<double>("robot/0/odometry/turn_rad", {0, 0});
  const Inspection inspection = Inspected(log, "log");
  ExpectContains(InspectText(inspection), "WRONG: 'robot/0/odometry/turn_rad' has the shape [2], where ");
  ExpectContains(InspectText(inspection), "; but for `cairn diff` no other command takes it\n");
  ExpectContains(nlohmann::json::parse(InspectJson(inspection))["wrong"], "robot/0/odometry/turn_rad");
  EXPECT_FALSE(nlohmann::json::parse(InspectJson(inspection))["wrong_truth_only"]);
}

TEST(Inspect, OfAWrongTruthItSaysThatAJobDoesNotLookAtIt) {
  Blob log = SmallLog();
  log.PutVector<double>("truth/robot/0/poses/x_m", {0, 0});
  log.PutVector<double>("truth/robot/0/poses/y_m", {0});
  const Inspection inspection = Inspected(log, "log");
  ExpectContains(InspectText(inspection), "a job, which leaves the truth behind, takes it");
  EXPECT_TRUE(nlohmann::json::parse(InspectJson(inspection))["wrong_truth_only"]);
}

TEST(Inspect, LongTextsTakeOneLine) {
  Blob blob;
  blob.Put("job", Array::Text("{\n" + std::string(66, 'x') + "é, and more}"));
  ExpectContains(InspectText(Inspected(blob, "blob")), "'{ " + std::string(66, 'x') + "…\n");
}

TEST(Inspect, ADamagedFileIsNamed) {
  const TestFolder folder;
  folder.Put("a.h5", "no");
  ExpectContains(Inspect(folder / "a.h5").status().message(), "a.h5: not a Cairn file");
  EXPECT_EQ(Inspect(folder / "b.h5").status().code(), Code::kNotFound);
}

}  // namespace
}  // namespace cairn::datasets
