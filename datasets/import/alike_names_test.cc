#include "datasets/import/alike_names.h"

#include "datasets/import/csv.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

TEST(AlikeNames, DifferInCaseOrZerosAlone) {
  EXPECT_EQ(WarningOfAlikeNames({"plant", "DOOR", "door"}, "landmarks"),
            "'DOOR' and 'door' are taken for two landmarks: their names differ in case or zeros alone");
  ExpectContains(WarningOfAlikeNames({"7", "07", "007", "8", "08"}, "landmarks"),
                 "'7' and '07' are taken for two landmarks, and so are 2 more pairs");
  ExpectContains(WarningOfAlikeNames({"Tag-01", "tag-1"}, "landmarks"), "'Tag-01' and 'tag-1'");
  ExpectContains(WarningOfAlikeNames({"0", "000"}, "landmarks"), "'0' and '000'");
  ExpectContains(WarningOfAlikeNames({"6", "12", "6.0"}, "landmarks"), "'6' and '6.0' are taken for two");
  ExpectContains(WarningOfAlikeNames({"60.", "60"}, "landmarks"), "'60.' and '60' are taken for two");
  ExpectContains(WarningOfAlikeNames({"1.50", "01.5"}, "landmarks"), "'1.50' and '01.5' are taken for two");
}

TEST(AlikeNames, OthersDoNot) {
  const std::vector<std::string> names = {"0",    "1",    "10",    "100", "1.5",  "1.05",
                                          "door", "door", "a0",    "a00", "a0.5", "a0.05",
                                          "20.0", "2.01", "6.0.0", "6",   ".0",   "."};
  ExpectContains(WarningOfAlikeNames(names, "landmarks"), "'a0' and 'a00' are taken for two landmarks: ");
  EXPECT_EQ(WarningOfAlikeNames({}, "landmarks"), "");
}

TEST(AlikeNames, AreWarnedOfAtImport) {
  const TestFolder folder;
  CsvImportOptions options;
  options.odometry = folder.Put("o.csv", "time_s,robot,turn_rad,forward_m\n1,anna,0,1\n1,Anna,0,1\n");
  options.observations = folder.Put(
      "s.csv",
      "time_s,robot,landmark,range_m,bearing_rad\n1,anna,door,2,0\n1,anna,arch,2,0\n1,Anna,DOOR,2,0\n");
  Blob log;
  EXPECT_EQ(ImportCsv(options, &log).warnings.size(), 2U);
  ExpectContains(ImportCsv(options, &log).warnings.front(), "'anna' and 'Anna' are taken for two robots");
  ExpectContains(ImportCsv(options, &log).warnings.back(), "'door' and 'DOOR' are taken for two landmarks");
  options.observations = folder.Put(
      "s.csv",
      "time_s,robot,landmark,range_m,bearing_rad\n1,anna,door,2,0\n1,anna,07,2,0\n1,Anna,door,2,0\n");
  options.truth_landmarks = folder.Put("t.csv", "landmark,x_m,y_m\ndoor,1,2\n7,3,4\n");
  ExpectContains(ImportCsv(options, &log).warnings.back(), "'07' and '7' are taken for two landmarks");
}

}  // namespace
}  // namespace cairn::datasets
