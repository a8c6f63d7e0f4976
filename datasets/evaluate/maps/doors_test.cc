#include "datasets/evaluate/maps/doors.h"

#include <gtest/gtest.h>

#include "datasets/evaluate/testing/grid.h"

namespace cairn::datasets {
namespace {

// Cells of 0.1 m; the opening from x = 0.2 to 0.8 m at y = 0.5 m.
double PassageOf(const std::vector<std::string>& rows) {
  const Blob map = DrawnMap(rows, 0.1);
  return PassageM(ReadOccupancy(map), {{0.2, 0.5}, {0.8, 0.5}});
}

TEST(Passage, IsAsWideAsWhatIsFreeFromBeforeToBehindTheOpening) {
  EXPECT_NEAR(PassageOf({"..........", "..........", "..........", "..........", "##......##",  //
                         "##......##", "..........", "..........", "..........", ".........."}),
              0.6, 1e-9);
  EXPECT_NEAR(PassageOf({"..........", "..........", "..........", "..........", "##..##..##",  //
                         "##..##..##", "..........", "..........", "..........", ".........."}),
              0.2, 1e-9);
}

TEST(Passage, IsNoneWhereTheMapIsClosedOrUnknown) {
  EXPECT_EQ(PassageOf({"..........", "..........", "..........", "..........", "##########",  //
                       "..........", "..........", "..........", "..........", ".........."}),
            0);
  EXPECT_EQ(PassageOf({"          ", "          ", "          ", "          ", "##......##",  //
                       "##......##", "..........", "..........", "..........", ".........."}),
            0);
}

// What is open beside the opening does not count, nor what touches at corners only.
TEST(Passage, LeadsThroughTheOpeningItself) {
  EXPECT_EQ(PassageOf({"..........", "..........", "..........", "..........", "..######..",  //
                       "..######..", "..........", "..........", "..........", ".........."}),
            0);
  EXPECT_EQ(PassageOf({"..........", "..........", "..........", "..........", "##...#####",  //
                       "#####...##", "..........", "..........", "..........", ".........."}),
            0);
}

TEST(Passage, OfASlantingDoor) {
  std::vector<std::string> rows(20, std::string(20, '.'));
  const Wall door{{0.6, 1.4}, {1.4, 0.6}};
  EXPECT_GE(PassageM(ReadOccupancy(DrawnMap(rows, 0.1)), door), 0.5);
  for (std::size_t i = 0; i < 20; ++i)  // a diagonal of two cells
    for (std::size_t k : {i, i + 1})
      if (k < 20) rows[i][k] = '#';
  EXPECT_EQ(PassageM(ReadOccupancy(DrawnMap(rows, 0.1)), door), 0);
}

// Its work is that of the map's cells, however wide it is and wherever: seen to run for minutes otherwise.
TEST(Passage, OfADoorFarAwayOrVeryWideIsNoMoreThanTheMap) {
  const std::vector<std::string> rows(200, std::string(200, '.'));
  const Blob map = DrawnMap(rows, 0.1);
  const Occupancy occupancy = ReadOccupancy(map);
  EXPECT_NEAR(PassageM(occupancy, {{-1e9, 10}, {1e9, 10}}), 0.7, 1e-9);
  EXPECT_EQ(PassageM(occupancy, {{0, 1e9}, {1, 1e9}}), 0);
}

}  // namespace
}  // namespace cairn::datasets
