#include "datasets/import/g2o.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "datasets/common/fields.h"
#include "datasets/import/name_index.h"
#include "datasets/import/pose_controls.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

// Another number than poses have that are counted.
constexpr std::size_t kMostNumber = std::size_t{1} << 40;

struct Sighting {
  std::size_t landmark = 0;
  Point at;  // as the pose sees it
  std::size_t line = 0;
};

Pose Inverse(const Pose& pose) { return Between(pose, Pose{}); }

// The upper triangle of an edge's information from field `first` on, row by row, where the edge has one. One
// that is no inverse of a covariance is of another writer's mind: of signs, or of columns.
void CheckInformation(const Fields& line, std::size_t first, std::size_t rows) {
  if (line.size() <= first) return;
  std::array<double, 6> of{0, 0, 0, 0, 0, 1};  // of two rows the third is of something else
  for (std::size_t i = 0, row = 0; row < rows; ++row)
    for (std::size_t column = row; column < rows; ++column) {
      const std::array<std::size_t, 3> begin{0, 3, 5};
      of[begin[row] + column - row] = line.Number(first + i++);
    }
  const auto& [xx, xy, xt, yy, yt, tt] = of;
  constexpr double kRounded = 1e-6;  // as files have them
  const auto minor = [](double a, double b, double ab) { return a * b * (1 + kRounded) - ab * ab; };
  const double determinant = xx * (yy * tt - yt * yt) - xy * (xy * tt - yt * xt) + xt * (xy * yt - yy * xt);
  if (std::min({xx, yy, tt, minor(xx, yy, xy), minor(xx, tt, xt), minor(yy, tt, yt),
                determinant + kRounded * xx * yy * tt}) < 0)
    throw LineError{
        "information that is no matrix of weights",
        "it must be positive semidefinite; its diagonal begins with " + std::string(line.Text(first))};
}

class G2oImport {
 public:
  explicit G2oImport(const G2oImportOptions& options) : options_(options), bad_(options.skip_bad) {}

  ImportReport Run(Blob* log) {
    CheckNoise(options_.noise);
    if (!(options_.step_s > 0)) throw InputError("a step from pose to pose takes more than 0 s");
    ForEachLine(options_.file, &bad_, [&](const Fields& line, std::size_t number) { Read(line, number); });
    if (steps_.empty())
      throw InputError(options_.file +
                       ": there is no EDGE_SE2 between poses whose numbers follow each other");
    DropOtherEdges();
    rows_.noise = options_.noise;
    for (auto step = steps_.begin(); step != steps_.end();) step = AddRobot(step);
    for (const auto& [pose, seen] : seen_)
      report_.dropped["observation from a pose without odometry"] += static_cast<std::int64_t>(seen.size());
    NumberLandmarks();
    report_.skipped = bad_.counts();
    *log = MakeLog(std::move(rows_), options_.file, &report_);
    return report_;
  }

 private:
  using Steps = std::map<std::size_t, std::pair<Pose, std::size_t>>;  // by the pose before: motion, line

  void Read(const Fields& line, std::size_t number) {
    const std::string_view tag = line.Text(0);
    if (tag.find("SE3") != std::string_view::npos || tag.find("XYZ") != std::string_view::npos)
      throw InputError(options_.file + ":" + std::to_string(number) + ": " + std::string(tag) +
                       ": a graph of three dimensions, and a log is of the plane");
    if (tag == "EDGE_SE2") return ReadStep(line, number);
    if (tag == "EDGE_SE2_XY") return ReadSighting(line, number);
    if (tag.starts_with("EDGE"))
      ++report_.dropped["edge of another kind"];
    else if (!tag.starts_with("VERTEX") && tag != "FIX" && !tag.starts_with("PARAMS"))
      throw UnknownMessage(tag);
  }

