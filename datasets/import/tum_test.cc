#include "datasets/import/tum.h"

#include <cmath>
#include <numbers>

#include "datasets/export/export.h"
#include "datasets/testing.h"
#include "datasets/testing_result.h"

namespace cairn::datasets {
namespace {

class ImportTumTest : public ImportTest {
 protected:
  ImportReport Import(const std::string& text, const std::string& name = "Rosa.tum") {
    log_ = Blob();
    return ImportTum({{folder_.Put(name, text)}, {}, false}, &log_);
  }
  std::string Refusal(const std::string& text) {
    return InputErrorOf([&] { Import(text); });
  }
};

TEST_F(ImportTumTest, QuaternionsAndHeadingsBecomePoses) {
  const double half = std::sqrt(0.5);
  Import("# time x y z\n1 2 3 0 0 0 0 1\n2 3 4 0 0 0 " + std::to_string(half) + " " + std::to_string(-half) +
             "\n",
         "Rosa.txt.gz");
  EXPECT_EQ(log_.Texts("robots"), (std::vector<std::string>{"Rosa"}));
  EXPECT_EQ(Column<double>("robot/0/poses/time_s"), (std::vector<double>{1, 2}));
  EXPECT_EQ(Column<double>("robot/0/poses/x_m"), (std::vector<double>{2, 3}));
  EXPECT_NEAR(Column<double>("robot/0/poses/heading_rad")[1], -std::numbers::pi / 2, 1e-9);
  Import("1 2 3 4\n");
  EXPECT_NEAR(Column<double>("robot/0/poses/heading_rad")[0], 4 - 2 * std::numbers::pi, 1e-12);
}

TEST_F(ImportTumTest, WhatWentOutComesBack) {
  const auto files = ExportTum(SmallResult(), folder_ / "out").value();
  ImportTum({files, {"Rosa", "a b"}, false}, &log_);
  EXPECT_EQ(log_.Texts("robots"), (std::vector<std::string>{"Rosa", "a b"}));
  const Blob result = SmallResult();
  for (const char* robot : {"robot/0/poses/", "robot/1/poses/"}) {
    const std::string prefix = robot;
    const auto heading = result.Get<double>(prefix + "mode_heading_rad");
    const auto back = Column<double>(prefix + "heading_rad");
    ASSERT_EQ(back.size(), heading.size());
    for (std::size_t i = 0; i < back.size(); ++i)
      EXPECT_NEAR(std::remainder(back[i] - heading[i], 2 * M_PI), 0, 1e-12);
    const auto x = result.Get<double>(prefix + "mode_x_m");
    EXPECT_EQ(Column<double>(prefix + "x_m"), (std::vector<double>{x.begin(), x.end()}));
  }
}

TEST_F(ImportTumTest, TiltIsSaidAndBadLinesAreNamed) {
  const ImportReport report = Import("1 0 0 0 0 0 0 1\n2 0 0 2 0.5 0 0 0.8660254\n");
  ASSERT_EQ(report.warnings.size(), 2U);
  ExpectContains(report.warnings[0], "heights differ by 2.0");
  ExpectContains(report.warnings[1], "tilted by up to 60.0");
  ExpectContains(Refusal("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0\n"), "Rosa.tum:2: wrong number of values: 7");
  ExpectContains(Refusal("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 0\n"), "Rosa.tum:2: no quaternion");
  ExpectContains(Refusal("1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"), "Rosa.tum:2: time does not run forward");
  ExpectContains(Refusal("1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"), "are times rounded to whole seconds?");
  ExpectContains(Refusal("1 nan 0 0 0 0 0 1\n"), "Rosa.tum:1: not finite");
  ExpectContains(Refusal("#\n"), "there is no pose in it");
  const std::string file = folder_.Put("a.tum", "1 0 0 0\n");
  ExpectContains(InputErrorOf([&] { ImportTum({{file, file}, {}, false}, &log_); }),
                 "a second robot is called 'a'");
  ExpectContains(InputErrorOf([&] { ImportTum({{file}, {"a", "b"}, false}, &log_); }),
                 "2 names for 1 trajectories");
}

}  // namespace
}  // namespace cairn::datasets
