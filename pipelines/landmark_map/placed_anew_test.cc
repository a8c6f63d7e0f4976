// Robots whose landmarks have no names, in rooms that share little.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/testing/in_process.h"
#include "schema/geometry.h"
#include "schema/kinds/landmark_map.h"
#include "schema/rng.h"

namespace cairn::landmark_map {
namespace {

constexpr int kHz = 4;  // rows of odometry for each image

// A robot's odometry and what it sees; poses that are true.
struct Drive {
  std::vector<double> time_s, turn_rad, forward_m, seen_s, range_m, bearing_rad;
  std::vector<Pose> poses;  // of each row

  // Through these points, a tenth of a metre a row; it turns by a quarter of a radian a row at most, on the
  // spot. Odometry drifts.
  Drive(const std::vector<Point>& through, const std::vector<Point>& landmarks, double drift_rad_per_m,
        Rng* rng) {
    constexpr double kStep_m = 0.1, kTurn_rad = 0.25;
    Pose at{through[0].x_m, through[0].y_m,
            std::atan2(through[1].y_m - through[0].y_m, through[1].x_m - through[0].x_m)};
    for (std::size_t next = 1; next < through.size();) {
      if (DistanceM({at.x_m, at.y_m}, through[next]) < kStep_m) {
        ++next;
        continue;
      }
      const double off = WrapAngle(
          std::atan2(through[next].y_m - at.y_m, through[next].x_m - at.x_m) - at.heading_rad);
      const double turn = std::clamp(off, -kTurn_rad, kTurn_rad);
      const double forward = std::abs(off) > kTurn_rad ? 0 : kStep_m;
      at = Compose(at, {0, 0, turn});
      at = Compose(at, {forward, 0, 0});
      Row(turn + drift_rad_per_m * forward + 0.02 * turn * rng->Normal() + 0.002 * rng->Normal(),
          forward * (1 + 0.02 * rng->Normal()), at, landmarks, rng);
    }
  }

  void Put(const std::string& prefix, Blob* log) const {
    log->PutVector(prefix + "odometry/time_s", time_s);
    log->PutVector(prefix + "odometry/turn_rad", turn_rad);
    log->PutVector(prefix + "odometry/forward_m", forward_m);
    log->PutVector(prefix + "observations/time_s", seen_s);
    log->PutVector(prefix + "observations/range_m", range_m);
    log->PutVector(prefix + "observations/bearing_rad", bearing_rad);
    log->PutVector(prefix + "observations/landmark", std::vector<std::int32_t>(seen_s.size(), -1));
  }

 private:
  void Row(double turn, double forward, const Pose& at, const std::vector<Point>& landmarks, Rng* rng) {
    time_s.push_back(static_cast<double>(poses.size() + 1) / kHz);
    turn_rad.push_back(turn);
    forward_m.push_back(forward);
    poses.push_back(at);
    if (poses.size() % kHz != 0) return;
    for (const Point& landmark : landmarks) {
      const Pose seen = Relative(at, {landmark.x_m, landmark.y_m, 0});
      const double range = std::hypot(seen.x_m, seen.y_m), bearing = std::atan2(seen.y_m, seen.x_m);
      const double range_error = 0.05 * rng->Normal(), bearing_error = 0.02 * rng->Normal();
      if (range > 5 || std::abs(bearing) > 1.05 || rng->Uniform() > 0.9) continue;
      seen_s.push_back(time_s.back());
      range_m.push_back(std::max(0.05, range + range_error));
      bearing_rad.push_back(bearing + bearing_error);
    }
  }
};

// Two rooms side by side, each with nine landmarks, and two at the door that both robots see, each from its
// own room.
struct TwoRooms {
  std::array<Drive, 2> drives;

  static std::vector<Point> Landmarks(std::uint64_t seed, double apart_m) {
    Rng rng(seed);
    std::vector<Point> landmarks;
    for (const double x0 : {0.0, apart_m})
      for (int k = 0; k < 9; ++k) landmarks.push_back({x0 + rng.Uniform(0, 10), rng.Uniform(0, 8)});
    if (apart_m < 20) landmarks.insert(landmarks.end(), {{11, 1}, {11, 7}});
    return landmarks;
  }
  static TwoRooms Make(std::uint64_t seed, double apart_m) {
    const std::vector<Point> landmarks = Landmarks(seed, apart_m);
    std::vector<Point> a, b;
    for (int lap = 0; lap < 2; ++lap)
      for (const Point at : {Point{1, 1}, Point{9, 1}, Point{9, 7}, Point{1, 7}}) a.push_back(at);
    for (const Point at : {Point{9, 7}, Point{10.5, 4}, Point{9, 1}}) a.push_back(at);
    for (const Point at : a) b.push_back({apart_m + 10 - at.x_m, 8 - at.y_m});
    Rng first(seed, 1), second(seed, 2);
    return {{Drive(a, landmarks, 0.02, &first), Drive(b, landmarks, -0.02, &second)}};
  }
  Blob Log() const {
    Blob log;
    log.Put("robots", Array::Texts({"a", "b"}));
    log.Put("landmarks", Array::Texts({}));
    drives[0].Put("robot/0/", &log);
    drives[1].Put("robot/1/", &log);
    return log;
  }
};

kinds::LandmarkMap MapOf(const TwoRooms& world) {
  return Read<kinds::LandmarkMap>(*RunInProcess(LandmarkMap({.starts = 1}),
                                                {{"log", std::make_shared<const Blob>(world.Log())}}));
}

// How far apart the robots end, and should.
double EndsApart_m(const kinds::LandmarkMap& map) {
  const auto end = [&](std::size_t r) {
    return Point{map.robot[r].poses.x_m.back(), map.robot[r].poses.y_m.back()};
  };
  return DistanceM(end(0), end(1));
}
double TrueEndsApart_m(const TwoRooms& world) {
  const Pose &a = world.drives[0].poses.back(), &b = world.drives[1].poses.back();
  return DistanceM({a.x_m, a.y_m}, {b.x_m, b.y_m});
}

TEST(Probe, Seeds) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const TwoRooms world = TwoRooms::Make(seed, 12);
    const kinds::LandmarkMap map = MapOf(world);
    std::printf("seed %d: apart %.2f true %.2f, landmarks %zu, lead %.1f shared %ld iterations %zu\n",
                (int)seed, EndsApart_m(map), TrueEndsApart_m(world), map.map.landmark_x_m.size(),
                map.robot[1].place_lead_nats.Or(-999), (long)map.robot[1].shared_landmarks.Or(-1),
                map.history.prefix.size());
  }
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const TwoRooms world = TwoRooms::Make(seed, 40);
    const kinds::LandmarkMap map = MapOf(world);
    std::printf("apart seed %d: landmarks %zu, lead %.1f shared %ld iterations %zu\n",
                (int)seed, map.map.landmark_x_m.size(),
                map.robot[1].place_lead_nats.Or(-999), (long)map.robot[1].shared_landmarks.Or(-1),
                map.history.prefix.size());
  }
}

}  // namespace
}  // namespace cairn::landmark_map
