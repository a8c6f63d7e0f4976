#include "datasets/report/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "datasets/common/control.h"
#include "datasets/common/landmark_labels.h"
#include "datasets/evaluate/landmarks.h"
#include "datasets/evaluate/track.h"
#include "datasets/report/drawing/format.h"
#include "schema/kinds/grid_map.h"
#include "schema/kinds/landmark_map.h"
#include "schema/kinds/log.h"

namespace cairn::datasets::report {
namespace {

constexpr double kChiSquared95 = 5.991464547107979;

Path ToPath(const Track& track, const std::string& robot, std::size_t index) {
  Path path{.robot = robot, .index = index, .points = {}, .time_s = track.time_s};
  for (const Pose& pose : track.poses) path.points.push_back({pose.x_m, pose.y_m});
  return path;
}

class SceneMaker {
 public:
  SceneMaker(const Blob& result, const Blob* log, const Evaluation* evaluation)
      : result_(result),
        map_(FieldsIn<kinds::LandmarkMap::Map>("map/", result)),
        log_(log == nullptr ? std::nullopt : std::optional(Read<kinds::Log>(*log))),
        evaluation_(evaluation) {}

  Scene Make() {
    const std::vector<std::string> names = Texts::In(result_, "robots").OrNone();
    for (std::size_t r = 0; r < names.size(); ++r) {
      const Track track = TrackOf(kinds::LikeliestPoses("robot/" + std::to_string(r) + "/poses/", result_));
      scene_.paths.push_back(ToPath(track, names[r], r));
      if (log_ && !track.poses.empty()) AddOdometry(track, names[r], r);
      if (log_ && evaluation_ != nullptr) AddTruthPath(names[r], r);
    }
    if (map_.landmark_x_m) AddLandmarks();
    AddRounds();
    if (log_ && evaluation_ != nullptr) AddTruthLandmarks();
    if (map_.probability) AddGrid();
    return std::move(scene_);
  }

 private:
  Point FromTruth(Point truth) const { return Inverse(evaluation_->alignment)(truth); }

  // Of the observations at the robot itself.
  static std::vector<double> ContactTimes(const kinds::Log::Observations& observations) {
    std::vector<double> contacts;
    for (std::size_t i = 0; i < observations.time_s.size(); ++i) {
      if (std::isnan(observations.range_m[i])) contacts.push_back(observations.time_s[i]);
    }
    return contacts;
  }

  void AddOdometry(const Track& track, const std::string& name, std::size_t r) {
    const kinds::Log::Odometry& odometry = log_->robot.at(r).odometry;
    const std::span<const double> time = odometry.time_s;
    const std::vector<double> marks = ContactTimes(log_->robot[r].observations);
    Path path{.robot = name, .index = r, .points = {}}, at_marks = path;
    Pose pose = track.poses.front();
    path.points.push_back({pose.x_m, pose.y_m});
    std::size_t next_mark = 0;
    for (std::size_t i = 0; i < time.size(); ++i) {
      for (; next_mark < marks.size() && marks[next_mark] < time[i]; ++next_mark) {
        at_marks.points.push_back({pose.x_m, pose.y_m});
      }
      if (time[i] <= track.time_s.front()) continue;
      pose = Apply(pose, {odometry.turn_rad[i], odometry.forward_m[i]});
      path.points.push_back({pose.x_m, pose.y_m});
    }
    for (; next_mark < marks.size(); ++next_mark) at_marks.points.push_back({pose.x_m, pose.y_m});
    scene_.odometry.push_back(std::move(path));
    scene_.odometry_marks.push_back(std::move(at_marks));
  }

  void AddTruthPath(const std::string& name, std::size_t r) {
    if (r >= log_->truth.robot.size()) return;
    const Track truth = TrackOf(log_->truth.robot[r].poses);
    Path path = ToPath(truth, name, r);
    if (path.points.empty()) return;
    path.breaks = BreaksOf(truth.time_s);
    for (Point& point : path.points) point = FromTruth(point);
    scene_.truth_paths.push_back(std::move(path));
  }

