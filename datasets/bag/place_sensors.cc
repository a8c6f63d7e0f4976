#include "datasets/bag/place_sensors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "datasets/bag/landmark_readers.h"
#include "datasets/bag/tracks.h"
#include "datasets/import/repeated_rows.h"
#include "schema/error.h"
#include "schema/text.h"

namespace cairn::datasets::bag {
namespace {

constexpr std::array kUsualBases = {"base_link", "base_footprint"};
constexpr double kDegree = std::numbers::pi / 180;

Transform Level(const Pose& pose) {
  return {pose.x_m, pose.y_m, 0, 0, 0, std::sin(pose.heading_rad / 2), std::cos(pose.heading_rad / 2)};
}

class BagLog {
 public:
  BagLog(Gathered gathered, ImportReport* report) : in_(std::move(gathered)), report_(*report) {}

  void FindBase() {
    if (in_.odometry_topic == "tf") TakeOdometryOfFrames();
    ChooseBase();
  }

  void ForgetPaths() {
    in_.frames.ForgetTracks();
    in_.odometry.poses.clear();
  }

  // Of several robots the first whose covariances say something counts.
  RangeLog Make(NoiseParameters* noise, std::optional<Fix>* origin) {
    if (!in_.robot.empty()) ranges_.robot = in_.robot;
    ranges_.events = SpooledRows<RangeEvent>(in_.folder);
    ranges_.path = in_.path + ": " + in_.odometry_topic;
    ranges_.before_line = ", message ";
    FindBase();
    if (in_.odometry.poses.empty() && !in_.odometry.other_joints.empty())
      throw InputError(in_.path + ": no message of " + in_.odometry_topic +
                       " has both wheels; it has the joints " + NameList(in_.odometry.other_joints, 20));
    CompareWithOthers();
    if (!in_.gyro.topic.empty()) TurnOdometry();
    TakePosesOfTf();
    SortRows(&in_.odometry.poses, [](const PoseRow& row) { return row.time_s; });
    if (!in_.fixes.topic.empty())
      in_.truth = PosesOfFixes(in_.fixes, Antenna(), in_.odometry.poses, origin, &report_);
    in_.frames.ForgetTracks();
    AddPoses(in_.truth, &RangeEvent::truth);
    AddPoses(in_.poses, &RangeEvent::corrected);
    TakeNoiseOfCovariances();
    in_.truth.clear();
    in_.poses.clear();
    for (const auto& scan : in_.scans) AddLaser(scan.get());
    AddRing("sonar", false);
    AddRing("infrared", true);
    PlaceTags(in_.path, std::move(in_.tags), in_.followed.tags, &in_.landmarks, &report_);
    for (const FrameSighting& frame : in_.followed.seen) in_.landmarks.push_back(frame.seen);
    for (const Sighting& seen : in_.landmarks) AddLandmark(seen);
    for (const auto& camera : in_.cameras) AddTags(*camera);
    // Topics come one after the other; MakeRangeLog wants them in the order of time, as far as that goes.
    SortByTime(&ranges_.events);
    MergeOdometry();
    if (!noise->heading_walk_rad_per_sqrt_m)
      noise->heading_walk_rad_per_sqrt_m = in_.noise.heading_walk_rad_per_sqrt_m;
    if (tags_ > 0 && !noise->range_m) noise->range_m = std::sqrt(tag_range_squares_ / tags_);
    if (tags_ > 0 && !noise->bearing_rad) noise->bearing_rad = std::sqrt(tag_bearing_squares_ / tags_);
    return std::move(ranges_);
  }

  // Where what lies in `frame` lies on the robot. Throws InputError where nothing says so.
  Transform MountOf(const std::string& topic, const std::string& frame) {
    if (const auto given = GivenMount(topic, frame)) return Level(*given);
    const bool is_usual = std::ranges::find(kUsualBases, WithoutRobot(frame)) != kUsualBases.end();
    if (frame == in_.base || (in_.base.empty() && is_usual)) return {};
    if (frame.empty()) {
      WarnOnce(topic +
               ": its headers name no frame: it is taken to sit in the robot's middle, looking ahead; " +
               "--mount " + topic + "=X,Y,DEGREES says where it does");
      return {};
    }
    const auto mount = in_.frames.Find(in_.base, frame);
    if (!mount)
      throw InputError(in_.path + ": " + topic + " is of the frame '" + Printable(frame, 80) +
                       "', and no tf says where that is on '" + Printable(in_.base, 80) + "'" +
                       (in_.frames.size() == 0 ? " (there is no tf at all)" : "") + ": --mount " + topic +
                       "=X,Y,DEGREES says it");
    if (!mount->moves.empty())
      WarnOnce(topic + ": " + NameList(mount->moves) + " moves on the robot: where it was first counts");
    return mount->transform;
  }

