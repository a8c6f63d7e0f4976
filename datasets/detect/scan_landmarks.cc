#include "datasets/detect/scan_landmarks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "datasets/detect/posts.h"
#include "schema/error.h"
#include "schema/geometry.h"
#include "schema/kinds/log.h"
#include "schema/square.h"

namespace cairn::datasets {
namespace {

using Sensor = kinds::Log::RangeSensor;

// A laser's geometry, its scans in the fan's order.
struct Laser {
  const Sensor& sensor;
  BeamFan fan;

  explicit Laser(const Sensor& of) : sensor(of), fan(of.beam_x_m, of.beam_y_m, of.beam_heading_rad) {}
  std::size_t scans() const { return sensor.time_s.size(); }
  template <class T>
  std::vector<double> Row(const Column<T>& column, std::size_t scan) const {
    const auto row = column.values().subspan(scan * fan.size(), fan.size());
    return fan.Ordered(std::vector<double>(row.begin(), row.end()));
  }
  std::vector<double> Ranges(std::size_t scan) const { return Row(sensor.range_m, scan); }
};

// Where the robot was by its odometry.
class OdometryPath {
 public:
  explicit OdometryPath(const kinds::Log::Odometry& odometry) : time_s_(odometry.time_s.OrNone()) {
    Pose pose;
    double way_m = 0;
    for (std::size_t i = 0; i < time_s_.size(); ++i) {
      pose = Compose(Compose(pose, {0, 0, odometry.turn_rad[i]}), {odometry.forward_m[i], 0, 0});
      way_m += std::abs(odometry.forward_m[i]);
      poses_.push_back(pose);
      way_m_.push_back(way_m);
    }
  }
  struct Place {
    Pose pose;
    double way_m = 0;
  };
  std::optional<Place> At(double time_s) const {
    if (time_s_.empty() || time_s < time_s_.front() || time_s > time_s_.back()) return std::nullopt;
    const auto after = static_cast<std::size_t>(std::ranges::lower_bound(time_s_, time_s) - time_s_.begin());
    if (after == 0 || time_s_[after] == time_s_[after - 1]) return Place{poses_[after], way_m_[after]};
    const double share = (time_s - time_s_[after - 1]) / (time_s_[after] - time_s_[after - 1]);
    return Place{Interpolate(poses_[after - 1], poses_[after], share),
                 way_m_[after - 1] + share * (way_m_[after] - way_m_[after - 1])};
  }

 private:
  std::span<const double> time_s_;
  std::vector<Pose> poses_;
  std::vector<double> way_m_;
};

// A post, seen from the robot.
struct Sighting {
  double time_s = 0;
  Point on_robot;
  double range_sigma_m = 0, bearing_sigma_rad = 0;
  std::size_t track = 0;
  bool repeats = false;
  // By what it differs from where it was seen before; NaN: it was not.
  double range_change_m = std::numeric_limits<double>::quiet_NaN(), bearing_change_rad = range_change_m;
};

Sighting SightingOf(const Post& post, const Laser& laser, std::size_t scan) {
  const Pose turned{0, 0, laser.sensor.turret_rad ? laser.sensor.turret_rad[scan] : 0};
  const Point at = laser.fan.at();
  const Pose seen = Compose(turned, {at.x_m + post.range_m * std::cos(post.bearing_rad),
                                     at.y_m + post.range_m * std::sin(post.bearing_rad), 0});
  Sighting sighting{.time_s = laser.sensor.time_s[scan], .on_robot = {seen.x_m, seen.y_m}};
  // What lies along the beam for the laser lies partly across for the robot's middle.
  const double range_m = std::max(std::hypot(seen.x_m, seen.y_m), 0.01);
  const double aside = std::atan2(seen.y_m, seen.x_m) - (turned.heading_rad + post.bearing_rad);
  const double across_m = post.range_m * post.bearing_sigma_rad;
  sighting.range_sigma_m = std::hypot(post.range_sigma_m * std::cos(aside), across_m * std::sin(aside));
  sighting.bearing_sigma_rad =
      std::hypot(post.range_sigma_m * std::sin(aside), across_m * std::cos(aside)) / range_m;
  return sighting;
}

// What is seen where it was seen before, by odometry.
class Tracks {
 public:
  Tracks(const ScanLandmarkOptions& options, double scan_s)
      : options_(options), forget_s_(std::max(kForget_s, kForget_scans * scan_s)) {}

