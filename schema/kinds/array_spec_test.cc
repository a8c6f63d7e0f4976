#include "schema/kinds/array_spec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace cairn {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

constexpr ArraySpec kToy[] = {
    {"robots", "R", DType::kText},
    {"robot/N/time_s", "C", DType::kF64, Rising()},
    {"robot/N/x_m", "C", DType::kF64, Position()},
    {"robot/N/SENSOR/range_m", "K,B", DType::kF64, From(0).OrNan()},
    {"robot/N/SENSOR/beam_rad", "B", DType::kF64, Finite()},
    {"robot/N/track/time_s", "H", DType::kF64, Rising(), true},
    {"robot/N/track/length_m", "H", DType::kF64, Position(), true},
    {"robot/N/track/width_m", "H", DType::kF64, Position()},
    {"robot/N/friend", "F", DType::kI32, IndexInto("robots").OrNone()},
    {"walls/x_m", "W,2", DType::kF64, Position()},
    {"parts/rows", "Q", DType::kI64, RowsOf("part/share")},
    {"part/share", "S", DType::kF32, Share()},
    {"cell_m", "", DType::kF64, Positive()},
    {"share", "V", DType::kF64, Share()},
    {"likelihood", "I", DType::kF64, Free()},
};

// Two robots of different lengths, each sensor with beams of its own.
Blob Good() {
  Blob blob;
  blob.Put("robots", Array::Texts({"anna", "bert"}));
  blob.PutVector<double>("robot/0/time_s", {0, 1, 1});
  blob.PutVector<double>("robot/0/x_m", {0, 1, 2});
  blob.PutVector<double>("robot/1/time_s", {5});
  blob.PutVector<double>("robot/1/x_m", {7});
  blob.PutVector<std::int32_t>("robot/1/friend", {0, -1, 1});
  blob.Put("robot/0/sonar/range_m", Array::Of<double>({2, 3}, std::vector<double>{1, kNan, 3, 4, 5, 0}));
  blob.PutVector<double>("robot/0/sonar/beam_rad", {0, 1, 2});
  blob.Put("robot/0/laser2/range_m", Array::Of<double>({1, 1}, std::vector<double>{1}));
  blob.PutVector<double>("robot/0/laser2/beam_rad", {0});
  blob.Put("walls/x_m", Array::Of<double>({1, 2}, std::vector<double>{0, 1}));
  blob.PutVector<std::int64_t>("parts/rows", {2, 0, 1});
  blob.PutVector<float>("part/share", {0, 0.5F, 1});
  blob.PutScalar<double>("cell_m", 0.1);
  blob.PutVector<double>("likelihood", {-std::numeric_limits<double>::infinity(), kNan});
  return blob;
}

