// PLY (G. Turk, The PLY Polygon File Format, 1994), as text: points with numbers, and lines between them.
#include "datasets/common/array_text.h"
#include "datasets/common/trace_edges.h"
#include "datasets/export/export.h"
#include "datasets/export/parts.h"

namespace cairn::datasets {
namespace {

class PlyFile {
 public:
  // Of each point, x, y and z first.
  explicit PlyFile(std::vector<const char*> properties) : properties_(std::move(properties)) {}
  void Add(const std::vector<double>& values) {
    ++points_;
    for (std::size_t i = 0; i < values.size(); ++i) rows_ += (i == 0 ? "" : " ") + NumberText(values[i]);
    rows_ += "\n";
  }
  // From each point to the next one.
  std::string Text(bool with_lines) const {
    std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(points_) + "\n", lines;
    for (const char* property : properties_) text += std::string("property double ") + property + "\n";
    if (with_lines) {
      text += "element edge " + std::to_string(points_ == 0 ? 0 : points_ - 1) +
              "\nproperty int vertex1\nproperty int vertex2\n";
      for (std::size_t i = 1; i < points_; ++i)
        lines += std::to_string(i - 1) + " " + std::to_string(i) + "\n";
    }
    return text + "end_header\n" + rows_ + lines;
  }

 private:
  std::vector<const char*> properties_;
  std::size_t points_ = 0;
  std::string rows_;
};

std::string CellsPly(const Occupancy& cells) {
  PlyFile file({"x", "y", "z", "probability"});
  for (std::int64_t row = 0; row < cells.box.rows; ++row) {
    for (std::int64_t column = 0; column < cells.box.columns; ++column) {
      if (!cells.IsOccupied(column, row)) continue;
      file.Add({cells.box.CentreX(column), cells.box.CentreY(row), 0,
                cells.probability[cells.box.Index(column, row)]});
    }
  }
  return file.Text(false);
}

std::string LandmarksPly(const std::vector<MapLandmark>& landmarks) {
  PlyFile file({"x", "y", "z", "var_xx_m2", "var_xy_m2", "var_yy_m2"});
  for (const MapLandmark& l : landmarks)
    file.Add({l.at.x_m, l.at.y_m, 0, l.var_xx_m2, l.var_xy_m2, l.var_yy_m2});
  return file.Text(false);
}

std::string EdgesPly(const std::vector<Point>& edges) {
  PlyFile file({"x", "y", "z"});
  for (const Point& edge : edges) file.Add({edge.x_m, edge.y_m, 0});
  return file.Text(false);
}

std::string PathPly(const Path& path) {
  PlyFile file({"x", "y", "z", "time_s", "heading_rad"});
  for (std::size_t i = 0; i < path.poses.size(); ++i)
    file.Add({path.poses[i].x_m, path.poses[i].y_m, 0, path.time_s[i], path.poses[i].heading_rad});
  return file.Text(true);
}

}  // namespace

Written ExportPly(const Blob& blob, const std::string& folder, bool replace) {
  FolderWriter writer(folder, replace);
  const std::vector<MapLandmark> landmarks = ReadMapLandmarks(blob);
  if (!landmarks.empty())
    writer.Write("landmarks.ply", LandmarksPly(landmarks));
  else if (blob.Has("map/grid/probability"))
    writer.Write("map.ply", CellsPly(ReadCells(blob)));
  const std::vector<std::vector<Point>> edges = TraceEdges(blob);
  for (const Path& path : PathsOf(blob)) {
    writer.Write("path_" + path.file + ".ply", PathPly(path));
    if (path.index < edges.size() && !edges[path.index].empty())
      writer.Write("edges_" + path.file + ".ply", EdgesPly(edges[path.index]));
  }
  return writer.Finish();
}

}  // namespace cairn::datasets
