#include "datasets/import/truth_doubts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <span>

#include "datasets/common/array_text.h"
#include "schema/geometry.h"

namespace cairn::datasets {
namespace {

double Middle(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// How far from their middle half of the points lie and more; a few that are far off do not count.
double ExtentM(std::span<const double> x_m, std::span<const double> y_m) {
  if (x_m.empty() || x_m.size() != y_m.size()) return 0;
  const Point middle{Middle({x_m.begin(), x_m.end()}), Middle({y_m.begin(), y_m.end()})};
  std::vector<double> away_m;
  for (std::size_t i = 0; i < x_m.size(); ++i) away_m.push_back(DistanceM({x_m[i], y_m[i]}, middle));
  return Middle(away_m);
}

double TravelledM(const kinds::Log::Robot& robot) {
  double travelled_m = 0;
  for (const double forward_m : robot.odometry.forward_m.OrNone()) travelled_m += std::abs(forward_m);
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
      Doubt("true poses of robot '" + log_.robots[n] + "'", poses.x_m.OrNone(), poses.y_m.OrNone(),
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
  void Doubt(const std::string& what, std::span<const double> x_m, std::span<const double> y_m,
             double reach_m, double room, const std::string& reached) {
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