  void Add(const OdometryPath::Place& place, std::vector<Sighting> scan) {
    ++scan_;
    std::erase_if(open_, [&](std::size_t t) { return scan.front().time_s > tracks_[t].last_s + forget_s_; });
    for (Sighting& sighting : scan) {
      const double range_m = std::hypot(sighting.on_robot.x_m, sighting.on_robot.y_m);
      const Pose at = Compose(place.pose, {sighting.on_robot.x_m, sighting.on_robot.y_m, 0});
      const std::size_t known = tracks_.size();
      sighting.track = FindOrOpen({at.x_m, at.y_m}, kGate_m + kGate_rad * range_m, sighting.time_s);
      Track& track = tracks_[sighting.track];
      const double turned_rad =
          std::abs(WrapAngle(place.pose.heading_rad - track.kept_from.pose.heading_rad));
      sighting.repeats = sighting.track < known && place.way_m - track.kept_from.way_m < options_.every_m &&
                         turned_rad * range_m < options_.every_m;
      if (!sighting.repeats) {
        if (sighting.track < known) Compare(place.pose, track.kept_at, &sighting);
        track.kept_from = place;
        track.kept_at = {at.x_m, at.y_m};
      }
      sightings_.push_back(sighting);
    }
  }
  const std::vector<Sighting>& sightings() const { return sightings_; }
  bool Stands(const Sighting& sighting) const {
    const Track& track = tracks_[sighting.track];
    return track.scans >= options_.least_scans && track.last_s - track.first_s >= options_.least_s;
  }

 private:
  // So far something may be off from scan to scan: by odometry and its clock, and how it is seen. It is
  // followed slowly, so that who walks leaves it.
  static constexpr double kGate_m = 0.3, kGate_rad = 0.02, kFollow_s = 2, kForget_s = 2, kForget_scans = 3;
  struct Track {
    Point at;
    double first_s = 0, last_s = 0;
    int scans = 1;
    std::size_t last_scan = 0;
    OdometryPath::Place kept_from = {};  // the last sighting that does not repeat, and where it was
    Point kept_at = {};
  };

  static void Compare(const Pose& robot, Point before, Sighting* sighting) {
    const Pose seen = Between(robot, {before.x_m, before.y_m, 0});
    const Point now = sighting->on_robot;
    sighting->range_change_m = std::hypot(now.x_m, now.y_m) - std::hypot(seen.x_m, seen.y_m);
    sighting->bearing_change_rad = WrapAngle(std::atan2(now.y_m, now.x_m) - std::atan2(seen.y_m, seen.x_m));
  }

  std::size_t FindOrOpen(Point at, double gate_m, double time_s) {
    std::size_t nearest = tracks_.size();
    for (const std::size_t t : open_) {
      const double away_m = DistanceM(tracks_[t].at, at);
      if (away_m > gate_m || tracks_[t].last_scan == scan_) continue;
      gate_m = away_m;
      nearest = t;
    }
    if (nearest == tracks_.size()) {
      open_.push_back(nearest);
      tracks_.push_back({at, time_s, time_s, 1, scan_});
      return nearest;
    }
    Track& track = tracks_[nearest];
    const double share = 1 - std::exp(-(time_s - track.last_s) / kFollow_s);
    track.at = {track.at.x_m + share * (at.x_m - track.at.x_m),
                track.at.y_m + share * (at.y_m - track.at.y_m)};
    // Another laser that sees it at the same time is no scan more.
    if (track.last_s < time_s) ++track.scans;
    track.last_s = time_s;
    track.last_scan = scan_;
    return nearest;
  }

  const ScanLandmarkOptions& options_;
  double forget_s_;
  std::size_t scan_ = 0;  // the one that is looked at, by number from 1
  std::vector<Track> tracks_;
  std::vector<std::size_t> open_;
  std::vector<Sighting> sightings_;
};

class ScanLandmarks {
 public:
  ScanLandmarks(const ScanLandmarkOptions& options, Blob* log)
      : options_(options), blob_(*log), log_(Read<kinds::Log>(*log)) {}

  ImportReport Run() {
    CheckIsWithout();
    for (const kinds::Log::Robot& robot : log_.robot) AddLasers(robot);
    if (lasers_.empty()) throw InputError("the log has no scans of a laser");
    if (options_.reflectors) LookAtBrightness();
    MeasureNoise();
    std::size_t laser = 0;
    for (std::size_t r = 0; r < log_.robot.size(); ++r) laser = FindOf(r, laser);
    if (scans_ == 0) throw InputError("no scan of a laser lies within the time of its robot's odometry");
    PutNoise();
    report_.read["scans of lasers"] = scans_;
    return std::move(report_);
  }