 private:
  std::optional<Pose> GivenMount(const std::string& topic, const std::string& frame) const {
    for (const std::string& name : {topic, frame, WithoutRobot(topic), WithoutRobot(frame)})
      if (const auto given = in_.mounts.find(name); given != in_.mounts.end()) return given->second;
    return std::nullopt;
  }

  // Nothing where nobody says where it sits.
  std::optional<Pose> Antenna() const {
    if (const auto given = GivenMount(in_.fixes.topic, in_.fixes.frame)) return given;
    if (!in_.fixes.frame.empty() && in_.fixes.frame == in_.base) return Pose();
    const auto mount = in_.frames.Find(in_.base, in_.fixes.frame);
    return mount ? std::optional<Pose>(mount->transform.Planar()) : std::nullopt;
  }

  void TakeOdometryOfFrames() {
    auto moving = in_.frames.MovingOn("odom", in_.robot);
    if (!in_.base.empty())
      std::erase_if(moving, [&](const auto& one) { return one.second != OwnFrame(in_.base); });
    if (moving.empty()) {
      if (!in_.poses.empty() || in_.poses_by_tf) return;
      const std::string velocities = TopicList(in_.topics, {Use::kVelocity});
      throw InputError(
          in_.path + ": no odometry: neither a topic of nav_msgs/Odometry nor a frame that moves on " +
          "'odom' in tf" +
          (velocities.empty() ? std::string() : "; --odometry TOPIC takes velocities: " + velocities));
    }
    if (moving.size() > 1) {
      std::vector<std::string> names;
      for (const auto& [parent, child] : moving) names.push_back(child);
      throw InputError(in_.path + ": several frames move on 'odom': " + NameList(names) +
                       "; --base FRAME says which of them the robot is");
    }
    in_.odometry.frame = moving.front().first;
    in_.odometry.base = moving.front().second;
    in_.odometry.poses = RowsOf(in_.frames.TrackOf(in_.odometry.base));
    report_.read["transforms of " + in_.odometry.base + " on " + in_.odometry.frame + ", as odometry"] =
        static_cast<std::int64_t>(in_.odometry.poses.size());
  }

  // In tf of several robots their frames begin with their names.
  std::string OwnFrame(const std::string& frame) const {
    const std::string own = in_.robot + "/" + frame;
    return !in_.robot.empty() && in_.frames.Knows(own) ? own : frame;
  }

  void ChooseBase() {
    if (in_.base.empty()) in_.base = in_.odometry.base;
    if (!in_.frames.Knows(in_.base)) in_.base = OwnFrame(in_.base);
    for (const char* usual : kUsualBases)
      if (in_.base.empty() && in_.frames.Knows(usual)) in_.base = usual;
  }

  void CompareWithOthers() {
    const auto compare = [&](const std::string& name, const SpooledRows<PoseRow>& poses) {
      CompareOdometries(in_.odometry_topic, in_.odometry.poses, name, poses, &report_);
    };
    for (const auto& other : in_.others) compare(other->topic, other->rows.poses);
    if (in_.odometry_topic == "tf") return;
    for (const auto& [parent, child] : in_.frames.MovingOn("odom", in_.robot))
      if (child == in_.base || child.ends_with("base_link") || child.ends_with("base_footprint"))
        compare(parent + " > " + child + " of tf", RowsOf(in_.frames.TrackOf(child)));
  }

  static SpooledRows<PoseRow> RowsOf(const SpooledRows<TimedPose>& track) {
    SpooledRows<PoseRow> rows(track.folder());
    for (const TimedPose& pose : track)
      if (pose.time_s > 0) rows.push_back({pose.time_s, rows.size() + 1, pose.pose});
    return rows;
  }

  void TakePosesOfTf() {
    if (in_.truth_by_tf)
      in_.truth = PosesOnMap(in_.frames, in_.robot, in_.base, in_.path + ": --truth tf", &report_);
    if (in_.poses_by_tf)
      in_.poses = PosesOnMap(in_.frames, in_.robot, in_.base, in_.path + ": --poses tf", &report_);
  }

