#include "pipelines/local_map/traces/recorder.h"

#include <algorithm>
#include <cmath>

namespace cairn::local_map {
namespace {

// Distances that differ by more cells than that are of different edges.
constexpr double kSameCells = 1.2;

bool Same(const Side& a, const Side& b, double cell_m) {
  const bool near = std::abs(a.distance_m.centre() - b.distance_m.centre()) <= kSameCells * cell_m;
  const float turned = a.angle_rad.centre() - b.angle_rad.centre();
  return near && std::abs(std::remainder(turned, std::numbers::pi_v<float>)) < std::numbers::pi_v<float> / 6;
}

// Moves both ends by 1 / n of their differences: the mean of the intervals, once n counts them.
void MoveTowards(Interval& mean, const Interval& now, float offset, int n) {
  mean.low += (now.low + offset - mean.low) / static_cast<float>(n);
  mean.high += (now.high + offset - mean.high) / static_cast<float>(n);
}

}  // namespace

TraceRecorder::TraceRecorder(const LocalGrids& grids, const RecorderOptions& options)
    : options_(options), trace_(grids.edges().cell_m(), 0, options.capacity) {
  votes_.reserve(options.capacity);
}

void TraceRecorder::Begin(const LocalGrids& grids, double time_s) {
  const double quarters = grids.pose().heading_rad / (std::numbers::pi / 2);
  const auto whole = static_cast<int>(std::lround(std::remainder(quarters, 4)));
  frame_ = {(whole + 4) % 4, grids.edges().centre()};
  heading_rad_ = frame_.quarter * std::numbers::pi / 2;
  frame_rad_ = grids.frame_rad();
  trace_.Restart(grids.edges().cell_m(), -grids.edges().half());
  votes_.clear();
  still_since_s_ = time_s;
  still_at_ = RobotAt(grids);
  begun_z_m_ = least_z_m_ = most_z_m_ = still_at_.z_m;
}

Position TraceRecorder::RobotAt(const LocalGrids& grids) const {
  return frame_.At({grids.pose().x_m, grids.pose().y_m}, trace_.cell_m());
}

TraceEnd TraceRecorder::Update(const LocalGrids& grids, double time_s, bool hint) {
  const TraceEnd end = hint ? TraceEnd::kHint : EndOf(grids, time_s);
  if (end != TraceEnd::kNone && end != TraceEnd::kBlocked && end != TraceEnd::kHint) return end;
  const auto at = static_cast<int>(std::lround(RobotAt(grids).z_m / trace_.cell_m()));
  const int half = grids.edges().half();
  for (int z = at - half; z <= at + half; ++z) {
    const int first = trace_.first_z();
    Feature* feature = trace_.Touch(z);
    if (!feature) continue;
    votes_.insert(votes_.begin(), static_cast<std::size_t>(first - trace_.first_z()), FeatureVotes());
    votes_.resize(trace_.features().size());
    FeatureVotes& votes = votes_[static_cast<std::size_t>(z - trace_.first_z())];
    const Feature now = ColumnOf(grids, frame_, z);
    // [DM98] section 4.1: the edge grid is superposed onto the trace at every cycle.
    Merge(feature->left, votes.left, now.left);
    Merge(feature->right, votes.right, now.right);
  }
  return end;
}

// A running mean that another edge must outvote (as in R. S. Boyer and J. S. Moore's majority vote): persons
// and spurious edges leave no trace, and the intervals do not grow with time.
void TraceRecorder::Merge(Side& side, Votes& votes, const Side& now) const {
  if (now.known()) {
    if (side.known() && Same(side, now, trace_.cell_m())) {
      votes.along = std::min(votes.along + 1, options_.votes);
      const float turned = now.angle_rad.centre() - side.angle_rad.centre();
      MoveTowards(side.angle_rad, now.angle_rad, std::remainder(turned, std::numbers::pi_v<float>) - turned,
                  votes.along);
      MoveTowards(side.distance_m, now.distance_m, 0, votes.along);
    } else if (--votes.along < 0) {
      side.angle_rad = now.angle_rad;
      side.distance_m = now.distance_m;
      votes.along = 1;
    }
    votes.occupied = std::clamp(votes.occupied + (now.occupied ? 1 : -1), -options_.votes, options_.votes);
    side.occupied = votes.occupied > 0 ? 1 : 0;
  }
  if (now.cross_m != now.cross_m) return;
  if (votes.cross == 0) side.cross_m = now.cross_m;
  votes.cross = std::min(votes.cross + 1, options_.votes);
  const auto n = static_cast<float>(votes.cross);
  side.cross_m += (now.cross_m - side.cross_m) / n;
  side.cross_cells += (now.cross_cells - side.cross_cells) / n;
}

TraceEnd TraceRecorder::EndOf(const LocalGrids& grids, double time_s) {
  if (std::abs(grids.frame_rad() - frame_rad_) > 1e-9) return TraceEnd::kFrame;
  const Position robot = RobotAt(grids);
  const double turned = std::remainder(grids.pose().heading_rad - heading_rad_, 2 * std::numbers::pi);
  least_z_m_ = std::min(least_z_m_, robot.z_m);
  most_z_m_ = std::max(most_z_m_, robot.z_m);
  const double back_m = backwards() ? robot.z_m - least_z_m_ : most_z_m_ - robot.z_m;
  if (std::abs(turned) > options_.turned_rad || std::abs(robot.u_m) > options_.aside_m ||
      back_m > options_.back_m)
    return TraceEnd::kTurn;
  const auto at = static_cast<int>(std::lround(robot.z_m / trace_.cell_m())), half = grids.edges().half();
  const int first = std::min(trace_.first_z(), at - half), end = std::max(trace_.end_z(), at + half + 1);
  if (end - first > static_cast<int>(options_.capacity)) return TraceEnd::kFull;
  if (std::hypot(robot.z_m - still_at_.z_m, robot.u_m - still_at_.u_m) > options_.still_m ||
      !Blocked(grids, robot)) {
    still_at_ = robot;
    still_since_s_ = time_s;
  }
  // [DM98] section 4.1: until an obstacle remains for more than 30 s
  return time_s - still_since_s_ > options_.blocked_s ? TraceEnd::kBlocked : TraceEnd::kNone;
}

// A robot that stands may tremble.
bool TraceRecorder::backwards() const {
  const double back_m = begun_z_m_ - least_z_m_;
  return back_m > options_.still_m && back_m > most_z_m_ - begun_z_m_;
}

bool TraceRecorder::Blocked(const LocalGrids& grids, const Position& robot) const {
  const double cell_m = trace_.cell_m();
  const auto first = static_cast<int>(std::lround(robot.z_m / cell_m)),
             at = static_cast<int>(std::lround(robot.u_m / cell_m));
  const auto ahead = static_cast<int>(std::ceil(options_.ahead_m / cell_m)),
             beside = static_cast<int>(options_.width_m / cell_m);
  const int way = backwards() ? -1 : 1;
  for (int z = 1; z <= ahead; ++z)
    for (int u = at - beside; u <= at + beside; ++u) {
      const CellIndex cell = frame_.CellAt(first + way * z, u);
      if (grids.occupancy().Occupied(cell.i, cell.j)) return true;
    }
  return false;
}

}  // namespace cairn::local_map