  void ReadStep(const Fields& line, std::size_t number) {
    const std::size_t from = line.Count(1, kMostNumber), to = line.Count(2, kMostNumber);
    const Pose motion = line.PoseAt(3);
    CheckInformation(line, 6, 3);
    const bool forward = to == from + 1;
    const bool is_step = forward || from == to + 1;
    if (is_step && steps_.try_emplace(std::min(from, to), forward ? motion : Inverse(motion), number).second)
      return;
    others_.emplace_back(std::min(from, to), std::max(from, to));
  }

  // One between poses without a step between them is the way over a gap, not a loop.
  void DropOtherEdges() {
    for (const auto& [low, high] : others_) {
      const auto next = steps_.lower_bound(low);
      const bool is_gap = low < high && (next == steps_.end() || next->first >= high);
      ++report_.dropped[is_gap ? "odometry over a gap in the poses' numbers" : "loop between two poses"];
    }
  }

  void ReadSighting(const Fields& line, std::size_t number) {
    const std::size_t from = line.Count(1, kMostNumber), landmark = line.Count(2, kMostNumber);
    const Point at{line.Place(3), line.Place(4)};
    CheckInformation(line, 5, 2);
    const auto wrong = FindMisreading(std::hypot(at.x_m, at.y_m), std::atan2(at.y_m, at.x_m), options_.noise);
    if (wrong) throw LineError{wrong->reason, wrong->detail};
    seen_[from].push_back({landmark, at, number});
  }

  // Of the poses that follow `step`'s without a gap. Returns the first step behind them.
  Steps::iterator AddRobot(Steps::iterator step) {
    constexpr std::size_t kMostRobots = 1000;
    if (rows_.robots.size() == kMostRobots)
      throw InputError(options_.file + ": more than 1000 times a pose does not follow the one before it");
    RobotRows& robot = rows_.robots.emplace_back();
    robot.name = "robot " + std::to_string(rows_.robots.size() - 1);
    robot.odometry_poses.from.file = robot.observations.from.file = options_.file;
    std::size_t at = step->first;
    Pose pose;
    AddPose(at, pose, step->second.second, &robot);
    for (; step != steps_.end() && step->first == at; ++step) {
      pose = Compose(pose, step->second.first);
      AddPose(++at, pose, step->second.second, &robot);
    }
    robot.odometry = ControlsOf(robot.odometry_poses);
    return step;
  }

  void AddPose(std::size_t number, const Pose& pose, std::size_t line, RobotRows* robot) {
    const double time_s = static_cast<double>(number - steps_.begin()->first) * options_.step_s;
    robot->odometry_poses.Add(time_s, pose.x_m, pose.y_m, pose.heading_rad, line);
    const auto seen = seen_.find(number);
    if (seen == seen_.end()) return;
    Observations& rows = robot->observations;
    for (const Sighting& s : seen->second) {
      const std::int32_t landmark = landmarks_.FindOrAdd(std::to_string(s.landmark));
      const bool contact = s.at.x_m == 0 && s.at.y_m == 0;
      rows.Add(time_s, landmark, contact ? NAN : std::hypot(s.at.x_m, s.at.y_m),
               contact ? NAN : std::atan2(s.at.y_m, s.at.x_m));
      rows.from.line.push_back(s.line);
    }
    seen_.erase(seen);
  }

  // By their numbers.
  void NumberLandmarks() {
    const std::vector<std::int32_t> number_of = landmarks_.Sort();
    rows_.landmarks = landmarks_.names();
    for (RobotRows& robot : rows_.robots)
      for (std::int32_t& landmark : robot.observations.landmark)
        landmark = number_of[static_cast<std::size_t>(landmark)];
  }

  const G2oImportOptions& options_;
  BadLines bad_;
  ImportReport report_;
  LogRows rows_;
  Steps steps_;
  std::vector<std::pair<std::size_t, std::size_t>>
      others_;                                         // edges between poses that do not follow each other
  std::map<std::size_t, std::vector<Sighting>> seen_;  // by the pose that sees
  NameIndex landmarks_;
};

}  // namespace

ImportReport ImportG2o(const G2oImportOptions& options, Blob* log) { return G2oImport(options).Run(log); }

}  // namespace cairn::datasets