  void TurnOdometry() {
    const GyroRows& gyro = in_.gyro;
    std::optional<FrameTree::Mount> mount;
    if (gyro.frame != in_.base) mount = in_.frames.Find(in_.base, gyro.frame);
    if (!mount && gyro.frame != in_.base)
      WarnOnce(gyro.topic + ": no tf says how '" + Printable(gyro.frame, 80) +
               "' lies on the robot: it is taken to lie level");
    TurnByGyro(gyro, mount ? mount->transform : Transform(), &in_.odometry.poses, &report_);
  }

  static RangeEvent EventOf(const PoseRow& row, const auto& which) {
    RangeEvent event;
    event.line = row.number;
    event.stamp_s = row.time_s;
    event.*which = row.pose;
    return event;
  }
  void AddPoses(const SpooledRows<PoseRow>& rows, const auto& which) {
    for (const PoseRow& row : rows) ranges_.events.push_back(EventOf(row, which));
  }

  // Most events are odometry, which stands before others of its time.
  void MergeOdometry() {
    SpooledRows<PoseRow>& poses = in_.odometry.poses;
    SpooledRows<RangeEvent> merged(in_.folder);
    std::size_t next = 0;
    const auto add_before = [&](const RangeEvent* event) {
      for (; next < poses.size() && (event == nullptr || poses[next].time_s <= event->stamp_s); ++next)
        merged.push_back(EventOf(poses[next], &RangeEvent::odometry));
    };
    for (const RangeEvent& event : ranges_.events) {
      add_before(&event);
      merged.push_back(event);
    }
    add_before(nullptr);
    ranges_.events = std::move(merged);
    poses.clear();
  }

  // What a filter says of its heading grows with the way, where the filter knows nothing but odometry.
  void TakeNoiseOfCovariances() {
    if (!in_.odometry.has_covariances || !in_.gyro.topic.empty() || in_.noise.heading_walk_rad_per_sqrt_m)
      return;
    double way_m = 0;
    const SpooledRows<PoseRow>& poses = in_.odometry.poses;
    for (std::size_t i = 1; i < poses.size(); ++i)
      way_m +=
          DistanceM({poses[i].pose.x_m, poses[i].pose.y_m}, {poses[i - 1].pose.x_m, poses[i - 1].pose.y_m});
    constexpr double kLeastWay_m = 5, kMostVariance = 10, kLeastWalk = 1e-3, kMostWalk = 0.3;
    const double first = in_.odometry.first_variance, last = in_.odometry.last_variance;
    const double walk = std::sqrt((last - first) / way_m);
    if (way_m > kLeastWay_m && first >= 0 && last < kMostVariance && walk > kLeastWalk && walk < kMostWalk) {
      in_.noise.heading_walk_rad_per_sqrt_m = walk;
      report_.warnings.push_back(in_.odometry_topic + ": its covariances give the heading's random walk: " +
                                 std::to_string(walk) + " rad in a metre");
      return;
    }
    const std::string why = first == 0 && last == 0 ? "are zero"
                            : last >= kMostVariance || first >= kMostVariance || first < 0
                                ? "are of no heading (" + std::to_string(last) + " rad^2)"
                            : first == last ? "do not change"
                                            : "do not grow with the way as those of odometry do";
    if (way_m > kLeastWay_m)
      report_.warnings.push_back(in_.odometry_topic + ": its covariances " + why +
                                 ": no noise is taken from them");
  }

  // "/scan" of "/robot1/scan".
  std::string WithoutRobot(const std::string& name) const {
    const std::size_t at = name.starts_with('/') ? 1 : 0;
    if (in_.robot.empty() || name.compare(at, in_.robot.size() + 1, in_.robot + "/") != 0) return name;
    return name.substr(0, at) + name.substr(at + in_.robot.size() + 1);
  }

  void WarnOnce(const std::string& warning) {
    if (warned_.insert(warning).second) report_.warnings.push_back(warning);
  }

  static void AddBeam(const Transform& mount, double angle_rad, RangeRows* rows, double* steepest) {
    rows->beam_x_m.push_back(mount.x);
    rows->beam_y_m.push_back(mount.y);
    if (mount.IsLevel()) {
      rows->beam_heading_rad.push_back(NormalizedAngle(mount.Yaw() + angle_rad));
      return;
    }
    const PointInSpace tip = Apply(mount, {std::cos(angle_rad), std::sin(angle_rad), 0});
    rows->beam_heading_rad.push_back(std::atan2(tip.y - mount.y, tip.x - mount.x));
    *steepest = std::max(*steepest, std::asin(std::min(1.0, std::abs(tip.z - mount.z))));
  }

