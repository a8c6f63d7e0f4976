#include "datasets/import/repeated_rows.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "datasets/import/row_times.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

using Step = std::pair<double, double>;

// Of pairs of rows of motion: how many there are, and of how many both are the same.
struct Pairs {
  double all = 0, same = 0;
  double Share() const { return same / all; }
};

double Choose2(double n) { return n * (n - 1) / 2; }

// A step that only turns tells nothing: Cairn's own tables have half of each turn before the way and half
// after it, so that of a turn on the spot both are the same. It is there twice where ways are about it.
struct StepsOfTimes {
  Pairs within, across;               // rows of one time; of one and the next
  std::size_t times = 0, with = 0;    // all that have motion, those with repeated steps
  std::size_t most = 0;               // so often a step is there at one time
  std::vector<std::size_t> repeated;  // rows
  std::size_t first = 0, second = 0;  // the first two rows that are the same

  explicit StepsOfTimes(const Odometry& odometry) {
    std::map<Step, std::size_t> before, now;
    std::map<double, std::vector<std::size_t>> turns;  // of one time
    std::vector<std::size_t> turns_at_first;           // before any way
    double count = 0, count_before = 0;
    bool is_doubled = false;  // the last time with a way
    const auto take_turns = [&] {
      for (const auto& [turn_rad, rows] : turns)
        for (std::size_t k = rows.size() - rows.size() / 2; k < rows.size(); ++k)
          if (times == 0)
            turns_at_first.push_back(rows[k]);
          else if (is_doubled)
            repeated.push_back(rows[k]);
      turns.clear();
    };
    const auto end_time = [&] {
      if (count == 0) return take_turns();
      ++times;
      within.all += Choose2(count);
      across.all += count * count_before;
      bool repeats = false;
      for (const auto& [step, n] : now) {
        const auto same = before.find(step);
        within.same += Choose2(static_cast<double>(n));
        if (same != before.end()) across.same += static_cast<double>(n * same->second);
        most = std::max(most, n);
        repeats = repeats || n > 1;
      }
      with += repeats ? 1 : 0;
      is_doubled = repeats;
      take_turns();
      if (times == 1 && is_doubled) std::ranges::copy(turns_at_first, std::back_inserter(repeated));
      before = std::exchange(now, {});
      count_before = std::exchange(count, 0);
    };
    for (std::size_t i = 0; i < odometry.time_s.size(); ++i) {
      if (i > 0 && odometry.time_s[i] != odometry.time_s[i - 1]) end_time();
      const Step step(odometry.turn_rad[i], odometry.forward_m[i]);
      if (step == Step(0, 0)) continue;
      if (step.second == 0) {
        turns[step.first].push_back(i);
        continue;
      }
      ++count;
      if (++now[step] == 1) continue;
      if (first == second) first = FirstOf(odometry, i), second = i;
      repeated.push_back(i);
    }
    end_time();
    std::ranges::sort(repeated);
  }

  static std::size_t FirstOf(const Odometry& odometry, std::size_t row) {
    std::size_t first = row - 1;
    while (odometry.turn_rad[first] != odometry.turn_rad[row] ||
           odometry.forward_m[first] != odometry.forward_m[row])
      --first;
    return first;
  }

  RepeatedSteps What(bool whole_seconds) const {
    constexpr std::size_t kMostCopies = 3;
    constexpr double kOftener = 4, kAsOften = 2, kLeastOthers = 10;
    const double by_chance = (across.same + 1) / (across.all + 1);
    const bool all_same = within.same == within.all;
    if (!all_same && within.Share() <= kAsOften * by_chance) return RepeatedSteps::kMotion;
    if (most > kMostCopies) return whole_seconds ? RepeatedSteps::kMotion : RepeatedSteps::kDetect;
    if (whole_seconds && with == times) return RepeatedSteps::kDetect;
    const bool tell_apart = all_same && (1 - by_chance) * within.all >= kLeastOthers;
    return tell_apart || within.Share() >= kOftener * by_chance ? RepeatedSteps::kCopies
                                                                : RepeatedSteps::kDetect;
  }
};

}  // namespace

std::string SameAsEarlier(const std::string& what) { return what + " that is the same as an earlier one"; }

bool RepeatedRows::Is(const std::string& robot, double time_s, std::vector<double> row) {
  auto& [last, rows] = at_a_time_[robot];
  if (time_s != last) rows.clear();
  last = time_s;
  for (double& value : row)  // which has an order
    if (std::isnan(value)) value = INFINITY;
  if (rows.insert(std::move(row)).second) return false;
  ++report_->dropped[what_];
  return true;
}

void LeaveOutRepeatedSteps(const std::string& who, RepeatedSteps are, Odometry* odometry,
                           ImportReport* report) {
  const StepsOfTimes steps(*odometry);
  if (steps.repeated.empty()) return;
  if (are == RepeatedSteps::kDetect) are = steps.What(AreWholeSeconds(odometry->time_s));
  if (are == RepeatedSteps::kMotion) return;
  if (are == RepeatedSteps::kDetect)
    throw InputError(
        odometry->from.Of(steps.second) + who + ": the row is the same as that of line " +
        std::to_string(odometry->from.line[steps.first]) + ", of the same time, as are " +
        std::to_string(steps.repeated.size()) + " of its " + std::to_string(odometry->time_s.size()) +
        " rows. If they are there twice (files that overlap, or one given twice), --drop-repeats leaves them "
        "out; if the robot did move so again within one time stamp, --keep-repeats counts all");
  for (SpooledRows<double>* column : {&odometry->time_s, &odometry->turn_rad, &odometry->forward_m})
    RemoveRows(steps.repeated, column);
  RemoveRows(steps.repeated, &odometry->from.line);
  report->dropped[SameAsEarlier(kRowOfOdometry)] += static_cast<std::int64_t>(steps.repeated.size());
}

}  // namespace cairn::datasets
