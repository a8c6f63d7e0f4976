#include "datasets/import/vectors.h"

#include <cmath>

#include "datasets/common/samples.h"
#include "datasets/testing.h"
#include "schema/store/blob_file.h"

namespace cairn::datasets {
namespace {

constexpr char kVectorsHeader[] = "time_s,x_m,y_m,heading_rad,red,range 1\n";

class ImportVectorsTest : public ImportTest {
 protected:
  VectorsImportOptions options_;

  void Put(const std::string& name, const std::string& text) {
    options_.runs.push_back(folder_.Put(name, text));
  }
  ImportReport Import() { return ImportVectors(options_, &log_); }
  // What is said of these runs, the files a.csv and b.csv; empty where they are taken.
  std::string Failure(const std::string& a, const std::string& b = "") {
    options_.runs.clear();
    Put("a.csv", a);
    if (!b.empty()) Put("b.csv", b);
    log_ = Blob();
    const std::string failure = InputErrorOf([this] { Import(); });
    EXPECT_TRUE(failure.empty() || log_.fields().empty()) << "refused, and yet something was made";
    return failure;
  }
  std::string RowFailure(const std::string& rows) { return Failure(kVectorsHeader + rows); }
};

TEST_F(ImportVectorsTest, PutsEveryColumnInItsPlace) {
  Put("monday.csv", std::string(kVectorsHeader) + "1,2,3,0.5,10,-1\n1.5,2.5,3.5,4,11,1e-3\n\n2,3,4,0,12,0\n");
  Put("tuesday.csv.gz", "range 1,y_m,heading_rad,\"red\",x_m,time_s\n5,6,-0.25,7,8,9\n15,16,0,17,18,19\n");
  const ImportReport report = Import();
  EXPECT_EQ(log_.Texts("runs"), (std::vector<std::string>{"monday", "tuesday"}));
  EXPECT_EQ(log_.Texts("input_name"), (std::vector<std::string>{"red", "range 1"}));
  EXPECT_EQ(Column<double>("run/0/time_s"), (std::vector<double>{1, 1.5, 2}));
  EXPECT_EQ(Column<double>("run/0/x_m"), (std::vector<double>{2, 2.5, 3}));
  EXPECT_EQ(Column<double>("run/0/y_m"), (std::vector<double>{3, 3.5, 4}));
  EXPECT_NEAR(Column<double>("run/0/heading_rad")[1], 4 - 2 * M_PI, 1e-15);
  EXPECT_EQ(log_.at("run/0/input").shape(), (Shape{3, 2}));
  EXPECT_EQ(Column<float>("run/0/input"), (std::vector<float>{10, -1, 11, 1e-3F, 12, 0}));
  EXPECT_EQ(Column<double>("run/1/time_s"), (std::vector<double>{9, 19}));
  EXPECT_EQ(Column<double>("run/1/x_m"), (std::vector<double>{8, 18}));
  EXPECT_EQ(Column<double>("run/1/heading_rad"), (std::vector<double>{-0.25, 0}));
  EXPECT_EQ(Column<float>("run/1/input"), (std::vector<float>{7, 5, 17, 15}));
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_TRUE(report.skipped.empty());
}

TEST_F(ImportVectorsTest, TakesOdometryAsSuchAndNotAsInputs) {
  Put("a.csv",
      "time_s,odometry_forward_m,x_m,y_m,s,odometry_turn_rad\n1,9,0,0,0.1,9\n2,0.5,0.5,0,0.2,-0.25\n");
  Put("b.csv", "time_s,x_m,y_m,s\n1,0,0,0.1\n2,0.5,0,0.2\n");  // this run has none
  Import();
  EXPECT_EQ(log_.Texts("input_name"), (std::vector<std::string>{"s"}));
  EXPECT_EQ(Column<double>("run/0/odometry/turn_rad"), (std::vector<double>{9, -0.25}));
  EXPECT_EQ(Column<double>("run/0/odometry/forward_m"), (std::vector<double>{9, 0.5}));
  EXPECT_EQ(Column<double>("run/0/odometry/left_m"), (std::vector<double>{0, 0}));
  EXPECT_FALSE(log_.Has("run/1/odometry/turn_rad"));
  ExpectContains(Failure("time_s,x_m,y_m,s,odometry_turn_rad\n1,0,0,0.1,0\n"),
                 "a.csv:1: the header has some odometry");
  ExpectContains(Failure("time_s,x_m,y_m,s,odometry_turn_deg,odometry_forward_mm\n1,0,0,0.1,0,0\n"),
                 "a.csv:1: column 'odometry_turn_deg' is no input of a network");
  ExpectContains(Failure("time_s,x_m,y_m,s,Odometry_Turn_Rad\n1,0,0,0.1,0\n"),
                 "column 'Odometry_Turn_Rad' is no input of a network");
  options_.skip_bad = true;
  ExpectContains(Failure("time_s,x_m,y_m,s,odometry_turn_rad,odometry_forward_m\n1,0,0,1,0,0\n2,0,0,x,0,0\n"
                         "3,0,0,1,0,0\n"),
                 "a.csv: has odometry, in which skipped lines leave a gap");
}

TEST_F(ImportVectorsTest, GoesThroughAFileUnchanged) {
  Put("a.csv", "time_s,x_m,y_m,s\n1,0,0,0.1\n2,0.3,-0,1e30\n");
  Import();
  ASSERT_TRUE(WriteBlobFile(folder_ / "samples.h5", "samples", log_).ok());
  const BlobFile file = ReadBlobFile(folder_ / "samples.h5").value();
  EXPECT_EQ(file.kind, "samples");
  EXPECT_EQ(file.blob.ContentHash().Hex(), log_.ContentHash().Hex());
}

TEST_F(ImportVectorsTest, HeadingsMayBeMissingFromAll) {
  Put("a.csv", "time_s,x_m,y_m,s\n1,0,0,1\n2,1,0,2\n");
  Import();
  EXPECT_FALSE(log_.Has("run/0/heading_rad"));
  EXPECT_EQ(log_.Texts("input_name"), (std::vector<std::string>{"s"}));
}

TEST_F(ImportVectorsTest, RepeatedPosesAreTakenAndCounted) {
  Put("a.csv",
      std::string(kVectorsHeader) + "1,0,0,0,1,1\n2,0,0,0,2,2\n3,0,0,1,3,3\n3,1,0,0,4,4\n5,0,0,0,5,5\n");
  const ImportReport report = Import();
  EXPECT_EQ(Column<double>("run/0/time_s").size(), 5U);
  ASSERT_EQ(report.warnings.size(), 1U);
  ExpectContains(report.warnings[0], "run 'a': 2 of 5 samples repeat the pose of an earlier one");
}

TEST_F(ImportVectorsTest, ARowsNumberLeftInTheFileIsSaid) {
  std::string rows = "time_s,x_m,y_m,red,seq\n";
  for (int k = 0; k < 20; ++k) {
    const std::string at = std::to_string(k);
    rows += at + "," + at + ",0," + (k % 3 == 0 ? "1" : "0") + "," + at + "\n";
  }
  Put("a.csv", rows);
  const ImportReport report = Import();
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_EQ(report.warnings[0].find("input 'seq' only grows along every run"), 0U) << report.warnings[0];
}

TEST_F(ImportVectorsTest, MissingAndDoubledColumnsAreRefused) {
  ExpectContains(Failure("time_s,x_m,s\n1,0,1\n2,0,1\n"),
                 "a.csv:1: the header lacks columns: it must have time_s,x_m,y_m");
  ExpectContains(Failure("time_s,x_m,y_m,s,s\n1,0,1,2,3\n"), "a.csv:1: the header has s twice");
  ExpectContains(Failure("time_s,x_m,x_m,y_m,s\n1,0,1,2,3\n"), "a.csv:1: the header has x_m twice");
  ExpectContains(Failure("time_s,x_m,y_m,,s\n1,0,1,2,3\n"),
                 "a.csv:1: the header has a column without a name");
  ExpectContains(Failure("time_s,x_m,y_m,heading_rad\n1,0,1,2\n"), "a.csv:1: the header has no inputs");
  ExpectContains(Failure(""), "a.csv: is empty; a header is needed");
}

TEST_F(ImportVectorsTest, RunsOfOtherColumnsAreRefused) {
  const std::string rows = "1,0,0,0,1,1\n2,1,0,0,2,2\n", good = kVectorsHeader + rows;
  ExpectContains(Failure(good, "time_s,x_m,y_m,heading_rad,red,blue\n" + rows),
                 "b.csv:1: the header has column 'blue', which " + (folder_ / "a.csv") + " lacks");
  ExpectContains(Failure(good, "time_s,x_m,y_m,heading_rad,red\n1,0,0,0,1\n2,0,0,0,1\n"),
                 "b.csv:1: the header lacks column 'range 1', which " + (folder_ / "a.csv") + " has");
  ExpectContains(Failure(good, "time_s,x_m,y_m,red,range 1\n1,0,0,1,1\n2,1,0,2,2\n"),
                 "b.csv:1: the header lacks column 'heading_rad'");
  ExpectContains(Failure("time_s,x_m,y_m,red,range 1\n1,0,0,1,1\n2,1,0,2,2\n", good),
                 "b.csv:1: the header has column 'heading_rad'");
  EXPECT_EQ(Failure(good, good), "");
}

TEST_F(ImportVectorsTest, ARunOfOneRowOrNoneIsRefused) {
  ExpectContains(RowFailure(""), "a.csv:1: a run has two samples or more; 'a' has none");
  ExpectContains(RowFailure("1,0,0,0,1,1\n"), "a.csv:2: a run has two samples or more; 'a' has one");
  EXPECT_EQ(RowFailure("1,0,0,0,1,1\n1,0,1,0,1,1\n"), "");
}

TEST_F(ImportVectorsTest, BadRowsNameFileLineAndReason) {
  const std::string good = "1,0,0,0,1,1\n";
  ExpectContains(RowFailure(good + "0.5,0,0,0,1,1\n"),
                 "a.csv:3: time runs backwards: 0.500000 after 1.000000");
  ExpectContains(RowFailure(good + "2,0,0,0,nan,1\n"), "a.csv:3: not finite: red is 'nan'");
  ExpectContains(RowFailure(good + "2,0,0,0,1,inf\n"), "a.csv:3: not finite: range 1 is 'inf'");
  ExpectContains(RowFailure(good + "2,0,0,0,1,\n"), "a.csv:3: not a number: range 1 is ''");
  ExpectContains(RowFailure(good + "2,0,0,0,dark,1\n"), "a.csv:3: not a number: red is 'dark'");
  ExpectContains(RowFailure(good + "2,east,0,0,1,1\n"), "a.csv:3: not a number: x_m is 'east'");
  ExpectContains(RowFailure(good + "2,0,0,nan,1,1\n"), "a.csv:3: not finite: heading_rad is 'nan'");
  ExpectContains(RowFailure(good + "2,0,0,0,1e39,1\n"), "a.csv:3: too large for 32 bits: 1e39");
  ExpectContains(RowFailure(good + "2,0,0,0,1\n"), "a.csv:3: wrong number of columns");
}

TEST_F(ImportVectorsTest, TwoRunsOfOneNameAreRefused) {
  const std::string text = std::string(kVectorsHeader) + "1,0,0,0,1,1\n2,1,0,0,1,1\n";
  Put("a.csv", text);
  Put("a.csv.gz", text);
  ExpectContains(InputErrorOf([this] { Import(); }), "a.csv.gz: its run is called 'a', as that of ");
}

// Such a name was refused when the samples were written, by then without the file that it came from.
TEST_F(ImportVectorsTest, AFileWhoseNameIsNoNameForARunIsRefused) {
  Put("a\tb.csv", std::string(kVectorsHeader) + "1,0,0,0,1,2\n2,0,0,0,1,2\n");
  ExpectContains(InputErrorOf([this] { Import(); }),
                 "b.csv: its run is named after it, with a name that has control characters");
}

TEST_F(ImportVectorsTest, SkipBadCountsByReasonAndKeepsWholeRowsOnly) {
  options_.skip_bad = true;
  Put("a.csv",
      std::string(kVectorsHeader) + "1,0,0,0,1,1\n2,0,0,0,5,x\n0,0,0,0,1,1\n3,1,0,0,2,2\n4,1,1,0,nan,2\n");
  const ImportReport report = Import();
  EXPECT_EQ(report.skipped, (std::map<std::string, std::int64_t>{
                                {"not a number", 1}, {"not finite", 1}, {"time runs backwards", 1}}));
  EXPECT_EQ(Column<double>("run/0/time_s"), (std::vector<double>{1, 3}));
  EXPECT_EQ(Column<float>("run/0/input"), (std::vector<float>{1, 1, 2, 2}));
}

}  // namespace
}  // namespace cairn::datasets
