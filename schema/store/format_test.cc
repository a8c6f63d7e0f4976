// schema/FORMAT.md says what the code does: its table of units, and its h5py example.
#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "schema/store/atomic_file.h"
#include "schema/store/blob_file.h"
#include "schema/store/layout.h"
#include "schema/store/testing.h"

namespace cairn {
namespace {

using store_testing::TempFolder;
using store_testing::Text;

std::string Page() { return Text(CAIRN_FORMAT_MD); }

// Debian's own first: another one on the path seldom has Debian's packages.
std::string PythonWithH5py() {
  for (const std::string python : {"/usr/bin/python3", "python3"}) {
    if (std::system((python + " -c 'import h5py, numpy' 2>/dev/null").c_str()) == 0) return python;
  }
  return {};
}

Blob SmallLandmarkMap() {
  Blob blob;
  blob.Put("robots", Array::Texts({"Rosa", "Grüß"}));
  for (const char* robot : {"robot/0/poses/", "robot/1/poses/"}) {
    blob.PutVector<double>(robot + std::string("x_m"), {0, 3, 3});
    blob.PutVector<double>(robot + std::string("y_m"), {0, 4, 5.5});
  }
  blob.PutVector<double>("map/landmark_x_m", {1, 2, 3, 4});
  blob.PutScalar<double>("map/grid/cell_m", 0.5);
  blob.Put("map/grid/probability", Array::Of<float>({1, 3, 4}, std::vector<float>(12)));
  return blob;
}

TEST(FormatPage, ItsTableOfUnitsIsTheCodes) {
  std::istringstream lines(Page());
  int rows = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("| `_")) continue;
    const std::string ending = line.substr(3, line.find('`', 3) - 3);
    const std::size_t unit = line.find('`', line.find('|', 3)) + 1;
    EXPECT_EQ(store::UnitOf("group/name" + ending), line.substr(unit, line.find('`', unit) - unit)) << line;
    ++rows;
  }
  EXPECT_GE(rows, 15);
}

TEST(FormatPage, ItsH5pyExampleRuns) {
  const std::string python = PythonWithH5py();
  if (python.empty()) GTEST_SKIP() << "python3-h5py is missing";
  const std::string page = Page();
  const std::size_t begin = page.find("```python\n") + 10;
  const std::string example = page.substr(begin, page.find("```", begin) - begin);
  ASSERT_NE(example.find("h5py.File"), std::string::npos);
  const TempFolder folder;
  ASSERT_TRUE(WriteTextAtomically(folder / "example.py", example).ok());
  ASSERT_TRUE(WriteBlobFile(folder / "result.h5", "landmark_map", SmallLandmarkMap()).ok());
  const std::string in_folder = "cd '" + (folder / "").string() + "' && ";
  ASSERT_EQ(std::system((in_folder + "PYTHONIOENCODING=utf-8 " + python + " example.py > out.txt").c_str()),
            0);
  EXPECT_EQ(Text(folder / "out.txt"),
            "Rosa: 3 poses, 6.50 m\nGrüß: 3 poses, 6.50 m\n4 landmarks, x in m\nmap of 2 x 1.5 m\n");
  const Result<BlobFile> log = ReadBlobFile(folder / "log.h5");
  ASSERT_TRUE(log.ok()) << log.status().message();
  EXPECT_EQ(log.value().kind, "log");
  const Blob& blob = log.value().blob;
  EXPECT_EQ(blob.Texts("robots"), std::vector<std::string>{"rover"});
  EXPECT_TRUE(blob.Texts("landmarks").empty());
  EXPECT_EQ(blob.Get<std::int32_t>("robot/0/observations/landmark")[1], -1);
  EXPECT_EQ(blob.Get<double>("robot/0/odometry/forward_m").size(), 2U);
  EXPECT_EQ(blob.Scalar<double>("noise/contact_m"), 0.3);
}

}  // namespace
}  // namespace cairn
