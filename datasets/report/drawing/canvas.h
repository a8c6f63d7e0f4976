// A picture to draw on, with smooth lines: twice as fine inside as the file that comes of it.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "schema/geometry.h"

namespace cairn::datasets::report {

using Rgb = std::array<int, 3>;

enum class Align { kLeft, kMiddle, kRight };

// All lengths are in pixels of the file; y points down.
class Canvas {
 public:
  Canvas(int width, int height, Rgb paper);

  void Line(Point from, Point to, Rgb colour, double width);
  void Polyline(const std::vector<Point>& points, Rgb colour, double width);
  void Fill(Point low, Point high, Rgb colour);  // the rectangle between two corners
  void Frame(Point low, Point high, Rgb colour, double width);
  void Dot(Point centre, double radius, Rgb colour);
  void Ring(Point centre, double radius, Rgb colour, double width);
  // Semi-axes and the angle of the major one, clockwise; filled at a sixth of its strength.
  void Ellipse(Point centre, double major, double minor, double degrees, Rgb colour, double width);
  // At the baseline; `halo` > 0 draws so many pixels of paper round the letters. ASCII only: others become
  // '?'.
  void Text(Point at, const std::string& text, Rgb colour, double height, Align align = Align::kLeft,
            double halo = 0);
  static double TextWidth(const std::string& text, double height);

  std::string Png() const;

 private:
  cv::Mat image_;  // RGB
  Rgb paper_;
};

}  // namespace cairn::datasets::report
