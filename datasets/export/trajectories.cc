// Trajectories as text, a file a robot: what differs between the formats is a line.
#include <cmath>

#include "datasets/common/array_text.h"
#include "datasets/export/export.h"
#include "datasets/export/parts.h"

namespace cairn::datasets {
namespace {

std::string Joined(std::initializer_list<double> values, char between) {
  std::string line;
  for (const double value : values) (line.empty() ? line : line += between) += NumberText(value);
  return line;
}

std::string TumLine(double time_s, const Pose& pose) {
  const double half = pose.heading_rad / 2;
  return Joined({time_s, pose.x_m, pose.y_m, 0, 0, 0, std::sin(half), std::cos(half)}, ' ');
}

// The upper three rows of the pose's matrix.
std::string KittiLine(double, const Pose& pose) {
  const double s = std::sin(pose.heading_rad), c = std::cos(pose.heading_rad);
  return Joined({c, -s, 0, pose.x_m, s, c, 0, pose.y_m, 0, 0, 1, 0}, ' ');
}

// Velocity and the biases of an IMU, which EuRoC's tables have as well, are nobody's here.
std::string EurocLine(double time_s, const Pose& pose) {
  const double half = pose.heading_rad / 2;
  return std::to_string(Nanoseconds(time_s)) + "," +
         Joined({pose.x_m, pose.y_m, 0, std::cos(half), 0, 0, std::sin(half)}, ',') +
         ",nan,nan,nan,nan,nan,nan,nan,nan,nan";
}

std::string TimeLine(double time_s, const Pose&) { return NumberText(time_s); }

using LineOf = std::string (*)(double time_s, const Pose& pose);

std::string Lines(const Path& path, std::string head, LineOf line) {
  for (std::size_t i = 0; i < path.poses.size(); ++i) head += line(path.time_s[i], path.poses[i]) + "\n";
  return head;
}

}  // namespace

Written ExportTum(const Blob& blob, const std::string& folder, bool replace) {
  FolderWriter writer(folder, replace);
  for (const Path& path : ReadPaths(blob))
    writer.Write(path.file + ".tum", Lines(path, "# time x y z qx qy qz qw\n", TumLine));
  return writer.Finish();
}

Written ExportKitti(const Blob& blob, const std::string& folder, bool replace) {
  FolderWriter writer(folder, replace);
  for (const Path& path : ReadPaths(blob)) {
    writer.Write(path.file + ".kitti", Lines(path, "", KittiLine));
    writer.Write(path.file + ".times", Lines(path, "", TimeLine));
  }
  return writer.Finish();
}

Written ExportEuroc(const Blob& blob, const std::string& folder, bool replace) {
  constexpr const char* kHead =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
      "v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad "
      "s^-1], "
      "b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n";
  FolderWriter writer(folder, replace);
  for (const Path& path : ReadPaths(blob)) writer.Write(path.file + ".csv", Lines(path, kHead, EurocLine));
  return writer.Finish();
}

}  // namespace cairn::datasets
