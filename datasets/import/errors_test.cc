#include "datasets/import/errors.h"

#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

class ImportErrorsTest : public ::testing::Test {
 protected:
  const TestFolder folder_;
  Blob errors_;

  ImportReport Import(const std::string& text, const std::string& name = "costs.csv") {
    return ImportErrors({folder_.Put(name, text)}, &errors_);
  }
  // What is said of a table; empty where it is taken.
  std::string Failure(const std::string& text) {
    errors_ = Blob();
    const std::string failure = InputErrorOf([&] { Import(text); });
    EXPECT_TRUE(failure.empty() || errors_.fields().empty()) << "refused, and yet something was made";
    return failure;
  }
  std::vector<double> Column(const std::string& name) const {
    const auto values = errors_.Get<double>(name);
    return {values.begin(), values.end()};
  }
};

TEST_F(ImportErrorsTest, RowsAreTruePositionsAndColumnsBelievedOnes) {
  const ImportReport report = Import("lobby,y_m,lift,x_m\n0,1,2.5,3\n4,5,0,6\n", "costs.csv.gz");
  EXPECT_EQ(Column("position/x_m"), (std::vector<double>{3, 6}));
  EXPECT_EQ(Column("position/y_m"), (std::vector<double>{1, 5}));
  EXPECT_EQ(errors_.at("error").shape(), (Shape{2, 2}));
  EXPECT_EQ(Column("error"), (std::vector<double>{0, 2.5, 4, 0}));
  EXPECT_TRUE(report.warnings.empty());
}

TEST_F(ImportErrorsTest, WarnsOfPositionsThatCostSomethingWhereTheyAreTrue) {
  const ImportReport report = Import("x_m,y_m,a,b\n0,0,1,0\n1,0,2,0\n");
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_EQ(report.warnings[0], "1 of 2 positions cost something where they are the true one");
}

TEST_F(ImportErrorsTest, NamesTheLineThatIsNoRowOfATable) {
  const std::string head = "x_m,y_m,a,b\n0,0,0,1\n";
  ExpectContains(Failure(head + "1,0,1,many\n"), "costs.csv:3: not a number");
  ExpectContains(Failure(head + "1,0,inf,0\n"), "costs.csv:3: not finite");
  ExpectContains(Failure(head + "1,0,-1,0\n"), "costs.csv:3: below 0: -1");
  ExpectContains(Failure(head + "1,0,1\n"), "costs.csv:3: ");
  ExpectContains(Failure(head + "0,0,1,0\n"), "costs.csv:3: the position of line 2 again");
  ExpectContains(Failure(head + "1,0,1,0\n2,0,1,0\n"),
                 "costs.csv:4: more rows than the 2 columns for positions");
  ExpectContains(Failure(head), "costs.csv:2: 1 rows, where there are 2 columns for positions");
  ExpectContains(Failure("x_m,y_m\n0,0\n"), "costs.csv:1: 0 columns for positions");
  ExpectContains(Failure("x_m,a\n0,0\n"), "y_m");
  EXPECT_EQ(Failure(head + "-1,0,1,0\n"), "");
}

TEST_F(ImportErrorsTest, RefusesMorePositionsThanATableMayHave) {
  std::string head = "x_m,y_m";
  for (int p = 0; p < 4097; ++p) head += ",p" + std::to_string(p);
  ExpectContains(Failure(head + "\n"), "4097 columns for positions beside x_m and y_m; allowed: 1 to 4096");
}

}  // namespace
}  // namespace cairn::datasets
