#include <cmath>

#include "datasets/common/array_text.h"
#include "datasets/export/export.h"
#include "datasets/export/parts.h"

namespace cairn::datasets {

Written ExportTum(const Blob& blob, const std::string& folder, bool replace) {
  const std::vector<Path> paths = ReadPaths(blob);
  FolderWriter writer(folder, replace);
  for (const Path& path : paths) {
    std::string text = "# time x y z qx qy qz qw\n";
    for (std::size_t i = 0; i < path.poses.size(); ++i) {
      const Pose& pose = path.poses[i];
      text += NumberText(path.time_s[i]) + " " + NumberText(pose.x_m) + " " + NumberText(pose.y_m) +
              " 0 0 0 " + NumberText(std::sin(pose.heading_rad / 2)) + " " +
              NumberText(std::cos(pose.heading_rad / 2)) + "\n";
    }
    writer.Write(path.file + ".tum", text);
  }
  return writer.Finish();
}

}  // namespace cairn::datasets