  void WarnOfTilt(const std::string& topic, double steepest) {
    constexpr double kMost = 5 * kDegree;
    if (steepest > kMost)
      WarnOnce(topic + ": its beams point up or down by as much as " +
               std::to_string(static_cast<int>(std::lround(steepest / kDegree))) +
               " degrees: they are taken for level ones");
  }

  void AddLaser(ScanTopic* scan) {
    if (scan->times.empty()) return;
    constexpr std::size_t kMostLasers = 5;
    if (lasers_ == kMostLasers) throw InputError("a log has at most five lasers; --scan names which");
    RangeRows rows;
    rows.sensor = lasers_ == 0 ? "laser" : "laser" + std::to_string(lasers_ + 1);
    ++lasers_;
    rows.max_range_m = scan->max_range_m;
    rows.beams_kept = BeamsWithPoints(*scan);
    const Transform mount = scan->level_at ? Level(*scan->level_at) : MountOf(scan->topic, scan->frame);
    double steepest = 0;
    for (std::size_t beam = 0; beam < scan->beams; ++beam)
      if (rows.beams_kept.empty() || rows.beams_kept[beam])
        AddBeam(mount, scan->first_rad + static_cast<double>(beam) * scan->step_rad, &rows, &steepest);
    WarnOfTilt(scan->topic, steepest);
    RangeEvent event;
    event.sensor = static_cast<std::uint32_t>(ranges_.sensors.size());
    event.row = 0;
    for (const ScanTime& scanned : scan->times) {
      event.line = scanned.number;
      event.stamp_s = scanned.time_s;
      ranges_.events.push_back(event);
      ++*event.row;
    }
    scan->times.clear();
    rows.scans = std::make_shared<ScanRows>(std::move(scan->scans));
    ranges_.sensors.push_back(std::move(rows));
  }

  // Where a cloud has points in less than one of a hundred scans its sensor does not look.
  static std::vector<bool> BeamsWithPoints(const ScanTopic& scan) {
    std::vector<bool> beams;
    for (const std::size_t count : scan.scans_with_points)
      beams.push_back(count > 0 && 100 * count >= scan.times.size());
    if (!beams.empty() && std::ranges::find(beams, true) == beams.end())
      throw InputError(scan.topic + ": there is hardly a point in its clouds");
    return beams;
  }

  // A round is over when each sensor has said something; what one says twice in it counts as it said it last.
  void AddRing(const char* name, bool is_infrared) {
    struct Reading {
      double time_s;
      std::size_t beam, number;
      double range_m;
    };
    RangeRows rows;
    rows.sensor = name;
    SpooledRows<Reading> readings(in_.folder);
    double steepest = 0;
    for (const auto& sonar : in_.sonars) {
      if (sonar->is_infrared != is_infrared || sonar->cones.empty()) continue;
      const std::size_t beam = rows.beam_x_m.size();
      AddBeam(MountOf(sonar->topic, sonar->frame), 0, &rows, &steepest);
      WarnOfTilt(sonar->topic, steepest);
      if (beam > 0 && rows.opening_rad != sonar->opening_rad)
        WarnOnce(sonar->topic + ": its cone is not as wide as that of the first of the ring, which counts");
      if (beam == 0) rows.opening_rad = sonar->opening_rad;
      rows.max_range_m = std::max(rows.max_range_m, sonar->max_range_m);
      for (const ConeReading& one : sonar->cones)
        readings.push_back(
            {one.time_s, beam, one.number,
             one.range_m < sonar->max_range_m ? one.range_m : std::numeric_limits<double>::quiet_NaN()});
    }
    if (readings.empty()) return;
    SortRows(&readings, [](const Reading& reading) { return reading.time_s; });
    const std::size_t beams = rows.beam_x_m.size();
    rows.scans = std::make_shared<ScanRows>(in_.folder, beams, rows.max_range_m);
    std::vector<double> round(beams);
    std::set<std::size_t> heard;
    RepeatedRows repeated("reading of " + rows.sensor, &report_);
    for (const Reading& reading : readings) {
      if (repeated.Is({}, reading.time_s, {static_cast<double>(reading.beam), reading.range_m})) continue;
      round[reading.beam] = reading.range_m;
      if (!heard.insert(reading.beam).second)
        ++report_.dropped["readings of " + rows.sensor + ", of one that spoke again before all had spoken"];
      if (heard.size() < beams) continue;
      RangeEvent event;
      event.line = reading.number;
      event.stamp_s = reading.time_s;
      event.sensor = static_cast<std::uint32_t>(ranges_.sensors.size());
      event.row = static_cast<std::uint32_t>(rows.scans->size());
      rows.scans->Add(round, 0, {});
      ranges_.events.push_back(event);
      heard.clear();
    }
    ranges_.sensors.push_back(std::move(rows));
  }

