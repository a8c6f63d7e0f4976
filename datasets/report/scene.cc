#include "datasets/report/scene.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>

#include "datasets/common/control.h"
#include "datasets/evaluate/landmarks.h"
#include "datasets/evaluate/track.h"
#include "datasets/report/drawing/format.h"

namespace cairn::datasets::report {
namespace {

constexpr double kChiSquared95 = 5.991464547107979;

Path ToPath(const Track& track, const std::string& robot, std::size_t index) {
  Path path{.robot = robot, .index = index, .points = {}};
  for (const Pose& pose : track.poses) path.points.push_back({pose.x_m, pose.y_m});
  return path;
}

class SceneMaker {
 public:
  SceneMaker(const Blob& result, const Blob* log, const Evaluation* evaluation)
      : result_(result), log_(log), evaluation_(evaluation) {}

  Scene Make() {
    std::vector<std::string> names;
    if (result_.Has("robots")) names = result_.Texts("robots");
    for (std::size_t r = 0; r < names.size(); ++r) {
      const std::string poses = "robot/" + std::to_string(r) + "/poses/";
      const Track track = ReadTrack(result_, poses, result_.Has(poses + "mode_x_m") ? "mode_" : "");
      scene_.paths.push_back(ToPath(track, names[r], r));
      if (log_ != nullptr && !track.poses.empty()) AddOdometry(track, names[r], r);
      if (log_ != nullptr && evaluation_ != nullptr) AddTruthPath(names[r], r);
    }
    if (result_.Has("map/landmark_x_m")) AddLandmarks();
    if (log_ != nullptr && evaluation_ != nullptr) AddTruthLandmarks();
    if (result_.Has("map/grid/probability")) AddGrid();
    return std::move(scene_);
  }

 private:
  Point FromTruth(Point truth) const { return Inverse(evaluation_->alignment)(truth); }

  // Of the observations at the robot itself.
  std::vector<double> ContactTimes(const std::string& observations) const {
    const auto time = log_->Get<double>(observations + "time_s");
    const auto range = log_->Get<double>(observations + "range_m");
    std::vector<double> contacts;
    for (std::size_t i = 0; i < time.size(); ++i) {
      if (std::isnan(range[i])) contacts.push_back(time[i]);
    }
    return contacts;
  }

  void AddOdometry(const Track& track, const std::string& name, std::size_t r) {
    const std::string robot = "robot/" + std::to_string(r) + "/";
    const auto time = log_->Get<double>(robot + "odometry/time_s");
    const auto turn = log_->Get<double>(robot + "odometry/turn_rad");
    const auto forward = log_->Get<double>(robot + "odometry/forward_m");
    const std::vector<double> marks = ContactTimes(robot + "observations/");
    Path path{.robot = name, .index = r, .points = {}}, at_marks = path;
    Pose pose = track.poses.front();
    path.points.push_back({pose.x_m, pose.y_m});
    std::size_t next_mark = 0;
    for (std::size_t i = 0; i < time.size(); ++i) {
      for (; next_mark < marks.size() && marks[next_mark] < time[i]; ++next_mark) {
        at_marks.points.push_back({pose.x_m, pose.y_m});
      }
      if (time[i] <= track.time_s.front()) continue;
      pose = Apply(pose, {turn[i], forward[i]});
      path.points.push_back({pose.x_m, pose.y_m});
    }
    for (; next_mark < marks.size(); ++next_mark) at_marks.points.push_back({pose.x_m, pose.y_m});
    scene_.odometry.push_back(std::move(path));
    scene_.odometry_marks.push_back(std::move(at_marks));
  }

  void AddTruthPath(const std::string& name, std::size_t r) {
    const Track truth = ReadTrack(*log_, "truth/robot/" + std::to_string(r) + "/poses/");
    Path path = ToPath(truth, name, r);
    if (path.points.empty()) return;
    path.breaks = BreaksOf(truth.time_s);
    for (Point& point : path.points) point = FromTruth(point);
    scene_.truth_paths.push_back(std::move(path));
  }