  void AddLandmarks() {
    const std::vector<Point> points = PointsOf(map_.landmark_x_m, map_.landmark_y_m);
    const std::span<const double> covariance = map_.landmark_covariance_m2;
    const std::span<const std::int32_t> identity = map_.landmark_identity;
    const auto moved = FieldsIn<kinds::LandmarkMap::Moved>("moved/", result_);
    const std::vector<std::string> labels = LandmarkLabels(map_, Texts::In(result_, "landmarks").OrNone());
    for (std::size_t k = 0; k < points.size(); ++k) {
      MapLandmark landmark;
      landmark.at = points[k];
      landmark.ellipse = EllipseOf(points[k], {covariance[4 * k], covariance[4 * k + 1],
                                               covariance[4 * k + 2], covariance[4 * k + 3]});
      landmark.count = map_.landmark_count[k];
      landmark.identified = identity[k] >= 0;
      landmark.name = labels[k];
      landmark.spurious = evaluation_ != nullptr && evaluation_->landmarks.has_value();
      for (std::size_t m = 0; m < moved.landmark.OrNone().size(); ++m)
        if (moved.landmark[m] == identity[k])
          landmark.moved = fmt::format(", was moved between {} s and {} s", Short(moved.until_s[m], 1),
                                       Short(moved.from_s[m], 1));
      scene_.landmarks.push_back(std::move(landmark));
    }
  }

  // An iteration that made no map shows the one before it.
  void AddRounds() {
    const auto history = FieldsIn<kinds::LandmarkMap::History>("history/", result_);
    if (!history.landmark_iteration) return;
    const std::span<const std::int64_t> iteration = history.landmark_iteration;
    const std::vector<Point> landmarks = PointsOf(history.landmark_x_m, history.landmark_y_m);
    std::int64_t last = -1;
    for (std::size_t j = 0; j < landmarks.size(); ++j) {
      if (j == 0 || iteration[j] != last) scene_.rounds.emplace_back();
      last = iteration[j];
      scene_.rounds.back().push_back(landmarks[j]);
    }
  }

  void AddTruthLandmarks() {
    if (!evaluation_->landmarks) return;
    const std::vector<Point> truth = PointsOf(log_->truth.landmarks.x_m, log_->truth.landmarks.y_m);
    const std::vector<bool> observed = ObservedLandmarks(*log_);
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
    const Shape& shape = map_.probability.shape();
    const std::span<const double> values = map_.probability;
    if (shape.size() != 3 || values.empty()) return;
    Grid grid{{map_.grid.origin_x_m.Scalar(), map_.grid.origin_y_m.Scalar()},
              map_.grid.cell_m.Scalar(),
              shape[2],
              shape[1],
              {}};
    const auto cells = static_cast<std::size_t>(grid.rows * grid.columns);
    grid.probability.assign(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(cells));
    for (std::size_t i = cells; i < values.size(); ++i) {
      grid.probability[i % cells] = std::max(grid.probability[i % cells], values[i]);
    }
    scene_.grid = std::move(grid);
  }

  const Blob& result_;
  const kinds::LandmarkMap::Map map_;
  const std::optional<kinds::Log> log_;
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

std::vector<Path> Pieces(const Path& path) {
  std::vector<Path> pieces;
  std::size_t first = 0;
  const auto cut = [&](std::size_t end) {
    if (first >= end) return;
    const auto begin = static_cast<std::ptrdiff_t>(first), stop = static_cast<std::ptrdiff_t>(end);
    Path piece{.robot = path.robot, .index = path.index, .points = {}};
    piece.points.assign(path.points.begin() + begin, path.points.begin() + stop);
    if (!path.time_s.empty()) piece.time_s.assign(path.time_s.begin() + begin, path.time_s.begin() + stop);
    pieces.push_back(std::move(piece));
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
  const auto of = Read<kinds::GridMap>(map);
  for (std::size_t r = 0; r < of.robot.size(); ++r) {
    const auto has_scans = [](const kinds::GridMap::Sensor& s) { return s.held_out ? s.x_m.size() : 0; };
    const auto most = std::ranges::max_element(of.robot[r].sensors, {}, has_scans);
    if (most == of.robot[r].sensors.end() || has_scans(*most) == 0) continue;
    const std::vector<std::string>& names = of.robots.OrNone();
    Path path{.robot = r < names.size() ? names[r] : std::to_string(r), .index = r, .points = {}};
    for (std::size_t i = 0; i < most->x_m.size(); ++i) path.points.push_back({most->x_m[i], most->y_m[i]});
    if (most->time_s) {
      const std::span<const double> time = most->time_s;
      path.time_s.assign(time.begin(), time.end());
      path.breaks = BreaksOf(time);
    }
    scene.paths.push_back(std::move(path));
  }
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
  // Those of a map that is still being made move far.
  for (const std::vector<Point>& round : scene.rounds)
    for (const Point& point : round)
      if (scene.paths.empty()) bounds.Add(point);
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
