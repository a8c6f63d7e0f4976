// What the arrays of a kind of file look like: the tables of schema/FORMAT.md, as data.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include "schema/blob.h"

namespace cairn {

// Which numbers an array may hold. Infinity never; other limits by what is set.
struct Values {
  double least = -std::numeric_limits<double>::max();
  double most = std::numeric_limits<double>::max();
  double slack = 0;  // by which a number that was added up may be off
  bool may_be_nan = false;
  bool rises = false;  // none is less than the one before it
  // The array whose rows the numbers name, from 0; `least` is -1 where they may name none.
  std::string_view index_into = {};
  std::string_view rows_of = {};  // the array of whose rows each number takes so many: they add up to all
  bool is_free = false;           // anything goes

  constexpr Values OrNan() const {
    Values values = *this;
    values.may_be_nan = true;
    return values;
  }
  constexpr Values OrNone() const {
    Values values = *this;
    values.least = -1;
    return values;
  }
};

constexpr Values Free() { return {.is_free = true}; }
constexpr Values Finite() { return {}; }
constexpr Values Rising() { return {.rises = true}; }
constexpr Values Between(double least, double most) { return {.least = least, .most = most}; }
constexpr Values From(double least) { return {.least = least}; }
// What is measured or assumed: no length, spread or ratio of a robot's is larger.
constexpr Values NotNegative() { return Between(0, 1e9); }
constexpr Values Positive() { return Between(std::numeric_limits<double>::denorm_min(), 1e9); }
constexpr Values Above0() { return {.least = std::numeric_limits<double>::denorm_min()}; }
constexpr Values Share() { return {.least = 0, .most = 1, .slack = 1e-9}; }
constexpr Values YesNo() { return Between(0, 1); }
// How far a sensor measures, m: of one that reaches further nobody has heard.
constexpr Values Reach() { return Between(std::numeric_limits<double>::denorm_min(), 1e4); }
// As it is measured, or added up over many turns.
constexpr Values Angle() { return Between(-1e9, 1e9); }
// A coordinate that something has on a map, m.
constexpr Values Position() { return Between(-1e9, 1e9); }
constexpr Values IndexInto(std::string_view array) { return {.least = 0, .index_into = array}; }
constexpr Values RowsOf(std::string_view array) { return {.least = 0, .rows_of = array}; }

// One array, or one of each robot, run or sensor.
struct ArraySpec {
  // A path. In "robot/N/…" and "run/N/…" N counts `robots` and `runs`; SENSOR is any of those that measure
  // ranges (kRangeSensors).
  std::string_view name;
  // The axes, by commas: a number, or a letter. A letter is the same number wherever it stands; one that is
  // first met in an array of a robot, a run or a sensor is the same within that one.
  std::string_view shape;
  DType type;
  Values values = {};
  bool is_needed = false;  // wherever another needed array of its group is there
};

inline constexpr std::string_view kRangeSensors[] = {"sonar",  "infrared", "laser", "laser2",
                                                     "laser3", "laser4",   "laser5"};

// Checks those of the arrays that are there, and that none is missing that another of its group needs beside
// it; whoever needs a whole group says that it is missing.
// Throws InputError that names the array, the entry and what is allowed.
void CheckArrays(const Blob& blob, std::span<const ArraySpec> specs);

}  // namespace cairn
