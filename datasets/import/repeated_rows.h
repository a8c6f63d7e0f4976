// Rows that stand in a log twice, for two files that overlap were put together, or one was with itself. No
// sensor measures the same twice, and what it said once must not count twice.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "datasets/import/log_rows.h"

namespace cairn::datasets {

inline constexpr char kRowOfOdometry[] = "row of odometry";
// What the report calls what was left out: "row of odometry that is the same as an earlier one".
std::string SameAsEarlier(const std::string& what);

// Rows that come in the order of time, of each robot.
class RepeatedRows {
 public:
  RepeatedRows(std::string what, ImportReport* report) : what_(SameAsEarlier(what)), report_(report) {}
  // Whether the robot has had this row at this time; counts it then. NaN is the same as NaN.
  bool Is(const std::string& robot, double time_s, std::vector<double> row);

 private:
  std::string what_;
  ImportReport* report_;
  std::map<std::string, std::pair<double, std::set<std::vector<double>>>> at_a_time_;  // the last one
};

// Takes rows of these numbers, which rise, out of a column.
template <class T>
void RemoveRows(const std::vector<std::size_t>& numbers, SpooledRows<T>* column) {
  auto next = numbers.begin();
  std::size_t row = 0;
  column->EraseIf([&](const T&) {
    const bool is_gone = next != numbers.end() && *next == row++;
    if (is_gone) ++next;
    return is_gone;
  });
}

// What to take the steps for that are the same as an earlier one of their time: copies, which are left out;
// or motion of a robot that did so twice within what its clock tells apart.
enum class RepeatedSteps { kDetect, kCopies, kMotion };

// Leaves out, and counts, those that are copies. Where the clock is coarse, rows of one time are as often the
// same as those of one time and the next: then they are motion. They are copies where they are so four times
// as often; or where all rows of any one time are the same, and those of different times are not. Throws
// InputError "FILE:LINE: `who`: …" where neither is so; where a step is there more than three times (but
// of whole seconds, where that is motion), or at every time, all of them whole seconds. Of steps that only
// turn half are copies where steps with a way are, at their time or the one before.
void LeaveOutRepeatedSteps(const std::string& who, RepeatedSteps are, Odometry* odometry,
                           ImportReport* report);

}  // namespace cairn::datasets
