#include <algorithm>
#include <cmath>
#include <set>

#include "datasets/common/array_text.h"
#include "datasets/common/landmark_labels.h"
#include "datasets/export/export.h"
#include "datasets/export/parts.h"
#include "schema/kinds/landmark_map.h"
#include "schema/kinds/log.h"

namespace cairn::datasets {
namespace {

// A name as a field; RFC 4180's quotes where it needs them.
std::string Field(const std::string& name) {
  if (name.find_first_of("\r\n") != std::string::npos)
    throw InputError("a name holds a line break: '" + name + "'");
  if (name.find_first_of(",\"") == std::string::npos) return name;
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

// Empty where it is not a number: "at the robot".
std::string Number(double value) { return std::isnan(value) ? std::string() : NumberText(value); }

std::string Name(const std::vector<std::string>& names, std::int32_t index) {
  if (index < 0) return {};
  if (static_cast<std::size_t>(index) >= names.size())
    throw InputError("landmark " + std::to_string(index) + " has no name");
  return Field(names[static_cast<std::size_t>(index)]);
}

// Columns beside each other, those that any robot has; of each robot its times, name and rows.
class RobotTable {
 public:
  explicit RobotTable(std::vector<const char*> names) : names_(std::move(names)) {}
  // `columns`: as the names; may be missing.
  void Add(const std::string& robot, const Column<double>& time_s,
           const std::vector<Column<double>>& columns) {
    if (time_s) robots_.push_back({robot, time_s, columns});
  }
  void Write(const std::string& file, FolderWriter* writer) const {
    std::string header = "time_s,robot", rows;
    std::vector<std::size_t> present;
    for (std::size_t c = 0; c < names_.size(); ++c) {
      if (std::ranges::none_of(robots_, [&](const Robot& r) { return static_cast<bool>(r.columns[c]); }))
        continue;
      present.push_back(c);
      header += "," + std::string(names_[c]);
    }
    if (present.empty()) return;
    for (const Robot& robot : robots_) {
      for (std::size_t i = 0; i < robot.time_s.size(); ++i) {
        rows += NumberText(robot.time_s[i]) + "," + Field(robot.name);
        for (const std::size_t c : present) rows += "," + Number(robot.columns[c][i]);
        rows += "\n";
      }
    }
    writer->Write(file, header + "\n" + rows);
  }

 private:
  struct Robot {
    std::string name;
    Column<double> time_s;
    std::vector<Column<double>> columns;
  };
  std::vector<const char*> names_;
  std::vector<Robot> robots_;
};

void WriteTruth(const kinds::Log& log, FolderWriter* writer) {
  RobotTable poses({"x_m", "y_m", "heading_rad"});
  std::string associations;
  bool any = false;
  const std::vector<std::string>& names = log.truth.landmarks.name.OrNone();
  for (std::size_t n = 0; n < std::min(log.robot.size(), log.truth.robot.size()); ++n) {
    const kinds::Log::TrueRobot& robot = log.truth.robot[n];
    poses.Add(log.robots[n], robot.poses.time_s, {robot.poses.x_m, robot.poses.y_m, robot.poses.heading_rad});
    if (!log.truth.landmarks.name || !robot.landmark) continue;
    any = true;
    for (std::size_t i = 0; i < robot.landmark.size(); ++i)
      associations += NumberText(log.robot[n].observations.time_s[i]) + "," + Field(log.robots[n]) + "," +
                      Name(names, robot.landmark[i]) + "\n";
  }
  poses.Write("truth_poses.csv", writer);
  if (!log.truth.landmarks.name) return;
  std::string rows;
  for (std::size_t k = 0; k < names.size(); ++k)
    rows += Field(names[k]) + "," + NumberText(log.truth.landmarks.x_m[k]) + "," +
            NumberText(log.truth.landmarks.y_m[k]) + "\n";
  writer->Write("truth_landmarks.csv", "landmark,x_m,y_m\n" + rows);
  if (any) writer->Write("truth_associations.csv", "time_s,robot,landmark\n" + associations);
}

void WriteLog(const kinds::Log& log, FolderWriter* writer) {
  RobotTable odometry({"turn_rad", "forward_m"});
  const std::vector<std::string>& landmarks = log.landmarks.values();
  std::string rows;
  for (std::size_t n = 0; n < log.robot.size(); ++n) {
    const kinds::Log::Robot& robot = log.robot[n];
    odometry.Add(log.robots[n], robot.odometry.time_s, {robot.odometry.turn_rad, robot.odometry.forward_m});
    const kinds::Log::Observations& seen = robot.observations;
    for (std::size_t i = 0; i < seen.time_s.size(); ++i)
      rows += NumberText(seen.time_s[i]) + "," + Field(log.robots[n]) + "," +
              Name(landmarks, seen.landmark[i]) + "," + Number(seen.range_m[i]) + "," +
              Number(seen.bearing_rad[i]) + "\n";
  }
  odometry.Write("odometry.csv", writer);
  writer->Write("observations.csv", "time_s,robot,landmark,range_m,bearing_rad\n" + rows);
  WriteTruth(log, writer);
}

void WriteLandmarks(const kinds::LandmarkMap& of, const std::vector<MapLandmark>& landmarks,
                    FolderWriter* writer) {
  const std::span<const std::int32_t> identity = of.map.landmark_identity.OrNone();
  const std::span<const double> count = of.map.landmark_count.OrNone();
  const std::vector<std::string> labels = LandmarkLabels(of.map, of.landmarks.OrNone());
  std::string rows;
  for (std::size_t k = 0; k < landmarks.size(); ++k) {
    const MapLandmark& landmark = landmarks[k];
    rows += std::to_string(k);
    for (const double value :
         {landmark.at.x_m, landmark.at.y_m, landmark.var_xx_m2, landmark.var_xy_m2, landmark.var_yy_m2})
      rows += "," + Number(value);
    rows += "," + Name(of.landmarks.OrNone(), identity.empty() ? -1 : identity[k]) + "," +
            Number(count.empty() ? NAN : count[k]) + "," + Field(labels[k]) + "\n";
  }
  writer->Write("landmarks.csv",
                "map_landmark,x_m,y_m,var_xx_m2,var_xy_m2,var_yy_m2,landmark,observations,label\n" + rows);
}

void WriteResult(const kinds::LandmarkMap& map, const std::vector<MapLandmark>& landmarks,
                 FolderWriter* writer) {
  RobotTable table({"x_m", "y_m", "heading_rad", "mode_x_m", "mode_y_m", "mode_heading_rad"});
  std::string rows;
  for (std::size_t n = 0; n < map.robot.size(); ++n) {
    const kinds::LandmarkMap::Robot& robot = map.robot[n];
    const kinds::LandmarkMap::RobotPoses& p = robot.poses;
    table.Add(map.robots[n], p.time_s,
              {p.x_m, p.y_m, p.heading_rad, p.mode_x_m, p.mode_y_m, p.mode_heading_rad});
    const std::span<const std::int32_t> landmark = robot.map_landmark.OrNone();
    for (std::size_t i = 0; i < landmark.size(); ++i)
      rows += Field(map.robots[n]) + "," + std::to_string(i) + "," +
              (landmark[i] < 0 ? "" : std::to_string(landmark[i])) + "," + Number(robot.probability[i]) +
              "\n";
  }
  table.Write("poses.csv", writer);
  if (map.map.landmark_x_m) WriteLandmarks(map, landmarks, writer);
  if (!rows.empty()) writer->Write("associations.csv", "robot,observation,map_landmark,probability\n" + rows);
}

bool IsLog(const Blob& blob) { return blob.Has("robot/0/odometry/time_s"); }

// The group that a dataset of a log belongs to: `noise`, `truth/walls`, `robot/0/laser`.
std::string GroupOf(const std::string& name) {
  const bool of_robot = name.starts_with("robot/") || name.starts_with("truth/robot/");
  std::size_t parts = of_robot ? 3 : 1;
  if (name.starts_with("truth/")) ++parts;
  std::size_t end = 0;
  while (parts-- > 0 && end != std::string::npos) end = name.find('/', end + 1);
  return name.substr(0, end);
}

bool HasPlaceInCsv(const std::string& group) {
  const std::string part = group.substr(group.rfind('/') + 1);
  if (group.starts_with("robot/")) return part == "odometry" || part == "observations";
  if (group.starts_with("truth/robot/")) return part == "poses" || part == "observations";
  return group == "robots" || group == "landmarks" || group == "provenance" || group == "truth/landmarks";
}

}  // namespace

std::vector<std::string> NotInCsv(const Blob& blob) {
  std::set<std::string> groups;
  if (IsLog(blob))
    for (const auto& [name, array] : blob.fields())
      if (const std::string group = GroupOf(name); !HasPlaceInCsv(group)) groups.insert(group);
  return {groups.begin(), groups.end()};
}

Written ExportCsv(const Blob& blob, const std::string& folder, bool replace) {
  const bool is_log = IsLog(blob);
  if (!is_log && !blob.Has("robot/0/poses/time_s"))
    throw InputError("there are neither controls nor poses in it");
  FolderWriter writer(folder, replace);
  if (is_log)
    WriteLog(Read<kinds::Log>(blob), &writer);
  else
    WriteResult(Read<kinds::LandmarkMap>(blob), ReadMapLandmarks(blob), &writer);
  return writer.Finish();
}

}  // namespace cairn::datasets