  void AddLandmark(const Sighting& seen) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    RangeEvent event;
    event.line = seen.number;
    event.stamp_s = seen.time_s;
    event.landmark =
        ranges_.things.Keep(seen.is_contact ? LandmarkSeen{seen.name, kNan, kNan} : PlaceOf(seen));
    ranges_.events.push_back(event);
  }

  // Of a camera's optical frame, x to the right and z ahead. One that somebody places looks along its x axis,
  // as does a frame whose z axis points up: that of the camera's body.
  Transform MountOfCamera(const TagCamera& camera) {
    const Transform mount = MountOf(camera.source().topic, camera.frame());
    const Transform optical{0, 0, 0, -0.5, 0.5, -0.5, 0.5};
    constexpr double kUpright = 0.9;
    const double up = Apply(mount, {0, 0, 1}).z - mount.z;
    return up > kUpright ? Compose(mount, optical) : mount;
  }

  // With how far off it may be along and across the way to it.
  void AddTags(const TagCamera& camera) {
    if (camera.seen().empty()) return;
    const Transform mount = MountOfCamera(camera), back = Inverse(mount);
    for (const TagCamera::Seen& seen : camera.seen()) {
      const PointInSpace at = Apply(mount, seen.tag.point);
      const double range_m = std::hypot(at.x, at.y);
      const auto variance_along = [&](double x, double y) {
        const PointInSpace end = Apply(back, {mount.x + x, mount.y + y, mount.z});
        const Eigen::Vector3d direction(end.x, end.y, end.z);
        return direction.dot(seen.covariance * direction);
      };
      tag_range_squares_ += variance_along(at.x / range_m, at.y / range_m);
      tag_bearing_squares_ += variance_along(-at.y / range_m, at.x / range_m) / (range_m * range_m);
      tags_ += 1;
      RangeEvent event;
      event.line = seen.tag.number;
      event.stamp_s = seen.tag.time_s;
      event.landmark = ranges_.things.Keep(LandmarkSeen{seen.tag.name, range_m, std::atan2(at.y, at.x)});
      ranges_.events.push_back(event);
    }
  }

  LandmarkSeen PlaceOf(const Sighting& seen) {
    const auto [mount, is_new] = cameras_.try_emplace(seen.frame);
    if (is_new) mount->second = MountOf(seen.frame.empty() ? "--landmarks" : seen.frame, seen.frame);
    const PointInSpace at = Apply(mount->second, seen.point);
    return {seen.name, std::hypot(at.x, at.y), std::atan2(at.y, at.x)};
  }

  Gathered in_;
  ImportReport& report_;
  RangeLog ranges_;
  std::size_t lasers_ = 0;
  double tags_ = 0, tag_range_squares_ = 0, tag_bearing_squares_ = 0;
  std::map<std::string, Transform> cameras_;  // by frame
  std::set<std::string> warned_;
};

}  // namespace

FindMount MountsOf(Gathered robot) {
  struct Places {
    explicit Places(Gathered gathered) : log(std::move(gathered), &report) {
      log.FindBase();
      log.ForgetPaths();
    }
    ImportReport report;  // the import's own pass says the same again
    BagLog log;
  };
  return
      [places = std::make_shared<Places>(std::move(robot))](
          const std::string& topic, const std::string& frame) { return places->log.MountOf(topic, frame); };
}

ImportReport MakeBagLog(std::vector<Gathered> robots, ImportReport report, Blob* log) {
  NoiseParameters noise = robots.front().noise;
  std::vector<RangeLog> ranges;
  std::optional<Fix> origin;  // of all their fixes
  for (Gathered& robot : robots) ranges.push_back(BagLog(std::move(robot), &report).Make(&noise, &origin));
  BadLines none(true);
  return MakeRangeLog(std::move(ranges), noise, &none, std::move(report), log);
}

}  // namespace cairn::datasets::bag