  void AddLandmarks() {
    const auto points = ReadPoints(result_, "map/landmark_x_m", "map/landmark_y_m");
    const auto covariance = result_.Get<double>("map/landmark_covariance_m2");
    const auto count = result_.Get<double>("map/landmark_count");
    const auto identity = result_.Get<std::int32_t>("map/landmark_identity");
    const std::vector<std::string> names = result_.Texts("landmarks");
    for (std::size_t k = 0; k < points.size(); ++k) {
      MapLandmark landmark;
      landmark.at = points[k];
      landmark.ellipse = EllipseOf(points[k], {covariance[4 * k], covariance[4 * k + 1],
                                               covariance[4 * k + 2], covariance[4 * k + 3]});
      landmark.count = count[k];
      const bool known = identity[k] >= 0;
      landmark.identified = known;
      landmark.name = known ? names[static_cast<std::size_t>(identity[k])] : std::to_string(k);
      landmark.spurious = evaluation_ != nullptr && evaluation_->landmarks.has_value();
      scene_.landmarks.push_back(std::move(landmark));
    }
  }

  void AddTruthLandmarks() {
    if (!evaluation_->landmarks) return;
    const auto truth = ReadPoints(*log_, "truth/landmarks/x_m", "truth/landmarks/y_m");
    const std::vector<bool> observed = ObservedLandmarks(*log_, truth.size());
    for (std::size_t t = 0; t < truth.size(); ++t) {
      if (observed[t]) scene_.truth_landmarks.push_back(FromTruth(truth[t]));
    }
    for (const auto& [k, t] : evaluation_->pairs) {
      MapLandmark& landmark = scene_.landmarks.at(static_cast<std::size_t>(k));
      const Point at = FromTruth(truth.at(static_cast<std::size_t>(t)));
      landmark.spurious = false;
      landmark.error_m = DistanceM(landmark.at, at);
      scene_.error_lines.emplace_back(landmark.at, at);
    }
  }

  void AddGrid() {
    const Array& array = result_.at("map/grid/probability");
    if (array.shape().size() != 3 || array.size() == 0) return;
    const auto values = array.As<double>();
    Grid grid;
    grid.origin = {result_.Scalar<double>("map/grid/origin_x_m"),
                   result_.Scalar<double>("map/grid/origin_y_m")};
    grid.cell_m = result_.Scalar<double>("map/grid/cell_m");
    grid.rows = array.shape()[1];
    grid.columns = array.shape()[2];
    const auto cells = static_cast<std::size_t>(grid.rows * grid.columns);
    grid.probability.assign(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(cells));
    for (std::size_t i = cells; i < values.size(); ++i) {
      grid.probability[i % cells] = std::max(grid.probability[i % cells], values[i]);
    }
    scene_.grid = std::move(grid);
  }

  const Blob& result_;
  const Blob* log_;
  const Evaluation* evaluation_;
  Scene scene_;
};

class Bounds {
 public:
  void Add(Point point) {
    if (!(std::abs(point.x_m) <= kFarthest_m && std::abs(point.y_m) <= kFarthest_m))
      throw InputError("a position of (" + Short(point.x_m) + ", " + Short(point.y_m) +
                       ") m is no place on a map");
    box_.x_low_m = std::min(box_.x_low_m, point.x_m);
    box_.x_high_m = std::max(box_.x_high_m, point.x_m);
    box_.y_low_m = std::min(box_.y_low_m, point.y_m);
    box_.y_high_m = std::max(box_.y_high_m, point.y_m);
  }
  void Add(const std::vector<Path>& paths) {
    for (const Path& path : paths) {
      for (const Point& point : path.points) Add(point);
    }
  }
  bool empty() const { return box_.x_low_m > box_.x_high_m; }
  Box Padded() const {
    if (empty()) return {-0.5, 0.5, -0.5, 0.5};
    const double pad = std::max(0.5, 0.04 * std::max(box_.width_m(), box_.height_m()));
    return {box_.x_low_m - pad, box_.x_high_m + pad, box_.y_low_m - pad, box_.y_high_m + pad};
  }

 private:
  static constexpr double kFarthest_m = 1e9;
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Box box_{kInfinity, -kInfinity, kInfinity, -kInfinity};
};

}  // namespace

std::vector<std::vector<Point>> Pieces(const Path& path) {
  std::vector<std::vector<Point>> pieces;
  std::size_t first = 0;
  const auto cut = [&](std::size_t end) {
    const auto begin = path.points.begin();
    if (first < end)
      pieces.emplace_back(begin + static_cast<std::ptrdiff_t>(first),
                          begin + static_cast<std::ptrdiff_t>(end));
    first = end;
  };
  for (const std::size_t at : path.breaks) cut(at);
  cut(path.points.size());
  return pieces;
}

std::vector<std::size_t> BreaksOf(std::span<const double> time_s) {
  constexpr double kTimesUsual = 4;
  std::vector<double> steps;
  for (std::size_t i = 1; i < time_s.size(); ++i) steps.push_back(time_s[i] - time_s[i - 1]);
  if (steps.empty()) return {};
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  const double longest_s = std::max(kMaxGapS, kTimesUsual * *middle);
  std::vector<std::size_t> breaks;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] > longest_s) breaks.push_back(i + 1);
  }
  return breaks;
}