std::string WhyNot(const Blob& blob) {
  try {
    CheckArrays(blob, kToy);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

template <class T>
std::string With(const std::string& name, const std::vector<T>& values) {
  Blob blob = Good();
  blob.PutVector(name, values);
  return WhyNot(blob);
}

TEST(CheckArrays, TakesWhatFitsAndWhatIsNotThere) {
  EXPECT_EQ(WhyNot(Good()), "");
  EXPECT_EQ(WhyNot({}), "");
  Blob other = Good();
  other.PutVector<double>("of/somebody/else", {kNan});
  EXPECT_EQ(WhyNot(other), "");
  EXPECT_EQ(With<double>("share", {1 + 1e-15, -1e-15}), "");  // as rounding leaves it
  Blob scalar = Good();
  scalar.PutVector<double>("cell_m", {0.1});  // as some programs write a number
  EXPECT_EQ(WhyNot(scalar), "");
}

TEST(CheckArrays, RefusesTypesAndShapesThatDoNotFit) {
  EXPECT_EQ(With<float>("robot/0/x_m", {0, 1, 2}),
            "'robot/0/x_m' is of type float32, where float64 is needed");
  EXPECT_EQ(With<double>("robot/0/x_m", {0, 1}),
            "'robot/0/x_m' has the shape [2], where [C] is needed: C is 3 by 'robot/0/time_s'");
  EXPECT_EQ(With<double>("robot/0/laser2/beam_rad", {0, 1}),
            "'robot/0/laser2/beam_rad' has the shape [2], where [B] is needed: B is 1 by "
            "'robot/0/laser2/range_m'");
  EXPECT_EQ(With<double>("walls/x_m", {0, 1}), "'walls/x_m' has the shape [2], where [W,2] is needed");
  EXPECT_EQ(With<double>("cell_m", {1, 2}), "'cell_m' has the shape [2], where [] is needed");
  Blob walls = Good();
  walls.Put("walls/x_m", Array::Of<double>({1, 3}, std::vector<double>{0, 1, 2}));
  EXPECT_EQ(WhyNot(walls), "'walls/x_m' has the shape [1,3], where [W,2] is needed");
}

// A table that lacks a column; a group may stand in its place, which is no array.
TEST(CheckArrays, RefusesATableThatLacksWhatItNeeds) {
  const std::string why =
      "there is no 'robot/1/track/length_m', which 'robot/1/track/time_s' needs beside it";
  Blob blob = Good();
  blob.PutVector<double>("robot/1/track/width_m", {0, 1});
  EXPECT_EQ(WhyNot(blob), "");
  blob.PutVector<double>("robot/1/track/time_s", {0, 1});
  EXPECT_EQ(WhyNot(blob), why);
  blob.PutVector<double>("robot/1/track/length_m/x", {0, 1});
  EXPECT_EQ(WhyNot(blob), why);
  Blob whole = Good();
  whole.PutVector<double>("robot/1/track/time_s", {0, 1});
  whole.PutVector<double>("robot/1/track/length_m", {0, 1});
  EXPECT_EQ(WhyNot(whole), "");
}

TEST(CheckArrays, RefusesValuesThatMayNotBe) {
  EXPECT_EQ(
      With<double>("robot/0/time_s", {0, 2, 1}),
      "'robot/0/time_s', entry 2: 1 after 2, where the numbers must not fall (does time run backwards?)");
  EXPECT_EQ(With<double>("robot/0/time_s", {0, kNan, 1}),
            "'robot/0/time_s', entry 1: nan, where a finite number is needed");
  EXPECT_EQ(With<double>("robot/0/x_m", {0, 1, 2e9}),
            "'robot/0/x_m', entry 2: 2000000000, where -1e+09 to 1e+09 is needed");
  EXPECT_EQ(With<std::int32_t>("robot/1/friend", {0, 2}),
            "'robot/1/friend', entry 1: 2, where a row of 'robots', which has 2, or -1 for none, is needed");
  EXPECT_EQ(With<std::int32_t>("robot/1/friend", {-2}),
            "'robot/1/friend': -2, where a row of 'robots', which has 2, or -1 for none, is needed");
  EXPECT_EQ(With<float>("part/share", {0, 1.5F, 1}), "'part/share', entry 1: 1.5, where 0 to 1 is needed");
  EXPECT_EQ(With<double>("cell_m", {0}), "'cell_m': 0, where a number above 0, to 1e+09 is needed");
  EXPECT_EQ(With<double>("cell_m", {HUGE_VAL}), "'cell_m': inf, where a number above 0, to 1e+09 is needed");
  EXPECT_EQ(With<double>("cell_m", {1e300}), "'cell_m': 1e+300, where a number above 0, to 1e+09 is needed")
      << "workers died of it";
  Blob ranges = Good();
  ranges.Put("robot/0/laser2/range_m", Array::Of<double>({1, 1}, std::vector<double>{-1}));
  EXPECT_EQ(WhyNot(ranges), "'robot/0/laser2/range_m': -1, where 0 or more or NaN is needed");
}

TEST(CheckArrays, RefusesRowsThatDoNotAddUp) {
  const std::string why = "'parts/rows' takes 4 rows of 'part/share' all together, which has 3";
  EXPECT_EQ(With<std::int64_t>("parts/rows", {2, 0, 2}), why);
  EXPECT_EQ(With<std::int64_t>("parts/rows", {4, -1}),
            "'parts/rows', entry 1: -1, where 0 or more is needed");
  const std::int64_t far = std::numeric_limits<std::int64_t>::max();
  EXPECT_NE(With<std::int64_t>("parts/rows", {far, far, 5}), "");  // 3, in numbers that overflow
}

TEST(CheckArrays, RefusesArraysOfNobody) {
  EXPECT_EQ(With<double>("robot/7/time_s", {2}), "'robot/7/time_s': there is no robot 7: 'robots' has 2");
  EXPECT_NE(With<double>("robot/x/sonar/range_m", {2}), "");
  EXPECT_NE(With<double>("robot/00000000000/time_s", {2}), "");
  Blob nameless;
  nameless.PutVector<double>("robot/0/time_s", {2});
  EXPECT_EQ(WhyNot(nameless), "'robot/0/time_s': there is no robot 0: 'robots' has 0");
}

TEST(CheckArrays, RefusesIndicesIntoWhatIsMissing) {
  Blob blob;
  blob.PutVector<std::int64_t>("parts/rows", {1});
  EXPECT_EQ(WhyNot(blob), "'parts/rows' takes 1 rows of 'part/share' all together, which has 0");
}

}  // namespace
}  // namespace cairn