 private:
  void CheckIsWithout() {
    std::size_t there = 0;
    for (const kinds::Log::Robot& robot : log_.robot) there += robot.observations.time_s.OrNone().size();
    if (there > 0 && !options_.replace)
      throw InputError("the log has " + std::to_string(there) +
                       " observations of landmarks already; --replace leaves them out");
  }

  void AddLasers(const kinds::Log::Robot& robot) {
    for (const Sensor& sensor : robot.sensors) {
      if (!sensor.sensor.starts_with("laser") || sensor.time_s.OrNone().empty()) continue;
      if (options_.reflectors && !sensor.intensity)
        throw InputError("'" + sensor.time_s.name() +
                         "': a laser without intensities, by which reflectors are told");
      try {
        lasers_.emplace_back(sensor);
      } catch (const InputError& error) {
        throw InputError("'" + sensor.time_s.name() + "': " + error.what());
      }
    }
  }

  // Some thousand scans tell.
  template <class Look>
  void LookAtSome(const Laser& laser, const Look& look) const {
    constexpr std::size_t kScans = 1000;
    const std::size_t step = laser.scans() / kScans + 1;
    for (std::size_t scan = 0; scan < laser.scans(); scan += step) look(scan);
  }

  void LookAtBrightness() {
    for (const Laser& laser : lasers_) {
      Brightness& brightness = brightness_.emplace_back();
      LookAtSome(laser, [&](std::size_t scan) {
        const std::vector<double> range_m = laser.Ranges(scan),
                                  intensity = laser.Row(laser.sensor.intensity, scan);
        for (std::size_t i = 0; i < range_m.size(); ++i)
          brightness.Add(range_m[i], static_cast<float>(intensity[i]));
      });
      brightness.Finish();
    }
  }

  PostLimits LimitsOf(const ScanLandmarkOptions::Widths& widths, const Laser& laser) const {
    return {widths.least_m, widths.most_m, laser.sensor.max_range_m.Scalar(), sigma_m_};
  }

  // Of ranges, as the posts that many beams met differ from round.
  void MeasureNoise() {
    constexpr std::size_t kManyBeams = 5, kLeastPosts = 20;
    constexpr double kLeast_m = 0.002;
    double squares = 0, freedom = 0;
    std::size_t posts = 0;
    for (std::size_t l = 0; l < lasers_.size(); ++l)
      LookAtSome(lasers_[l], [&](std::size_t scan) {
        for (const Post& post : PostsIn(l, scan)) {
          if (post.beams < kManyBeams || post.radius_m == 0) continue;
          squares += post.squares_m2;
          freedom += static_cast<double>(post.beams - 1);
          ++posts;
        }
      });
    if (posts >= kLeastPosts) sigma_m_ = std::max(kLeast_m, std::sqrt(squares / freedom));
    if (posts < kLeastPosts)
      report_.warnings.push_back(
          "too few posts are near enough to say how far off ranges are: they are taken to err by " +
          std::to_string(sigma_m_) + " m");
  }

  std::vector<Post> PostsIn(std::size_t l, std::size_t scan) const {
    const Laser& laser = lasers_[l];
    const std::vector<double> range_m = laser.Ranges(scan);
    std::vector<Post> posts;
    if (options_.reflectors)
      posts = FindReflectors(laser.fan, range_m, laser.Row(laser.sensor.intensity, scan), brightness_[l],
                             LimitsOf(*options_.reflectors, laser));
    if (!options_.poles) return posts;
    const std::size_t reflectors = posts.size();
    for (const Post& pole : FindPosts(laser.fan, range_m, LimitsOf(*options_.poles, laser))) {
      const bool is_known =
          std::any_of(posts.begin(), posts.begin() + static_cast<std::ptrdiff_t>(reflectors),
                      [&](const Post& other) { return AreOne(pole, other); });
      if (!is_known) posts.push_back(pole);
    }
    return posts;
  }
  bool AreOne(const Post& a, const Post& b) const {
    const auto at = [](const Post& post) {
      return Point{post.range_m * std::cos(post.bearing_rad), post.range_m * std::sin(post.bearing_rad)};
    };
    return DistanceM(at(a), at(b)) < options_.poles->most_m;
  }

