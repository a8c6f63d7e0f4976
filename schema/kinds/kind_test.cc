#include "schema/kinds/kind.h"

#include <gtest/gtest.h>

namespace cairn {
namespace {

TEST(KindOf, GoesByTheArraysThatAKindMustHave) {
  Blob blob;
  EXPECT_EQ(KindOf(blob), "result");
  blob.PutVector<double>("error", {0});
  EXPECT_EQ(KindOf(blob), "errors");
  blob.PutVector<float>("run/0/input", {0});
  EXPECT_EQ(KindOf(blob), "samples");
  blob.PutVector<double>("robot/0/poses/time_s", {0});
  EXPECT_EQ(KindOf(blob), "poses");
  blob.PutVector<double>("robot/0/odometry/time_s", {0});
  EXPECT_EQ(KindOf(blob), "log");
  blob.PutVector<std::int32_t>("traces/first_z", {});
  EXPECT_EQ(KindOf(blob), "local_map");
  blob.PutVector<std::int32_t>("belief/place", {0});
  EXPECT_EQ(KindOf(blob), "localization");
  blob.PutVector<double>("networks/hidden_weight", {0});
  EXPECT_EQ(KindOf(blob), "networks");
  blob.PutVector<double>("map/grid/probability", {0});
  EXPECT_EQ(KindOf(blob), "grid_map");
  blob.PutVector<double>("map/landmark_x_m", {});
  EXPECT_EQ(KindOf(blob), "landmark_map");
}

TEST(Kinds, AreFoundByNameAndSpokenOf) {
  EXPECT_EQ(Kinds().size(), 9U);
  for (const Kind& kind : Kinds()) EXPECT_EQ(FindKind(kind.name), &kind);
  EXPECT_EQ(FindKind("checkpoint"), nullptr);
  EXPECT_EQ(WithArticle("log"), "a log");
  EXPECT_EQ(WithArticle("samples"), "samples");
  EXPECT_EQ(WithArticle("checkpoint"), "a checkpoint");
  EXPECT_EQ(IsNeeded("log"), "a log is needed");
  EXPECT_EQ(IsNeeded("networks"), "networks are needed");
}

}  // namespace
}  // namespace cairn
