#include "pipelines/common/grid_box.h"

#include <gtest/gtest.h>

#include "schema/error.h"
#include "schema/kinds/fields.h"

namespace cairn {
namespace {

TEST(GridBox, HoldsEveryPointThatItWasMadeForOnMultiplesOfTheCell) {
  Extent extent;
  extent.Add(-1.02, 3.0);
  extent.Add(2.5, -0.49);
  const GridBox box = extent.ToGrid(0.25, 1e6);
  EXPECT_DOUBLE_EQ(box.origin_x_m, -1.25);
  EXPECT_DOUBLE_EQ(box.origin_y_m, -0.5);
  EXPECT_EQ(box.columns, 16);  // -1.25 to 2.75: the point at 2.5 begins a cell
  EXPECT_EQ(box.rows, 15);
  for (const auto& [x, y] : {std::pair{-1.02, 3.0}, {2.5, -0.49}})
    EXPECT_TRUE(box.Holds(box.ColumnOf(x), box.RowOf(y)));
  EXPECT_FALSE(box.Holds(box.ColumnOf(-1.26), 0));
  EXPECT_DOUBLE_EQ(box.CentreX(0), -1.125);
}

TEST(GridBox, MoreCellsThanAllowedAreRefusedWithTheirNumber) {
  Extent extent;
  extent.Add(0, 0);
  extent.Add(100, 100);
  try {
    extent.ToGrid(0.01, 1e6);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("1e+08 cells of 0.01 m"), std::string::npos) << error.what();
  }
}

TEST(GridBox, AnExtentIsFourNumbersLowerLeftFirst) {
  const Extent extent = ParseExtent("box_m", "-1, 2,3.5,4");
  EXPECT_EQ(extent.x0_m(), -1);
  EXPECT_EQ(extent.y1_m(), 4);
  for (const char* bad : {"", "1,2,3", "1,2,3,4,5", "3,2,1,4", "1,2,x,4", "1,2,3,nan", "0,0,1,1e999"})
    EXPECT_THROW(ParseExtent("box_m", bad), InputError) << bad;
}

TEST(GridBox, ComesBackFromABlob) {
  Blob blob;
  PutFields("grid/", GridBox{-1, 2, 0.5, 7, 9}, &blob);
  const GridBox box = FieldsIn<GridBox>("grid/", blob);
  EXPECT_EQ(box.origin_y_m, 2);
  EXPECT_EQ(box.columns, 7);
  EXPECT_EQ(box.rows, 9);
}

}  // namespace
}  // namespace cairn