  // A robot's lasers, from number `laser` on, scan by scan in the order of time. Returns the next robot's.
  std::size_t FindOf(std::size_t r, std::size_t laser) {
    const kinds::Log::Robot& robot = log_.robot[r];
    struct Scan {
      double time_s;
      std::size_t laser, scan;
    };
    std::vector<Scan> scans;
    for (const Sensor& sensor : robot.sensors) {
      if (laser == lasers_.size() || &lasers_[laser].sensor != &sensor) continue;
      for (std::size_t s = 0; s < lasers_[laser].scans(); ++s) scans.push_back({sensor.time_s[s], laser, s});
      ++laser;
    }
    std::ranges::stable_sort(scans, {}, &Scan::time_s);
    const OdometryPath path(robot.odometry);
    std::vector<double> apart_s = {0};
    for (std::size_t i = 1; i < scans.size(); ++i) apart_s.push_back(scans[i].time_s - scans[i - 1].time_s);
    Tracks tracks(options_, MedianOf(std::move(apart_s)));
    for (const Scan& scan : scans) {
      const auto place = path.At(scan.time_s);
      if (!place) {
        ++report_.dropped["scan outside the odometry's time"];
        continue;
      }
      ++scans_;
      std::vector<Sighting> seen;
      for (const Post& post : PostsIn(scan.laser, scan.scan))
        seen.push_back(SightingOf(post, lasers_[scan.laser], scan.scan));
      if (!seen.empty()) tracks.Add(*place, std::move(seen));
    }
    Put("robot/" + std::to_string(r) + "/observations/", tracks);
    return laser;
  }

  void Put(const std::string& group, const Tracks& tracks) {
    std::vector<double> time_s, range_m, bearing_rad;
    for (const Sighting& one : tracks.sightings()) {
      if (!tracks.Stands(one)) {
        ++report_.dropped["post that was not seen at one place for " + std::to_string(options_.least_scans) +
                          " scans: it moves, or was none"];
        continue;
      }
      if (one.repeats) {
        ++report_.dropped["post that was seen from the same place before"];
        continue;
      }
      time_s.push_back(one.time_s);
      range_m.push_back(std::hypot(one.on_robot.x_m, one.on_robot.y_m));
      bearing_rad.push_back(std::atan2(one.on_robot.y_m, one.on_robot.x_m));
      range_squares_ += Square(one.range_sigma_m);
      bearing_squares_ += Square(one.bearing_sigma_rad);
      if (std::isnan(one.range_change_m)) continue;
      range_changes_m_.push_back(std::abs(one.range_change_m));
      bearing_changes_rad_.push_back(std::abs(one.bearing_change_rad));
    }
    report_.observations += static_cast<std::int64_t>(time_s.size());
    blob_ = blob_.Without(group).Without("truth/" + group);
    blob_.PutVector(group + "landmark", std::vector<std::int32_t>(time_s.size(), -1));
    blob_.PutVector(group + "time_s", time_s);
    blob_.PutVector(group + "range_m", range_m);
    blob_.PutVector(group + "bearing_rad", bearing_rad);
  }

  // What was found, on average; but no less than by what sightings differ from one to the next, of which each
  // has half of the variance. Clocks and odometry are in that, and what is not round.
  void PutNoise() {
    if (report_.observations == 0) {
      report_.warnings.emplace_back("nothing was found");
      return;
    }
    const auto put = [&](const std::string& name, double squares, const std::vector<double>& changes) {
      constexpr double kSigmasOfMedian = 1.4826;
      const double stated = std::sqrt(squares / static_cast<double>(report_.observations));
      const double seen = changes.empty() ? 0 : kSigmasOfMedian * MedianOf(changes) / std::sqrt(2.0);
      if (!blob_.Has(name)) blob_.PutScalar(name, std::max(stated, seen));
    };
    put("noise/range_m", range_squares_, range_changes_m_);
    put("noise/bearing_rad", bearing_squares_, bearing_changes_rad_);
  }

  const ScanLandmarkOptions& options_;
  Blob& blob_;
  const kinds::Log log_;
  std::vector<Laser> lasers_;
  std::vector<Brightness> brightness_;  // of each laser, where reflectors are wanted
  double sigma_m_ = 0.03;
  std::int64_t scans_ = 0;
  double range_squares_ = 0, bearing_squares_ = 0;
  std::vector<double> range_changes_m_, bearing_changes_rad_;
  ImportReport report_;
};

}  // namespace

ImportReport FindLandmarksInScans(const ScanLandmarkOptions& options, Blob* log) {
  return ScanLandmarks(options, log).Run();
}

}  // namespace cairn::datasets