std::vector<std::size_t> NamedLandmarks(const Scene& scene) {
  std::size_t numbers = 0;
  for (const MapLandmark& landmark : scene.landmarks) numbers += landmark.identified ? 0 : 1;
  std::vector<std::size_t> named;
  for (std::size_t k = 0; k < scene.landmarks.size(); ++k) {
    if (scene.landmarks[k].identified || numbers <= kMostNumbers) named.push_back(k);
  }
  return named;
}

std::string RobotTitle(const std::string& name) {
  return name.find_first_not_of("0123456789") == std::string::npos ? "robot " + name : name;
}

Scene MakeScene(const Blob& result, const Blob* log, const Evaluation* evaluation) {
  return SceneMaker(result, log, evaluation).Make();
}

Scene GridSceneOf(const Blob& map, const Blob* log, const GridEvaluation* evaluation) {
  Scene scene;
  const std::vector<std::string> robots =
      map.Has("robots") ? map.Texts("robots") : std::vector<std::string>{};
  std::map<std::size_t, Path> paths;
  for (const auto& [name, array] : map.fields()) {
    constexpr std::string_view kFirst = "robot/", kLast = "held_out";
    if (!name.starts_with(kFirst) || !name.ends_with(kLast)) continue;
    const std::string sensor = name.substr(0, name.size() - kLast.size());
    const std::size_t robot = std::strtoul(name.c_str() + kFirst.size(), nullptr, 10);
    const auto x = map.Get<double>(sensor + "x_m"), y = map.Get<double>(sensor + "y_m");
    Path& path = paths[robot];
    if (x.size() <= path.points.size()) continue;
    path = {
        .robot = robot < robots.size() ? robots[robot] : std::to_string(robot), .index = robot, .points = {}};
    for (std::size_t i = 0; i < x.size(); ++i) path.points.push_back({x[i], y[i]});
    if (!map.Has(sensor + "time_s")) continue;
    const auto time = map.Get<double>(sensor + "time_s");
    if (time.size() == x.size()) path.breaks = BreaksOf(time);
  }
  for (auto& [robot, path] : paths) scene.paths.push_back(std::move(path));
  if (log != nullptr && evaluation != nullptr && log->Has("truth/walls/x_m")) {
    for (const Wall& wall : ReadSegments(*log, "truth/walls/", evaluation->to_map))
      scene.truth_walls.emplace_back(wall.a, wall.b);
  }
  return scene;
}

Box BoundsOf(const Scene& scene, bool with_odometry) {
  Bounds bounds;
  bounds.Add(scene.paths);
  bounds.Add(scene.truth_paths);
  if (with_odometry) bounds.Add(scene.odometry);
  for (const MapLandmark& landmark : scene.landmarks) bounds.Add(landmark.at);
  for (const Point& point : scene.truth_landmarks) bounds.Add(point);
  for (const Point& point : scene.edges) bounds.Add(point);
  for (const auto& [a, b] : scene.truth_walls) {
    bounds.Add(a);
    bounds.Add(b);
  }
  if (bounds.empty() && scene.grid) {
    const Grid& grid = *scene.grid;
    bounds.Add(grid.origin);
    bounds.Add({grid.origin.x_m + static_cast<double>(grid.columns) * grid.cell_m,
                grid.origin.y_m + static_cast<double>(grid.rows) * grid.cell_m});
  }
  return bounds.Padded();
}

EllipseM EllipseOf(Point centre, const std::array<double, 4>& covariance_m2) {
  const double a = covariance_m2[0], b = (covariance_m2[1] + covariance_m2[2]) / 2, d = covariance_m2[3];
  const double middle = (a + d) / 2, spread = std::hypot((a - d) / 2, b);
  EllipseM ellipse;
  ellipse.centre = centre;
  ellipse.major_m = std::sqrt(kChiSquared95 * std::max(0.0, middle + spread));
  ellipse.minor_m = std::sqrt(kChiSquared95 * std::max(0.0, middle - spread));
  ellipse.angle_rad = 0.5 * std::atan2(2 * b, a - d);
  return ellipse;
}

}  // namespace cairn::datasets::report
