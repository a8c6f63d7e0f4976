#include <cmath>

#include "datasets/common/array_text.h"
#include "datasets/export/export.h"
#include "datasets/export/parts.h"

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

class CsvExport {
 public:
  CsvExport(const Blob& blob, const std::string& folder, bool replace)
      : blob_(blob), robots_(blob.Texts("robots")), writer_(folder, replace) {}

  void WriteLog() {
    const std::vector<std::string> landmarks = blob_.Texts("landmarks");
    Table("odometry.csv", {"turn_rad", "forward_m"}, "", "odometry/");
    std::string rows;
    for (std::size_t n = 0; n < robots_.size(); ++n) {
      const std::string prefix = Prefix("", n) + "observations/";
      const auto time = blob_.Get<double>(prefix + "time_s");
      const auto range = blob_.Get<double>(prefix + "range_m");
      const auto bearing = blob_.Get<double>(prefix + "bearing_rad");
      const auto landmark = blob_.Get<std::int32_t>(prefix + "landmark");
      for (std::size_t i = 0; i < time.size(); ++i) {
        rows += NumberText(time[i]) + "," + Field(robots_[n]) + "," + Name(landmarks, landmark[i]) + "," +
                Number(range[i]) + "," + Number(bearing[i]) + "\n";
      }
    }
    writer_.Write("observations.csv", "time_s,robot,landmark,range_m,bearing_rad\n" + rows);
    WriteTruth();
  }

  void WriteResult() {
    Table("poses.csv", {"x_m", "y_m", "heading_rad", "mode_x_m", "mode_y_m", "mode_heading_rad"}, "",
          "poses/");
    if (blob_.Has("map/landmark_x_m")) WriteLandmarks();
    WriteAssociations();
  }

  Written Finish() { return writer_.Finish(); }

 private:
  static std::string Prefix(const std::string& before, std::size_t robot) {
    return before + "robot/" + std::to_string(robot) + "/";
  }

  // time_s, robot and those `columns` that the robots have, of every robot that has any.
  void Table(const std::string& file, const std::vector<std::string>& columns, const std::string& before,
             const std::string& group) {
    std::string header = "time_s,robot", rows;
    std::vector<std::string> present;
    for (const std::string& column : columns) {
      for (std::size_t n = 0; n < robots_.size(); ++n) {
        if (!blob_.Has(Prefix(before, n) + group + column)) continue;
        present.push_back(column);
        header += "," + column;
        break;
      }
    }
    if (present.empty()) return;
    for (std::size_t n = 0; n < robots_.size(); ++n) {
      const std::string prefix = Prefix(before, n) + group;
      if (blob_.Has(prefix + "time_s")) rows += Rows(prefix, Field(robots_[n]), present);
    }
    writer_.Write(file, header + "\n" + rows);
  }

  std::string Rows(const std::string& prefix, const std::string& robot,
                   const std::vector<std::string>& names) const {
    const auto time = blob_.Get<double>(prefix + "time_s");
    std::vector<std::span<const double>> columns;
    columns.reserve(names.size());
    for (const std::string& name : names) {
      columns.push_back(blob_.Get<double>(prefix + name));
    }
    std::string rows;
    for (std::size_t i = 0; i < time.size(); ++i) {
      rows += NumberText(time[i]) + "," + robot;
      for (const auto& column : columns) rows += "," + Number(column[i]);
      rows += "\n";
    }
    return rows;
  }

  void WriteTruth() {
    Table("truth_poses.csv", {"x_m", "y_m", "heading_rad"}, "truth/", "poses/");
    if (!blob_.Has("truth/landmarks/name")) return;
    const std::vector<std::string> names = blob_.Texts("truth/landmarks/name");
    const auto x = blob_.Get<double>("truth/landmarks/x_m");
    const auto y = blob_.Get<double>("truth/landmarks/y_m");
    std::string rows;
    for (std::size_t k = 0; k < names.size(); ++k) {
      rows += Field(names[k]) + "," + NumberText(x[k]) + "," + NumberText(y[k]) + "\n";
    }
    writer_.Write("truth_landmarks.csv", "landmark,x_m,y_m\n" + rows);
    WriteTruthAssociations(names);
  }

