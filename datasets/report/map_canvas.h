// A map as SVG: axes in metres, a scale bar, and what lies on it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "datasets/report/drawing/axes.h"
#include "datasets/report/drawing/svg.h"
#include "datasets/report/scene.h"

namespace cairn::datasets::report {

// What a map's panel needs about it, in pixels: ticks and the axes' names.
struct MapMargins {
  static constexpr double kLeft = 46, kRight = 10, kTop = 10, kBottom = 40;
};

class MapCanvas {
 public:
  MapCanvas(Svg& svg, const MapFrame& frame) : svg_(svg), frame_(frame) {}

  // The axes; all that is drawn until Finish is cut at the panel's edge.
  void Axes(bool with_y_title);
  // The panel's edge and the scale bar, on top.
  void Finish();

  void Image(const Box& box, std::string_view png);
  void Paths(const std::vector<Path>& paths, const char* kind);
  void Starts(const std::vector<Path>& paths);
  void Marks(const std::vector<Path>& marks);
  void Truth(const Scene& scene);
  void Walls(const Scene& scene);
  void Loops(const Scene& scene);
  void Landmarks(const Scene& scene, bool with_names);

 private:
  Point At(Point point) const { return {frame_.X(point.x_m), frame_.Y(point.y_m)}; }
  void Line(Point from, Point to, const char* style_class);
  void Names(const Scene& scene);

  Svg& svg_;
  const MapFrame& frame_;
};

}  // namespace cairn::datasets::report
