#include "schema/blob.h"

#include <gtest/gtest.h>

namespace cairn {
namespace {

Blob Sample() {
  Blob blob;
  blob.PutVector<double>("robot/0/time_s", {1, 2, 3});
  blob.PutVector<double>("truth/x_m", {4});
  blob.PutScalar<std::int64_t>("count", 3);
  blob.Put("name", Array::Text("museum"));
  return blob;
}

TEST(Blob, GivesFieldsByNameAndNamesWhatIsMissing) {
  const Blob blob = Sample();
  EXPECT_EQ(blob.Get<double>("robot/0/time_s")[2], 3.0);
  EXPECT_EQ(blob.Scalar<std::int64_t>("count"), 3);
  EXPECT_EQ(blob.Text("name"), "museum");
  try {
    blob.Get<double>("robot/1/time_s");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("robot/1/time_s"), std::string::npos);
  }
  EXPECT_THROW(blob.Get<float>("robot/0/time_s"), InputError);
  EXPECT_THROW(blob.Scalar<double>("robot/0/time_s"), InputError);
}

TEST(Blob, CutsAndJoinsSubtrees) {
  const Blob blob = Sample();
  EXPECT_EQ(blob.Sub("robot/0/").fields().size(), 1U);
  EXPECT_FALSE(blob.Without("truth/").Has("truth/x_m"));
  Blob published = blob;
  published.Put("provenance/stage", Array::Text("features"));
  EXPECT_EQ(published.SourceHash(), blob.Without("truth/").ContentHash());
  Blob joined;
  joined.PutAll("log/", blob);
  EXPECT_EQ(joined.Sub("log/").ContentHash(), blob.ContentHash());
}

TEST(Blob, HashDependsOnNameTypeShapeAndData) {
  const Hash hash = Sample().ContentHash();
  EXPECT_EQ(Sample().ContentHash(), hash);
  Blob renamed = Sample();
  renamed.PutAll("x/", Blob());
  EXPECT_EQ(renamed.ContentHash(), hash);
  Blob changed = Sample();
  changed.PutVector<double>("truth/x_m", {5});
  EXPECT_NE(changed.ContentHash(), hash);
  Blob reshaped = Sample();
  reshaped.Put("truth/x_m", Array::Of<double>({1, 1}, std::vector<double>{4}));
  EXPECT_NE(reshaped.ContentHash(), hash);
  Blob retyped = Sample();
  retyped.PutScalar<double>("count", 3);
  EXPECT_NE(retyped.ContentHash(), hash);
}

// A golden value: what is stored today is found by its hash tomorrow. Printed by this test when it was
// written.
TEST(Blob, HashIsStableAcrossVersions) {
  Blob blob;
  blob.PutVector<double>("a/x_m", {1, 2, 3});
  EXPECT_EQ(blob.ContentHash().Hex(), "9292d1d65773fc538a80757b6b468f24");
}

}  // namespace
}  // namespace cairn