  void WriteTruthAssociations(const std::vector<std::string>& names) {
    std::string rows;
    bool any = false;
    for (std::size_t n = 0; n < robots_.size(); ++n) {
      const std::string name = Prefix("truth/", n) + "observations/landmark";
      if (!blob_.Has(name)) continue;
      any = true;
      const auto time = blob_.Get<double>(Prefix("", n) + "observations/time_s");
      const auto landmark = blob_.Get<std::int32_t>(name);
      for (std::size_t i = 0; i < landmark.size(); ++i) {
        rows += NumberText(time[i]) + "," + Field(robots_[n]) + "," + Name(names, landmark[i]) + "\n";
      }
    }
    if (any) writer_.Write("truth_associations.csv", "time_s,robot,landmark\n" + rows);
  }

  void WriteLandmarks() {
    const std::vector<MapLandmark> landmarks = ReadMapLandmarks(blob_);
    const std::vector<std::string> names =
        blob_.Has("landmarks") ? blob_.Texts("landmarks") : std::vector<std::string>();
    std::vector<std::int32_t> identities(landmarks.size(), -1);
    std::vector<double> counts(landmarks.size(), NAN);
    if (blob_.Has("map/landmark_identity")) {
      const auto column = blob_.Get<std::int32_t>("map/landmark_identity");
      identities.assign(column.begin(), column.end());
    }
    if (blob_.Has("map/landmark_count")) {
      const auto column = blob_.Get<double>("map/landmark_count");
      counts.assign(column.begin(), column.end());
    }
    std::string rows;
    for (std::size_t k = 0; k < landmarks.size(); ++k) {
      const MapLandmark& landmark = landmarks[k];
      rows += std::to_string(k);
      for (const double value :
           {landmark.at.x_m, landmark.at.y_m, landmark.var_xx_m2, landmark.var_xy_m2, landmark.var_yy_m2}) {
        rows += "," + Number(value);
      }
      rows += "," + Name(names, identities[k]) + "," + Number(counts[k]) + "\n";
    }
    writer_.Write("landmarks.csv",
                  "map_landmark,x_m,y_m,var_xx_m2,var_xy_m2,var_yy_m2,landmark,observations\n" + rows);
  }

  void WriteAssociations() {
    std::string rows;
    for (std::size_t n = 0; n < robots_.size(); ++n) {
      const std::string prefix = Prefix("", n) + "observations/";
      if (!blob_.Has(prefix + "map_landmark")) continue;
      const auto landmark = blob_.Get<std::int32_t>(prefix + "map_landmark");
      const auto probability = blob_.Get<double>(prefix + "probability");
      for (std::size_t i = 0; i < landmark.size(); ++i) {
        rows += Field(robots_[n]) + "," + std::to_string(i) + "," +
                (landmark[i] < 0 ? "" : std::to_string(landmark[i])) + "," + Number(probability[i]) + "\n";
      }
    }
    if (!rows.empty())
      writer_.Write("associations.csv", "robot,observation,map_landmark,probability\n" + rows);
  }

  const Blob& blob_;
  const std::vector<std::string> robots_;
  FolderWriter writer_;
};

}  // namespace

Written ExportCsv(const Blob& blob, const std::string& folder, bool replace) {
  const bool is_log = blob.Has("robot/0/odometry/time_s");
  if (!is_log && !blob.Has("robot/0/poses/time_s"))
    throw InputError("there are neither controls nor poses in it");
  CsvExport csv(blob, folder, replace);
  if (is_log)
    csv.WriteLog();
  else
    csv.WriteResult();
  return csv.Finish();
}

}  // namespace cairn::datasets
