#include "datasets/evaluate/clock.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "datasets/evaluate/matching/similarity.h"

namespace cairn::datasets {
namespace {

constexpr double kMost_s = 300, kStep_s = 0.5, kFinest_s = 0.01, kAround_s = 30;
constexpr double kTimesBetter = 3, kLeastOff_m = 0.1, kLeastShift_s = 0.2;
constexpr std::size_t kLeastPoses = 20, kMostPoses = 1000;

struct Fit {
  double shift_s = 0, rmse_m = 0;
  std::size_t poses = 0;
};

// Each `every`-th pose of the paths against the truth at its time.
Fit FitAt(const std::vector<TrackAndTruth>& robots, std::size_t every, double shift_s) {
  std::vector<PointPair> pairs;
  for (const auto& [path, truth] : robots) {
    for (std::size_t i = 0; i < path.time_s.size(); i += every) {
      const auto at = PoseAt(truth, path.time_s[i] - shift_s);
      if (at) pairs.push_back({{path.poses[i].x_m, path.poses[i].y_m}, {at->x_m, at->y_m}});
    }
  }
  return {shift_s, pairs.empty() ? 0 : RmseM(pairs, FitRigid(pairs)), pairs.size()};
}

// Shifts about `middle_s`, the step of the first search apart.
void AddShifts(double middle_s, double around_s, std::vector<double>* shifts_s) {
  const int steps = static_cast<int>(around_s / kStep_s);
  for (int k = -steps; k <= steps; ++k) shifts_s->push_back(middle_s + k * kStep_s);
}

std::vector<double> ShiftsToTry(const std::vector<TrackAndTruth>& robots, bool share_times) {
  std::vector<double> shifts_s;
  AddShifts(0, kMost_s, &shifts_s);
  if (share_times) return shifts_s;
  for (const auto& [path, truth] : robots) {
    if (path.time_s.empty() || truth.time_s.empty()) continue;
    for (const double meets_s :
         {path.time_s.front() - truth.time_s.front(), path.time_s.back() - truth.time_s.back()})
      AddShifts(meets_s, kAround_s, &shifts_s);
    break;  // one shift for all
  }
  return shifts_s;
}

}  // namespace

std::string OtherClock::Text() const {
  return fmt::format(
      "with the truth's times moved by {:.2f} s the paths would be {:.3f} m off: is its clock another?",
      shift_s, rmse_m);
}

std::optional<OtherClock> FindOtherClock(const std::vector<TrackAndTruth>& robots) {
  std::size_t all = 0;
  for (const TrackAndTruth& robot : robots)
    if (!robot.truth.time_s.empty()) all += robot.path.time_s.size();
  const std::size_t every = 1 + all / kMostPoses;
  const Fit now = FitAt(robots, every, 0);
  const bool share_times = 2 * now.poses * every >= all;
  if (now.poses >= kLeastPoses && now.rmse_m < kLeastOff_m) return std::nullopt;
  const std::size_t least = std::max(kLeastPoses, 4 * now.poses / 5);
  std::optional<Fit> best;
  const auto look_at = [&](double shift_s) {
    const Fit fit = FitAt(robots, every, shift_s);
    if (fit.poses >= least && (!best || fit.rmse_m < best->rmse_m)) best = fit;
  };
  for (const double shift_s : ShiftsToTry(robots, share_times)) look_at(shift_s);
  if (!best) return std::nullopt;
  for (double step_s = kStep_s / 2; step_s >= kFinest_s; step_s /= 2) {
    const double around_s = best->shift_s;
    for (const double shift_s : {around_s - step_s, around_s + step_s}) look_at(shift_s);
  }
  const bool better = now.poses == 0 || best->rmse_m * kTimesBetter < now.rmse_m;
  if (!better || std::abs(best->shift_s) < kLeastShift_s) return std::nullopt;
  return OtherClock{best->shift_s, best->rmse_m};
}

void AddClock(const std::optional<OtherClock>& clock, Scores* scores) {
  scores->AddForPrograms("trajectory.clock_shift_s", clock ? ScoreValue(clock->shift_s) : ScoreValue());
  scores->AddForPrograms("trajectory.clock_shift_rmse_m", clock ? ScoreValue(clock->rmse_m) : ScoreValue());
  if (clock) scores->AddForPeople("trajectory.clock", clock->Text());
}

}  // namespace cairn::datasets
