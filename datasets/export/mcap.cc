// What Foxglove and Rerun show of a file of Cairn's, as messages of Foxglove's schemas.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "datasets/common/array_text.h"
#include "datasets/common/landmark_labels.h"
#include "datasets/common/trace_edges.h"
#include "datasets/export/export.h"
#include "datasets/export/foxglove.pb.h"
#include "datasets/export/mcap_file.h"
#include "datasets/export/parts.h"
#include "datasets/report/scene.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {
namespace {

using Rgba = std::array<std::uint8_t, 4>;
constexpr Rgba kOrange{217, 120, 61, 255};  // seen on a light and on a dark ground
constexpr Rgba kGrey{120, 130, 140, 255};   // as well
constexpr double kThickness_m = 0.01;       // of regions, which are flat
constexpr double kRegionAlpha = 0.35;       // one sees what lies under them
constexpr double kLabelHeight_m = 0.5;
constexpr double kBetweenMaps_m = 5;
constexpr std::array kCovarianceNames{"variance_x_m2", "covariance_xy_m2", "variance_y_m2"};
constexpr double kLeastBelief = 1e-4;  // of the likeliest cell's: less likely ones are not drawn

// A value of type T at the end of packed elements.
template <class T>
void Pack(std::string* data, T value) {
  data->append(reinterpret_cast<const char*>(&value), sizeof value);
}

// Fields of packed elements, one after the other; returns their length.
template <class Message>
std::uint32_t SetFields(Message* message, std::initializer_list<const char*> floats, bool colour) {
  std::uint32_t offset = 0;
  const auto add = [&](const char* name, auto type, std::uint32_t bytes) {
    auto* field = message->add_fields();
    field->set_name(name);
    field->set_offset(offset);
    field->set_type(type);
    offset += bytes;
  };
  for (const char* name : floats) add(name, foxglove::PackedElementField::FLOAT32, 4);
  for (const char* name : {"red", "green", "blue", "alpha"})
    if (colour) add(name, foxglove::PackedElementField::UINT8, 1);
  return offset;
}

void Set(foxglove::Pose* to, double x_m, double y_m, double heading_rad) {
  to->mutable_position()->set_x(x_m);
  to->mutable_position()->set_y(y_m);
  to->mutable_orientation()->set_z(std::sin(heading_rad / 2));
  to->mutable_orientation()->set_w(std::cos(heading_rad / 2));
}

// MCAP counts nanoseconds from 0 on. A log's clock that begins before is put forward by whole seconds.
class Clock {
 public:
  explicit Clock(double first_s) : forward_s_(std::max(0.0, std::ceil(-first_s))) {}
  double forward_s() const { return forward_s_; }
  std::uint64_t Ns(double time_s) const {
    return static_cast<std::uint64_t>(Nanoseconds(time_s)) +
           static_cast<std::uint64_t>(forward_s_) * 1'000'000'000;
  }

