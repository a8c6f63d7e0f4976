// Building blocks of inline SVG. Colours come from the page's style, by class, so that a picture follows it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "schema/geometry.h"

namespace cairn::datasets::report {

class Svg {
 public:
  // `label` is what a screen reader says.
  Svg(double width, double height, std::string_view label);

  void Line(double x1, double y1, double x2, double y2, std::string_view style_class);
  // Points in pixels; those nearer than half a pixel to the one before are left out, but for the last.
  void Polyline(const std::vector<Point>& points, std::string_view style_class);
  // A filled area; nothing of fewer than three corners.
  void Polygon(const std::vector<Point>& corners, std::string_view style_class);
  // Points in pixels, as one element: the style's stroke is as wide as they are.
  void Dots(const std::vector<Point>& points, std::string_view style_class);
  // `tip`, where not empty, is shown when the pointer rests on it.
  void Circle(double x, double y, double radius, std::string_view style_class, std::string_view tip = "");
  void Ellipse(double x, double y, double major, double minor, double degrees, std::string_view style_class);
  void Rect(double x, double y, double width, double height, std::string_view style_class,
            std::string_view tip = "");
  void Text(double x, double y, std::string_view text, std::string_view style_class);
  void VerticalText(double x, double y, std::string_view text, std::string_view style_class);
  // A picture as a data URI, its pixels kept sharp.
  void Image(double x, double y, double width, double height, std::string_view png);
  // Everything until the matching EndClip is cut at this rectangle.
  void BeginClip(double x, double y, double width, double height);
  void EndClip();

  std::string Finish() const { return out_ + "</svg>\n"; }

 private:
  std::string out_;
  std::string id_;  // of this picture's clip paths
};

}  // namespace cairn::datasets::report
