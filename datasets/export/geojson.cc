// GeoJSON (RFC 7946): positions on the earth, of a map whose place there somebody names.
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "datasets/common/landmark_labels.h"
#include "datasets/export/export.h"
#include "datasets/export/parts.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {
namespace {

constexpr double kRadius_m = 6378137, kEccentricity2 = 6.69437999014e-3;  // WGS 84
constexpr double kRad = std::numbers::pi / 180;

// From the plane that touches the ellipsoid at a place to longitude and latitude.
class OnEarth {
 public:
  explicit OnEarth(const GeoOrigin& origin)
      : latitude_(origin.latitude_deg * kRad),
        longitude_(origin.longitude_deg * kRad),
        turn_(origin.x_axis_deg * kRad) {}

  // Degrees.
  nlohmann::ordered_json At(Point point) const {
    const double east = point.x_m * std::cos(turn_) - point.y_m * std::sin(turn_);
    const double north = point.x_m * std::sin(turn_) + point.y_m * std::cos(turn_);
    const double s = std::sin(latitude_), c = std::cos(latitude_);
    // Turned so that the origin's meridian is the first: along it to the axis, east, and to the north.
    const double outward = RadiusAt(latitude_) * c - north * s;
    const double upward = RadiusAt(latitude_) * (1 - kEccentricity2) * s + north * c;
    const double from_axis = std::hypot(outward, east);
    double latitude = std::atan2(upward, from_axis * (1 - kEccentricity2));
    for (int i = 0; i < 5; ++i)  // each gains two digits and more
      latitude = std::atan2(upward + kEccentricity2 * RadiusAt(latitude) * std::sin(latitude), from_axis);
    const double longitude = std::remainder(longitude_ + std::atan2(east, outward), 2 * std::numbers::pi);
    return {longitude / kRad, latitude / kRad};
  }

 private:
  // From the axis to the ellipsoid, along its normal.
  static double RadiusAt(double latitude) {
    const double s = std::sin(latitude);
    return kRadius_m / std::sqrt(1 - kEccentricity2 * s * s);
  }
  double latitude_, longitude_, turn_;
};

nlohmann::ordered_json Feature(const char* type, nlohmann::ordered_json coordinates,
                               nlohmann::ordered_json properties) {
  return {{"type", "Feature"},
          {"geometry", {{"type", type}, {"coordinates", std::move(coordinates)}}},
          {"properties", std::move(properties)}};
}

}  // namespace

Written ExportGeojson(const Blob& blob, const GeoOrigin& origin, const std::string& folder, bool replace) {
  const OnEarth earth(origin);
  auto features = nlohmann::ordered_json::array();
  const std::vector<MapLandmark> landmarks = ReadMapLandmarks(blob);
  const std::vector<std::string> labels =
      landmarks.empty()
          ? std::vector<std::string>()
          : LandmarkLabels(FieldsIn<kinds::LandmarkMap::Map>("map/", blob), blob.Texts("landmarks"));
  for (std::size_t k = 0; k < landmarks.size(); ++k) {
    const MapLandmark& l = landmarks[k];
    features.push_back(Feature("Point", earth.At(l.at),
                               {{"landmark", labels[k]},
                                {"x_m", l.at.x_m},
                                {"y_m", l.at.y_m},
                                {"covariance_m2", {l.var_xx_m2, l.var_xy_m2, l.var_yy_m2}}}));
  }
  for (const Path& path : ReadPaths(blob)) {
    auto line = nlohmann::ordered_json::array();
    for (const Pose& pose : path.poses) line.push_back(earth.At({pose.x_m, pose.y_m}));
    const char* type = line.size() > 1 ? "LineString" : "MultiPoint";  // a line has two positions at least
    features.push_back(Feature(type, std::move(line), {{"robot", path.robot}, {"time_s", path.time_s}}));
  }
  const nlohmann::ordered_json all = {{"type", "FeatureCollection"}, {"features", std::move(features)}};
  FolderWriter writer(folder, replace);
  writer.Write("map.geojson", all.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  return writer.Finish();
}

}  // namespace cairn::datasets