 private:
  double forward_s_;
};

// Messages that are stamped with the time at which they are there.
class Stage {
 public:
  Stage(const Blob& blob, double first_s) : clock_(first_s), first_s_(first_s) {
    file_.AddMetadata("cairn", {{"version", CAIRN_VERSION},
                                {"content_hash", blob.Without("provenance/").ContentHash().Hex()},
                                {"clock_put_forward_s", NumberText(clock_.forward_s())}});
  }
  double first_s() const { return first_s_; }
  template <class Message>
  Message New(double time_s, const std::string& frame) const {
    Message message;
    Stamp(time_s, &message);
    message.set_frame_id(frame);
    return message;
  }
  template <class Message>
  void Stamp(double time_s, Message* message) const {
    const std::uint64_t ns = clock_.Ns(time_s);
    message->mutable_timestamp()->set_seconds(static_cast<std::int64_t>(ns / 1'000'000'000));
    message->mutable_timestamp()->set_nanos(static_cast<std::int32_t>(ns % 1'000'000'000));
  }
  void Add(const std::string& topic, double time_s, const google::protobuf::Message& message) {
    file_.Add(topic, clock_.Ns(time_s), message);
  }
  std::string Bytes() const { return file_.Bytes(); }

 private:
  Clock clock_;
  double first_s_;
  McapFile file_;
};

// `colour_of` says of each value how it is drawn.
template <class ColourOf>
foxglove::Grid FilledGrid(foxglove::Grid grid, const GridBox& box, std::span<const double> values,
                          const ColourOf& colour_of) {
  const std::uint32_t cell_bytes = SetFields(&grid, {"probability"}, true);
  Set(grid.mutable_pose(), box.origin_x_m, box.origin_y_m, 0);
  grid.mutable_cell_size()->set_x(box.cell_m);
  grid.mutable_cell_size()->set_y(box.cell_m);
  grid.set_column_count(static_cast<std::uint32_t>(box.columns));
  grid.set_cell_stride(cell_bytes);
  grid.set_row_stride(cell_bytes * grid.column_count());
  for (const double p : values) {
    Pack(grid.mutable_data(), static_cast<float>(p));
    Pack(grid.mutable_data(), colour_of(p));
  }
  return grid;
}

// White is free, black occupied; what nothing is known of is not there.
Rgba MapColour(double p) {
  if (std::isnan(p)) return {0, 0, 0, 0};
  const auto grey = static_cast<std::uint8_t>(std::lround(255 * (1 - p)));
  return {grey, grey, grey, 255};
}

// From the first time on, in `frame`: points with these fields, x, y and z among them, in one colour, if any.
class Points {
 public:
  Points(const Stage& stage, const std::string& frame, std::initializer_list<const char*> fields,
         std::optional<Rgba> colour = std::nullopt)
      : cloud_(stage.New<foxglove::PointCloud>(stage.first_s(), frame)), colour_(colour) {
    cloud_.set_point_stride(SetFields(&cloud_, fields, colour.has_value()));
    Set(cloud_.mutable_pose(), 0, 0, 0);
  }
  void Add(std::initializer_list<double> values) {
    for (const double value : values) Pack(cloud_.mutable_data(), static_cast<float>(value));
    if (colour_) Pack(cloud_.mutable_data(), *colour_);
  }
  const foxglove::PointCloud& cloud() const { return cloud_; }

 private:
  foxglove::PointCloud cloud_;
  std::optional<Rgba> colour_;
};

// The middles of cells that are rather occupied, for viewers that know no grids.
Points OccupiedPoints(const Occupancy& cells, const Stage& stage) {
  Points points(stage, "map", {"x", "y", "z", "probability"});
  for (std::int64_t row = 0; row < cells.box.rows; ++row) {
    for (std::int64_t column = 0; column < cells.box.columns; ++column) {
      const double p = cells.probability[cells.box.Index(column, row)];
      if (!(p > 0.5)) continue;
      points.Add({cells.box.CentreX(column), cells.box.CentreY(row), 0, p});
    }
  }
  return points;
}

void SetColour(double alpha, foxglove::Color* colour) {
  colour->set_r(kOrange[0] / 255.0);
  colour->set_g(kOrange[1] / 255.0);
  colour->set_b(kOrange[2] / 255.0);
  colour->set_a(alpha);
}

// Where something is with 95%: an ellipse.
void AddRegion(Point at, const std::array<double, 4>& covariance_m2, foxglove::SceneEntity* entity) {
  const report::EllipseM ellipse = report::EllipseOf(at, covariance_m2);
  foxglove::CylinderPrimitive& region = *entity->add_cylinders();
  Set(region.mutable_pose(), at.x_m, at.y_m, ellipse.angle_rad);
  region.mutable_size()->set_x(2 * ellipse.major_m);
  region.mutable_size()->set_y(2 * ellipse.minor_m);
  region.mutable_size()->set_z(kThickness_m);
  region.set_bottom_scale(1);
  region.set_top_scale(1);
  SetColour(kRegionAlpha, region.mutable_color());
}

void AddLandmarks(const Blob& blob, Stage* stage) {
  const std::vector<MapLandmark> landmarks = ReadMapLandmarks(blob);
  if (landmarks.empty()) return;
  const auto map = Read<kinds::LandmarkMap>(blob);
  const std::vector<std::string> labels = LandmarkLabels(map.map, map.landmarks.OrNone());
  const double first_s = stage->first_s();
  foxglove::SceneUpdate scene;
  Points points(*stage, "map", {"x", "y", "z", kCovarianceNames[0], kCovarianceNames[1], kCovarianceNames[2]},
                kOrange);
  for (std::size_t k = 0; k < landmarks.size(); ++k) {
    const MapLandmark& landmark = landmarks[k];
    foxglove::SceneEntity& entity = *scene.add_entities();
    entity = stage->New<foxglove::SceneEntity>(first_s, "map");
    entity.set_id(labels[k]);
    AddRegion(landmark.at, {landmark.var_xx_m2, landmark.var_xy_m2, landmark.var_xy_m2, landmark.var_yy_m2},
              &entity);
    foxglove::TextPrimitive& text = *entity.add_texts();
    Set(text.mutable_pose(), landmark.at.x_m, landmark.at.y_m, 0);
    text.mutable_pose()->mutable_position()->set_z(kLabelHeight_m);
    text.set_text(labels[k]);
    text.set_billboard(true);
    text.set_font_size(kLabelHeight_m);
    SetColour(1, text.mutable_color());
    const std::array covariance{landmark.var_xx_m2, landmark.var_xy_m2, landmark.var_yy_m2};
    for (std::size_t i = 0; i < covariance.size(); ++i) {
      foxglove::KeyValuePair& fact = *entity.add_metadata();
      fact.set_key(kCovarianceNames[i]);
      fact.set_value(NumberText(covariance[i]));
    }
    points.Add({landmark.at.x_m, landmark.at.y_m, 0, covariance[0], covariance[1], covariance[2]});
  }
  stage->Add("/landmarks", first_s, scene);
  stage->Add("/landmarks/points", first_s, points.cloud());
}

void AddPath(const Path& path, const std::string& frame, Stage* stage) {
  auto whole = stage->New<foxglove::PosesInFrame>(stage->first_s(), frame);
  Points points(*stage, frame, {"x", "y", "z"});
  for (std::size_t i = 0; i < path.poses.size(); ++i) {
    const Pose& pose = path.poses[i];
    const double time_s = path.time_s[i];
    Set(whole.add_poses(), pose.x_m, pose.y_m, pose.heading_rad);
    points.Add({pose.x_m, pose.y_m, 0});
    foxglove::FrameTransform transform;
    stage->Stamp(time_s, &transform);
    transform.set_parent_frame_id(frame);
    transform.set_child_frame_id(path.robot);
    *transform.mutable_translation() = whole.poses().rbegin()->position();
    *transform.mutable_rotation() = whole.poses().rbegin()->orientation();
    stage->Add("/tf", time_s, transform);
    if (path.covariances.empty()) continue;
    foxglove::SceneUpdate scene;
    foxglove::SceneEntity& entity = *scene.add_entities();
    entity = stage->New<foxglove::SceneEntity>(time_s, frame);
    entity.set_id("region");  // it takes the place of the one before
    const double* covariance = &path.covariances[9 * i];
    AddRegion({pose.x_m, pose.y_m}, {covariance[0], covariance[1], covariance[3], covariance[4]}, &entity);
    stage->Add("/" + path.file + "/region", time_s, scene);
  }
  stage->Add("/" + path.file + "/path", stage->first_s(), whole);
  stage->Add("/" + path.file + "/path/points", stage->first_s(), points.cloud());
  Points place(*stage, path.robot, {"x", "y", "z"}, kOrange);
  place.Add({0, 0, 0});
  stage->Add("/" + path.file + "/place", stage->first_s(), place.cloud());
}

// What of a local map stands about a path: walls.
void AddEdges(const std::vector<Point>& edges, const Path& path, const std::string& frame, Stage* stage) {
  if (edges.empty()) return;
  Points points(*stage, frame, {"x", "y", "z"}, kGrey);
  for (const Point& edge : edges) points.Add({edge.x_m, edge.y_m, 0});
  stage->Add("/" + path.file + "/edges", stage->first_s(), points.cloud());
}

// A viewer shows a frame and what hangs on it, so maps that nothing ties are laid beside each other in `map`:
// this one from `left_m` on, the first where it is. Returns where the next may begin.
double LayBeside(const Path& path, const std::vector<Point>& edges, const std::string& frame,
                 std::optional<double> left_m, Stage* stage) {
  std::vector<double> x_m;
  for (const Pose& pose : path.poses) x_m.push_back(pose.x_m);
  for (const Point& edge : edges) x_m.push_back(edge.x_m);
  const auto [least_m, most_m] =
      x_m.empty() ? std::ranges::min_max_result<double>{} : std::ranges::minmax(x_m);
  const double right_m = left_m.value_or(least_m) - least_m;
  foxglove::FrameTransform transform;
  stage->Stamp(stage->first_s(), &transform);
  transform.set_parent_frame_id("map");
  transform.set_child_frame_id(frame);
  transform.mutable_translation()->set_x(right_m);
  transform.mutable_rotation()->set_w(1);
  stage->Add("/tf", stage->first_s(), transform);
  return right_m + most_m + kBetweenMaps_m;
}

// What the robot may believe of its place, step by step: the likelier the more opaque.
void AddBeliefs(const kinds::LandmarkMap::Beliefs& beliefs, double cell_m, const std::string& topic,
                Stage* stage) {
  std::span<const double> left = beliefs.value.OrNone();
  for (std::size_t step = 0; step < beliefs.time_s.OrNone().size(); ++step) {
    const std::int32_t* at = &beliefs.box[4 * step];
    const GridBox box{(at[0] - 0.5) * cell_m, (at[1] - 0.5) * cell_m, cell_m, at[2], at[3]};
    const auto cells = static_cast<std::size_t>(std::max<std::int64_t>(0, box.cells()));
    if (cells > left.size() || box.columns < 0)
      throw InputError("'" + beliefs.value.name() + "' has not as many numbers as 'box' says");
    if (cells == 0) continue;
    const double most = std::ranges::max(left.first(cells));
    const auto colour = [most](double p) {
      const double share = most > 0 ? p / most : 0;
      return Rgba{25, 120, 217,
                  static_cast<std::uint8_t>(share < kLeastBelief ? 0 : std::lround(64 + 191 * share))};
    };
    const double time_s = beliefs.time_s[step];
    stage->Add(topic, time_s,
               FilledGrid(stage->New<foxglove::Grid>(time_s, "map"), box, left.first(cells), colour));
    left = left.subspan(cells);
  }
}

double FirstTime(const std::vector<Path>& paths) {
  std::optional<double> first_s;
  for (const Path& path : paths)
    if (!path.time_s.empty()) first_s = std::min(first_s.value_or(path.time_s.front()), path.time_s.front());
  return first_s.value_or(0);
}

}  // namespace

Written ExportMcap(const Blob& blob, const std::string& folder, bool replace) {
  const std::vector<Path> paths = PathsOf(blob);
  Stage stage(blob, FirstTime(paths));
  if (blob.Has("map/grid/probability")) {
    const Occupancy cells = ReadCells(blob);
    stage.Add("/map", stage.first_s(),
              FilledGrid(stage.New<foxglove::Grid>(stage.first_s(), "map"), cells.box, cells.probability,
                         MapColour));
    stage.Add("/map/points", stage.first_s(), OccupiedPoints(cells, stage).cloud());
  }
  AddLandmarks(blob, &stage);
  // Paths of a local map have frames of their own: nothing ties them.
  const bool apart = paths.size() > 1 && blob.Has("connections/kind");
  std::optional<double> next_m;
  std::vector<std::vector<Point>> edges = TraceEdges(blob);
  edges.resize(std::max(edges.size(), blob.Texts("robots").size()));
  for (const Path& path : paths) {
    const std::string frame = apart ? "map of " + path.robot : "map";
    if (apart) next_m = LayBeside(path, edges[path.index], frame, next_m, &stage);
    AddPath(path, frame, &stage);
    AddEdges(edges[path.index], path, frame, &stage);
  }
  if (blob.Has("map/landmark_x_m")) {
    const auto map = Read<kinds::LandmarkMap>(blob);
    for (const Path& path : paths)
      AddBeliefs(map.robot[path.index].beliefs, map.map.grid.cell_m.Scalar(), "/" + path.file + "/belief",
                 &stage);
  }
  FolderWriter writer(folder, replace);
  writer.Write("map.mcap", stage.Bytes());
  return writer.Finish();
}

}  // namespace cairn::datasets
