// What commands that write files say of them with --json.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "coordinator/cli/testing.h"
#include "datasets/evaluate/testing/perfect_result.h"
#include "datasets/simulate/loop.h"
#include "datasets/testing.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {
namespace {

class WrittenJson : public testing::Test {
 protected:
  WrittenJson() {
    const Blob log = datasets::SimulateLoop({.difficulty = "paper", .robots = 1, .seed = 3});
    EXPECT_TRUE(WriteBlobFile(folder_ / "log.h5", "log", log).ok());
    Blob map = datasets::PerfectLandmarkMap(log);
    const std::int64_t landmarks = map.at("map/landmark_x_m").size();
    map.Put("map/landmark_covariance_m2",
            Array::Of<double>({landmarks, 2, 2}, std::vector<double>(4 * landmarks, 0.0)));
    map.Put("provenance/stage", Array::Text("landmarks"));
    EXPECT_TRUE(WriteBlobFile(folder_ / "map.h5", "landmark_map", map).ok());
  }

  static nlohmann::json JsonOf(const std::vector<std::string>& words) {
    const Said said = Cairn(words);
    EXPECT_EQ(said.code, 0) << said.complaint;
    return nlohmann::json::parse(said.out);
  }

  datasets::TestFolder folder_;
};

TEST_F(WrittenJson, OfAnExportIsEachFileAndWhatItHolds) {
  const nlohmann::json json = JsonOf({"export", "csv", folder_ / "map.h5", folder_ / "tables", "--json"});
  EXPECT_EQ(json["kind"], "landmark_map");
  EXPECT_EQ(json["format"], "csv");
  EXPECT_EQ(json["left_out"], nlohmann::json::array());
  std::vector<std::string> held;
  for (const nlohmann::json& file : json["files"]) {
    EXPECT_TRUE(std::filesystem::exists(file["file"].get<std::string>())) << file;
    held.push_back(file["holds"]);
  }
  EXPECT_EQ(held, (std::vector<std::string>{"poses", "landmarks", "associations"}));
  EXPECT_EQ(JsonOf({"export", "tum", folder_ / "map.h5", folder_ / "tum", "--json"})["files"][0]["holds"],
            "trajectory");
  EXPECT_EQ(JsonOf({"export", "csv", folder_ / "log.h5", folder_ / "log", "--json"})["left_out"][0], "noise");
}

TEST_F(WrittenJson, OfAReportIsThePageAndItsStages) {
  const std::string page = folder_ / "page.html";
  const nlohmann::json json =
      JsonOf({"report", folder_ / "map.h5", "--log", folder_ / "log.h5", "--out", page, "--json"});
  EXPECT_EQ(json["file"], page);
  EXPECT_TRUE(std::filesystem::exists(page));
  ASSERT_EQ(json["stages"].size(), 1U);
  EXPECT_EQ(json["stages"][0],
            (nlohmann::json{{"name", "landmarks"}, {"kind", "landmark_map"}, {"evaluated", true}}));
}

TEST_F(WrittenJson, OfASimulationIsTheFileAndItsContent) {
  const std::string loop = folder_ / "loop.h5", hall = folder_ / "hall.h5";
  const nlohmann::json json = JsonOf({"simulate", "loop", "--difficulty", "paper", loop, "--json"});
  EXPECT_EQ(json["file"], loop);
  EXPECT_EQ(json["kind"], "log");
  EXPECT_EQ(json["content"].get<std::string>().find("1 robot, "), 0U) << json;
  EXPECT_EQ(json["pictures"], nlohmann::json::array());
  EXPECT_EQ(JsonOf({"simulate", "narrow-doors", hall, "--json"})["file"], hall);
}

}  // namespace
}  // namespace cairn::cli
