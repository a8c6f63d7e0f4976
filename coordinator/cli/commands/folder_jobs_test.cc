#include "coordinator/cli/commands/folder_jobs.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/testing.h"
#include "datasets/evaluate/testing/grid.h"
#include "datasets/evaluate/testing/perfect_result.h"
#include "datasets/simulate/loop.h"
#include "datasets/testing.h"
#include "schema/job.pb.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {
namespace {

using datasets::ExpectContains;

Blob ResultOf(const proto::Job& job, Blob result = {}) {
  const std::string bytes = job.SerializeAsString();
  result.PutVector("provenance/job", std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
  return result;
}

proto::Job JobOfSeed(std::uint64_t seed, const std::string& log = "one") {
  proto::Job job;
  job.set_seed(seed);
  (*job.mutable_input_blobs())["log"] = log;
  return job;
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

// A folder with a grid map and a landmark map.
class FolderJobs : public testing::Test {
 protected:
  FolderJobs() {
    std::filesystem::create_directory(folder_ / "out");
    Write("reference.h5", "grid_map", datasets::DrawnMap({"...", "...", "..#"}));
  }
  void Write(const std::string& name, const std::string& kind, const Blob& blob) const {
    const Status status = WriteBlobFile(folder_ / name, kind, blob);
    ASSERT_TRUE(status.ok()) << status.message();
  }
  void WriteResults(const proto::Job& of_grid, const proto::Job& of_landmarks) const {
    Write("out/grid.h5", "grid_map", ResultOf(of_grid, datasets::DrawnMap({"...", ".#.", "..."})));
    Write("out/marks.h5", "landmark_map",
          ResultOf(of_landmarks, datasets::PerfectLandmarkMap(datasets::SimulateLoop({.seed = 3}))));
  }

  datasets::TestFolder folder_;
  std::string out_ = folder_ / "out";
};

TEST_F(FolderJobs, OneJobIsNothingToSpeakOf) {
  proto::Job again = JobOfSeed(1);
  again.set_priority(3);
  WriteResults(JobOfSeed(1), again);
  Write("out/log.h5", "log", datasets::SimulateLoop({.seed = 3}));
  EXPECT_EQ(SeveralJobs(out_), "");
  EXPECT_EQ(SeveralJobs(out_ + "/grid.h5"), "");
  EXPECT_EQ(Cairn({"inspect", out_}).complaint, "");
  EXPECT_EQ(Cairn({"report", out_}).complaint, "");
  EXPECT_EQ(datasets::FileText(out_ + "/report.html").find("Mind:"), std::string::npos);
}

TEST_F(FolderJobs, SaysWhoseFilesAreWhoseAndWhetherTheirInputsAreTheSame) {
  WriteResults(JobOfSeed(1), JobOfSeed(2));
  EXPECT_EQ(SeveralJobs(out_), "the results in '" + out_ +
                                   "' belong to 2 different jobs of the same inputs ('grid.h5'; 'marks.h5')");
  WriteResults(JobOfSeed(1), JobOfSeed(1, "two"));
  ExpectContains(SeveralJobs(out_), "belong to 2 different jobs, made from different inputs (");
}

TEST_F(FolderJobs, EveryCommandThatTakesAFolderSaysItAndWhatItShows) {
  WriteResults(JobOfSeed(1), JobOfSeed(2));
  const std::string several = "cairn: warning: " + SeveralJobs(out_) + ": ";
  const auto says = [&](const std::vector<std::string>& words, const std::string& shown) {
    const Said said = Cairn(words);
    EXPECT_EQ(said.code, kExitDone) << said.complaint;
    ExpectContains(said.complaint, several + shown + "\n");
  };
  says({"inspect", out_}, "the list shows all of them");
  says({"report", out_}, "the page shows all of them");
  const std::string page = datasets::FileText(out_ + "/report.html");
  ExpectContains(page, "<p class=\"verdict\">Mind: the results in");
  for (const char* file : {"(grid.h5)", "(marks.h5)"}) ExpectContains(page, file);
  says({"evaluate", out_, "--truth", folder_ / "reference.h5"}, "it is " + out_ + "/grid.h5 that is scored");
  says({"export", "csv", out_, folder_ / "tables"}, "it is the landmark_map that is exported");
}

}  // namespace
}  // namespace cairn::cli
