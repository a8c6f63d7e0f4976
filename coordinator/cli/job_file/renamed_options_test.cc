// Options of pipelines by the names that they had (schema/command_line/renamed.h).
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "coordinator/cli/job_file/arguments.h"
#include "schema/error.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

constexpr char kRenamedDescription[] = R"({"pipelines": [
  {"name": "landmark_map", "inputs": ["log"], "options": [
    {"name": "refine", "type": "boolean", "unit": "", "help": "", "low": 0, "high": 0, "default": true}]},
  {"name": "another", "inputs": ["log"], "options": [
    {"name": "refine", "type": "boolean", "unit": "", "help": "", "low": 0, "high": 0, "default": true}]}]})";

class RenamedOptions : public testing::Test {
 protected:
  RenamedOptions() : folder_(fs::path(testing::TempDir()) / ("cairn_renamed_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "log.h5") << "x";
  }
  ~RenamedOptions() override { fs::remove_all(folder_); }

  std::string Log() const { return (folder_ / "log.h5").string(); }

  const fs::path folder_;
  const Catalog catalog_ = Catalog::FromJson(kRenamedDescription);
};

TEST_F(RenamedOptions, AreUnderstoodOnTheCommandLineWithAWarning) {
  testing::internal::CaptureStderr();
  const ParsedJob parsed = ResolveJob({"landmark_map", Log(), {"polish=false"}, 0, {}}, catalog_);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_FALSE(parsed.job.stages(0).options().at("refine").b());
  EXPECT_EQ(parsed.job.stages(0).options().size(), 1u);
  EXPECT_NE(said.find("warning: 'polish' is called 'refine' now"), std::string::npos) << said;
}

TEST_F(RenamedOptions, AreUnderstoodInAJobFile) {
  const std::string path = (folder_ / "job.yaml").string();
  std::ofstream(path) << "inputs: {log: log.h5}\nstages:\n"
                         "  - {name: map, pipeline: landmark_map, log: log, options: {polish: false}}\n";
  testing::internal::CaptureStderr();
  const ParsedJob parsed = ResolveJob({path, "", {}, 0, {}}, catalog_);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("'refine'"), std::string::npos);
  EXPECT_FALSE(parsed.job.stages(0).options().at("refine").b());
}

TEST_F(RenamedOptions, CountAsTheNewOnes) {
  testing::internal::CaptureStderr();
  EXPECT_THROW(ResolveJob({"landmark_map", Log(), {"refine=true", "polish=false"}, 0, {}}, catalog_),
               InputError);
  testing::internal::GetCapturedStderr();
}

TEST_F(RenamedOptions, AreNoneOfAPipelineThatNeverHadThem) {
  EXPECT_THROW(ResolveJob({"another", Log(), {"polish=false"}, 0, {}}, catalog_), InputError);
}

TEST_F(RenamedOptions, NewNamesSayNothing) {
  testing::internal::CaptureStderr();
  ResolveJob({"landmark_map", Log(), {"refine=false"}, 0, {}}, catalog_);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace cairn::cli
