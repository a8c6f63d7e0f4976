// Evaluation of real logs; CAIRN_DATA names the folder that holds them.
#include <gtest/gtest.h>

#include <string>

#include "datasets/evaluate/evaluate.h"
#include "datasets/evaluate/testing/perfect_result.h"
#include "datasets/import/csv.h"
#include "datasets/simulate/loop.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

TEST(EvaluateData, TruthOfAnImportedLogIsPerfect) {
  if (DataFolder().empty()) GTEST_SKIP() << "CAIRN_DATA is not set";
  for (const std::string name : {"base-01", "base-10", "paper-04"}) {
    SCOPED_TRACE(name);
    const std::string folder = DataFolder() + "/loops-csv/" + name + "/";
    CsvImportOptions options;
    options.odometry = folder + "odometry.csv.gz";
    options.observations = folder + "observations.csv";
    options.truth_poses = folder + "truth_poses.csv.gz";
    options.truth_landmarks = folder + "truth_landmarks.csv";
    options.truth_associations = folder + "truth_associations.csv";
    Blob log;
    ImportCsv(options, &log);
    const Evaluation e = Evaluate(PerfectLandmarkMap(log), log);
    ASSERT_TRUE(e.landmarks && e.landmarks->rmse_m && e.trajectory_rmse_m);
    EXPECT_GE(e.landmarks->found, 13);
    EXPECT_EQ(e.landmarks->missed, 0);
    EXPECT_EQ(e.landmarks->spurious, 0);
    EXPECT_LT(*e.landmarks->rmse_m, 1e-9);
    EXPECT_LT(*e.trajectory_rmse_m, 1e-9);
    EXPECT_EQ(e.topology_correct, true);
    // What its index.csv says of the second simulator's logs: 22 to 28 m.
    EXPECT_GE(FinalOdometricErrorM(log, 0), 21.9);
    EXPECT_LE(FinalOdometricErrorM(log, 0), 28.1);
  }
}

}  // namespace
}  // namespace cairn::datasets
