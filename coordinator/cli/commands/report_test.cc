#include "coordinator/cli/commands/report.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "schema/job.pb.h"
#include "schema/wire/testing/private_folder.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

// A folder that somebody hands on must not choose where the next person's pages go.
TEST(WritePages, AStagesFolderThatIsALinkIsRefused) {
  const wire::PrivateFolder folder;
  fs::create_directories(folder.path() / "victim");
  fs::create_directories(folder.path() / "out");
  fs::create_directory_symlink(folder.path() / "victim", folder.path() / "out" / "first");
  const std::vector<ScoredStage> stages = {{.name = "first", .kind = "landmark_map", .result = nullptr},
                                           {.name = "second", .kind = "landmark_map", .result = nullptr}};
  EXPECT_THROW(WritePages(folder.path() / "out", stages), InputError);
  EXPECT_TRUE(fs::is_empty(folder.path() / "victim"));
}

Blob ResultOf(const proto::Job& job) {
  const std::string bytes = job.SerializeAsString();
  Blob result;
  result.PutVector("provenance/job", std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
  return result;
}

TEST(JobOf, TellsJobsApartButNotByWhatChangesNoResult) {
  proto::Job job;
  job.set_seed(1);
  const std::string one = JobOf(ResultOf(job));
  EXPECT_FALSE(one.empty());
  job.set_priority(2);
  EXPECT_EQ(JobOf(ResultOf(job)), one);
  job.set_seed(2);
  EXPECT_NE(JobOf(ResultOf(job)), one);
  EXPECT_EQ(JobOf(Blob()), "");
}

}  // namespace
}  // namespace cairn::cli
