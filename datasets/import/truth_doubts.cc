#include "datasets/import/truth_doubts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>

#include "datasets/common/array_text.h"
#include "schema/geometry.h"
#include "schema/middle.h"
#include "schema/walked.h"

namespace cairn::datasets {
namespace {

Walked<double> WalkedOrNone(const Column<double>& column) {
  return column ? Walked<double>(column.array()) : Walked<double>();
}

// The middle one of at(i).
double MiddleOfAll(std::size_t count, const auto& at) {
  return *MiddleOf([&](const auto& take) {
    for (std::size_t i = 0; i < count; ++i) take(at(i));
  });
}

// How far from their middle half of the points lie and more; a few that are far off do not count.
double ExtentM(const Walked<double>& x_m, const Walked<double>& y_m) {
  const std::size_t count = x_m.size();
  if (count == 0 || count != y_m.size()) return 0;
  const Point middle{MiddleOfAll(count, [&](std::size_t i) { return x_m[i]; }),
                     MiddleOfAll(count, [&](std::size_t i) { return y_m[i]; })};
  return MiddleOfAll(count, [&](std::size_t i) { return DistanceM({x_m[i], y_m[i]}, middle); });
}

double TravelledM(const kinds::Log::Robot& robot) {
  double travelled_m = 0;
  for (const double forward_m : WalkedOrNone(robot.odometry.forward_m)) travelled_m += std::abs(forward_m);
  return travelled_m;
}

// The largest range of all observations.
double FarthestM(const kinds::Log::Robot& robot) {
  double farthest_m = 0;
  for (const double range_m : robot.observations.range_m.OrNone())
    if (range_m > farthest_m) farthest_m = range_m;  // none is NaN
  return farthest_m;
}

constexpr double kTown = 10;  // times as large as what its robots drove

class TruthDoubts {
 public:
  explicit TruthDoubts(const kinds::Log& log) : log_(log) {
    for (const kinds::Log::Robot& robot : log.robot) {
      travelled_m_ += TravelledM(robot);
      farthest_m_ = std::max(farthest_m_, FarthestM(robot));
    }
  }

  std::vector<std::string> Find() {
    OfLandmarks();
    for (std::size_t n = 0; n < std::min(log_.robot.size(), log_.truth.robot.size()); ++n) {
      const kinds::PoseTable& poses = log_.truth.robot[n].poses;
      Doubt("true poses of robot '" + log_.robots[n] + "'", WalkedOrNone(poses.x_m), WalkedOrNone(poses.y_m),
            TravelledM(log_.robot[n]), kMostBeyond, "it drove");
    }
    return std::move(doubts_);
  }

 private:
  // Those that were seen, where that is known: a list may be of a whole town.
  void OfLandmarks() {
    const kinds::Log::Landmarks& all = log_.truth.landmarks;
    const auto all_x = all.x_m.OrNone(), all_y = all.y_m.OrNone();
    const std::vector<bool> seen = Seen();
    const bool known = std::ranges::count(seen, true) > 0;
    std::vector<double> x_m, y_m;
    for (std::size_t k = 0; k < std::min(all_x.size(), all_y.size()); ++k) {
      if (known && !seen[k]) continue;
      x_m.push_back(all_x[k]);
      y_m.push_back(all_y[k]);
    }
    Doubt("true landmarks", x_m, y_m, travelled_m_ + 2 * farthest_m_,
          known ? kMostBeyond : kTown * kMostBeyond, "all robots drove and saw");
  }

  std::vector<bool> Seen() const {
    const kinds::Log::Landmarks& all = log_.truth.landmarks;
    std::vector<bool> seen(all.x_m.OrNone().size(), false);
    for (const kinds::Log::TrueRobot& robot : log_.truth.robot)
      for (const std::int32_t which : robot.landmark.OrNone())
        if (which >= 0 && static_cast<std::size_t>(which) < seen.size())
          seen[static_cast<std::size_t>(which)] = true;
    const std::vector<std::string>& names = all.name.OrNone();
    const std::set<std::string> named(log_.landmarks.OrNone().begin(), log_.landmarks.OrNone().end());
    for (std::size_t k = 0; k < std::min(names.size(), seen.size()); ++k)
      if (named.contains(names[k])) seen[k] = true;
    return seen;
  }

  // `room`: how many times the reach is allowed.
  void Doubt(const std::string& what, const Walked<double>& x_m, const Walked<double>& y_m, double reach_m,
             double room, const std::string& reached) {
    constexpr double kLeastReach_m = 1, kAsMillimetres = 200;
    const double extent_m = ExtentM(x_m, y_m);
    // A robot that stands still has no way to tell of.
    if (reach_m < kLeastReach_m || !(extent_m > room * reach_m)) return;
    doubts_.push_back(what + " lie " + ShortNumber(extent_m) + " m from their middle, where " + reached +
                      " " + ShortNumber(reach_m) + " m in all: are they in " +
                      (extent_m > kAsMillimetres * reach_m ? "millimetres" : "millimetres or centimetres") +
                      "? Cairn reads metres (of a CSV whose header says _mm or _cm, those)");
  }

  const kinds::Log& log_;
  double travelled_m_ = 0, farthest_m_ = 0;
  std::vector<std::string> doubts_;
};

}  // namespace

std::vector<std::string> FindTruthDoubts(const kinds::Log& log) { return TruthDoubts(log).Find(); }

}  // namespace cairn::datasets
