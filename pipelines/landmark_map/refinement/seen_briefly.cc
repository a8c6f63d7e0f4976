#include "pipelines/landmark_map/refinement/seen_briefly.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <set>
#include <span>
#include <utility>

#include "pipelines/landmark_map/landmarks/image_landmarks.h"
#include "schema/square.h"

namespace cairn::landmark_map {
namespace {

// A row of no landmark: where it sees something, and in which image.
struct Rest {
  Point place;
  std::pair<std::size_t, double> image;
};

Point PlaceOf(const PlacedRow& row) {
  const double ray = row.from.heading_rad + row.bearing_rad;
  return {row.from.x_m + row.range_m * std::cos(ray), row.from.y_m + row.range_m * std::sin(ray)};
}

// Those within `gate_m` of their own middle, which is looked for from `middle` on.
std::vector<Rest> Around(const std::vector<Rest>& rest, double gate_m, Point* middle) {
  constexpr int kMoves = 2;
  std::vector<Rest> near;
  for (int move = 0; move <= kMoves; ++move) {
    near.clear();
    for (const Rest& one : rest)
      if (DistanceM(one.place, *middle) <= gate_m) near.push_back(one);
    if (move == kMoves || near.empty()) break;
    Point sum{0, 0};
    for (const Rest& one : near) sum = {sum.x_m + one.place.x_m, sum.y_m + one.place.y_m};
    *middle = {sum.x_m / static_cast<double>(near.size()), sum.y_m / static_cast<double>(near.size())};
  }
  return near;
}

}  // namespace

std::vector<Landmark> FindSeenBriefly(const std::vector<std::vector<PlacedRow>>& rows,
                                      const std::vector<Landmark>& landmarks, double sigma_m, double apart_m,
                                      int type) {
  constexpr std::size_t kLeast = 3, kMostShare = 50;  // of the rows one in so many is of none at most
  constexpr double kEnough_nats = 3, kGate = 3, kMostDetected = 0.95;
  const double gate_m = kGate * sigma_m;
  std::vector<Rest> rest;
  std::size_t nameless = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (const PlacedRow& row : rows[r]) {
      if (row.told) continue;
      ++nameless;
      if (row.landmark < 0) rest.push_back({PlaceOf(row), {r, row.time_s}});
    }
  }
  std::vector<Landmark> found;
  // Of many some come by and stand for a while: they do not fall together by chance alone.
  if (rest.size() < kLeast || kMostShare * rest.size() > nameless) return found;
  const Submap submap = SubmapOf({rows.begin(), rows.end()});
  double viewed_m2 = 0;
  for (const Submap::Look& look : submap.looks) {
    const Submap::View& view = submap.views[look.view];
    viewed_m2 += submap.images_a_look * Square(view.reach_m) * (view.left_rad - view.right_rad) / 2;
  }
  const auto unexplained = static_cast<double>(rest.size());
  const double beside = unexplained * std::numbers::pi * Square(gate_m) / viewed_m2;
  for (std::vector<Rest> left = rest; left.size() >= kLeast;) {
    Point middle = left.front().place;
    const std::vector<Rest> near = Around(left, gate_m, &middle);
    std::set<std::pair<std::size_t, double>> images;
    for (const Rest& one : near) images.insert(one.image);
    left.erase(left.begin());  // which its own middle may have left behind
    std::erase_if(left, [&](const Rest& one) { return DistanceM(one.place, middle) <= gate_m; });
    const bool apart = std::ranges::none_of(landmarks, [&](const Landmark& landmark) {
      return DistanceM(middle, {landmark.x_m, landmark.y_m}) <= std::max(apart_m, gate_m);
    });
    if (!apart || images.size() < kLeast) continue;
    const auto count = static_cast<double>(images.size());
    const double looks = std::max(count, std::round(submap.images_a_look * submap.LooksAt(middle)));
    const double detected = std::min(kMostDetected, submap.detected);
    if (LogOddsOfLandmark(count, looks, detected, unexplained, beside) < kEnough_nats) continue;
    const double variance_m2 = Square(sigma_m) / count;
    found.push_back({middle.x_m, middle.y_m, {variance_m2, 0, 0, variance_m2}, type, count, 0});
  }
  return found;
}

}  // namespace cairn::landmark_map
