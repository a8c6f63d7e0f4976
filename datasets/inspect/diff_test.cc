#include "datasets/inspect/diff.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "datasets/testing.h"
#include "datasets/testing_result.h"
#include "schema/store/blob_file.h"

namespace cairn::datasets {
namespace {

TEST(DiffBlobs, FindsNothingBetweenEquals) { EXPECT_TRUE(DiffBlobs(SmallResult(), SmallResult()).empty()); }

TEST(DiffBlobs, SaysWhereValuesDifferAndByHowMuch) {
  Blob a, b;
  a.Put("grid", Array::Of<float>({2, 3}, std::vector<float>{1, 2, 3, 4, 5, 6}));
  b.Put("grid", Array::Of<float>({2, 3}, std::vector<float>{1, 2, 3, 4, 5.5, 5}));
  const auto differences = DiffBlobs(a, b);
  ASSERT_EQ(differences.size(), 1U);
  EXPECT_EQ(differences[0].name, "grid");
  EXPECT_EQ(differences[0].what, "values");
  EXPECT_EQ(differences[0].first_index, (std::vector<std::int64_t>{1, 1}));
  EXPECT_EQ(differences[0].a, "5");
  EXPECT_EQ(differences[0].b, "5.5");
  EXPECT_EQ(differences[0].elements, 2);
  EXPECT_EQ(differences[0].largest, 1.0);
}

TEST(DiffBlobs, OfTextsItNamesTheFirstThatDiffers) {
  Blob a, b;
  a.Put("names", Array::Texts({"same", "a"}));
  b.Put("names", Array::Texts({"same", "another text"}));
  const auto differences = DiffBlobs(a, b);
  ASSERT_EQ(differences.size(), 1U);
  EXPECT_EQ(differences[0].what, "values");
  EXPECT_EQ(differences[0].first_index, (std::vector<std::int64_t>{1}));
  ExpectContains(differences[0].b, "another text");
  EXPECT_EQ(differences[0].elements, 1);
  EXPECT_FALSE(differences[0].largest);
}

TEST(DiffBlobs, ItIsBitsThatCount) {
  Blob a, b;
  a.PutVector<double>("x", {0.0, NAN});
  b.PutVector<double>("x", {-0.0, NAN});
  const auto differences = DiffBlobs(a, b);
  ASSERT_EQ(differences.size(), 1U);
  EXPECT_EQ(differences[0].elements, 1);
  EXPECT_EQ(differences[0].b, "-0");
  EXPECT_EQ(differences[0].largest, 0.0);
  b.PutVector<double>("x", {NAN, NAN});
  EXPECT_FALSE(DiffBlobs(a, b)[0].largest.has_value());
}

TEST(DiffBlobs, TellsMissingTypesAndShapesApart) {
  Blob a, b;
  a.PutVector<double>("only_a", {1});
  b.PutVector<double>("only_b", {1});
  a.PutVector<double>("shape", {1, 2});
  b.PutVector<double>("shape", {1});
  a.PutVector<float>("type", {1});
  b.PutVector<double>("type", {1});
  a.Put("text", Array::Texts({"ab"}));
  b.Put("text", Array::Texts({"ac"}));
  const auto differences = DiffBlobs(a, b);
  ASSERT_EQ(differences.size(), 5U);
  EXPECT_EQ(differences[0].what, "only in A");
  EXPECT_EQ(differences[1].what, "only in B");
  EXPECT_EQ(differences[2].what + differences[2].a + differences[2].b, "shape[2][1]");
  EXPECT_EQ(differences[3].a, "'ab'");
  EXPECT_EQ(differences[4].what + differences[4].a + differences[4].b, "typefloat32float64");
}

class DiffPathsTest : public testing::Test {
 protected:
  TestFolder folder_;
  void Put(const std::string& name, const Blob& blob, const std::string& kind = "landmark_map") {
    std::filesystem::create_directories(std::filesystem::path(folder_ / name).parent_path());
    ASSERT_TRUE(WriteBlobFile(folder_ / name, kind, blob).ok());
  }
};

TEST_F(DiffPathsTest, ProvenanceDoesNotCount) {
  Blob a = SmallResult(), b = SmallResult();
  a.PutScalar<double>("provenance/seconds_s", 1);
  b.PutScalar<double>("provenance/seconds_s", 2);
  Put("a.h5", a);
  Put("b.h5", b);
  const Difference difference = DiffPaths(folder_ / "a.h5", folder_ / "b.h5").value();
  EXPECT_TRUE(difference.same());
  EXPECT_EQ(difference.arrays, static_cast<std::int64_t>(SmallResult().fields().size()));
  EXPECT_EQ(DiffText(difference), "the same: " + std::to_string(difference.arrays) + " arrays in 1 file\n");
}

TEST_F(DiffPathsTest, FoldersAreComparedFileByFileWithoutTheirStores) {
  Blob other = SmallResult();
  other.PutVector<double>("map/landmark_x_m", {2, 1.5});
  Put("a/map.h5", SmallResult());
  Put("b/map.h5", other);
  Put("a/deep/same.h5", SmallResult());
  Put("b/deep/same.h5", SmallResult());
  Put("a/only.h5", SmallResult());
  Put("a/.cairn/store.h5", SmallResult());
  folder_.Put("a/notes.txt", "not compared");
  Put("a/kind.h5", Blob(), "log");
  Put("b/kind.h5", Blob(), "blob");
  const Difference difference = DiffPaths(folder_ / "a", folder_ / "b").value();
  EXPECT_EQ(difference.files, 3);
  ASSERT_EQ(difference.differing.size(), 3U);
  EXPECT_EQ(difference.differing[0].problem, "kind: log and blob");
  EXPECT_EQ(difference.differing[1].file, "map.h5");
  EXPECT_EQ(difference.differing[2].problem, "only in A");
  ExpectContains(
      DiffText(difference),
      "map.h5\n  map/landmark_x_m: 1 values differ, the first at [1]: 1 and 1.5, largest difference 0.5\n");
  const auto json = nlohmann::json::parse(DiffJson(difference));
  EXPECT_EQ(json["same"], false);
  EXPECT_EQ(json["differing"][1]["arrays"][0]["largest"], 0.5);
  EXPECT_EQ(json["differing"][1]["arrays"][0]["first_index"], std::vector<int>{1});
}

TEST_F(DiffPathsTest, LinksCountByTheirNameAndWhatIsNoFileIsNotPassedOver) {
  Put("c/n.h5", SmallResult());
  for (const char* folder : {"a", "b"}) {
    std::filesystem::create_directories(folder_ / folder);
    std::filesystem::create_symlink("../c/n.h5", std::filesystem::path(folder_ / folder) / "n.h5");
  }
  const Difference difference = DiffPaths(folder_ / "a", folder_ / "b").value();
  EXPECT_TRUE(difference.same());
  EXPECT_EQ(difference.files, 1);
  for (const char* folder : {"a", "b"})
    std::filesystem::create_symlink("nowhere", std::filesystem::path(folder_ / folder) / "gone.h5");
  EXPECT_FALSE(DiffPaths(folder_ / "a", folder_ / "b").ok());
}

TEST_F(DiffPathsTest, NothingToCompareIsNotTheSame) {
  std::filesystem::create_directories(folder_ / "a");
  std::filesystem::create_directories(folder_ / "b");
  Put("c.h5", SmallResult());
  ExpectContains(InputErrorOf([&] { (void)DiffPaths(folder_ / "a", folder_ / "b"); }),
                 "there are no .h5 files to compare");
  ExpectContains(InputErrorOf([&] { (void)DiffPaths(folder_ / "a", folder_ / "c.h5"); }),
                 "file cannot be compared");
  ExpectContains(InputErrorOf([&] { (void)DiffPaths(folder_ / "x", folder_ / "a"); }),
                 "x: no such file or folder");
}

TEST_F(DiffPathsTest, ADamagedFileIsNamed) {
  Put("a.h5", SmallResult());
  folder_.Put("b.h5", FileText(folder_ / "a.h5").substr(0, 1000));
  const auto difference = DiffPaths(folder_ / "a.h5", folder_ / "b.h5");
  ASSERT_FALSE(difference.ok());
  ExpectContains(difference.status().message(), "b.h5: truncated");
}

}  // namespace
}  // namespace cairn::datasets
