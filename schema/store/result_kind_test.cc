#include "schema/store/result_kind.h"

#include <gtest/gtest.h>

namespace cairn {
namespace {

TEST(ResultKind, GoesByTheArraysThatAKindMustHave) {
  Blob blob;
  EXPECT_EQ(ResultKind(blob), "result");
  blob.PutVector<float>("run/0/input", {0});
  EXPECT_EQ(ResultKind(blob), "samples");
  blob.PutVector<double>("robot/0/poses/time_s", {0});
  EXPECT_EQ(ResultKind(blob), "poses");
  blob.PutVector<std::int32_t>("traces/first_z", {});
  EXPECT_EQ(ResultKind(blob), "local_map");
  blob.PutVector<std::int32_t>("belief/place", {0});
  EXPECT_EQ(ResultKind(blob), "localization");
  blob.PutVector<double>("networks/hidden_weight", {0});
  EXPECT_EQ(ResultKind(blob), "networks");
  blob.PutVector<double>("map/grid/probability", {0});
  EXPECT_EQ(ResultKind(blob), "grid_map");
  blob.PutVector<double>("map/landmark_x_m", {});
  EXPECT_EQ(ResultKind(blob), "landmark_map");
}

}  // namespace
}  // namespace cairn
