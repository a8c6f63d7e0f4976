#include "datasets/report/drawing/svg.h"

#include <cmath>

#include "datasets/report/drawing/base64.h"
#include "datasets/report/drawing/format.h"
#include "schema/hash.h"

namespace cairn::datasets::report {
namespace {

constexpr double kMergedPixels = 0.5;

std::string Attribute(const char* name, double value) {
  return std::string(" ") + name + "=\"" + Short(value) + "\"";
}

std::string Class(std::string_view style_class) { return " class=\"" + std::string(style_class) + "\""; }

std::string Close(const char* tag, std::string_view tip) {
  if (tip.empty()) return "/>\n";
  return "><title>" + Escape(tip) + "</title></" + tag + ">\n";
}

}  // namespace

Svg::Svg(double width, double height, std::string_view label) {
  Hasher hasher;
  hasher.Add(label);
  id_ = "c" + hasher.Finish().Hex().substr(0, 10);
  out_ = "<svg viewBox=\"0 0 " + Short(width) + " " + Short(height) + "\" role=\"img\" aria-label=\"" +
         Escape(label) + "\">\n";
}

void Svg::Line(double x1, double y1, double x2, double y2, std::string_view style_class) {
  out_ += "<line" + Class(style_class) + Attribute("x1", x1) + Attribute("y1", y1) + Attribute("x2", x2) +
          Attribute("y2", y2) + "/>\n";
}

void Svg::Polyline(const std::vector<Point>& points, std::string_view style_class) {
  if (points.size() < 2) return;
  out_ += "<polyline" + Class(style_class) + " points=\"";
  const Point* drawn = nullptr;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (drawn != nullptr && i + 1 < points.size() && DistanceM(*drawn, points[i]) < kMergedPixels) continue;
    drawn = &points[i];
    out_ += Short(drawn->x_m, 1) + "," + Short(drawn->y_m, 1) + " ";
  }
  out_.back() = '"';
  out_ += "/>\n";
}

void Svg::Polygon(const std::vector<Point>& corners, std::string_view style_class) {
  if (corners.size() < 3) return;
  out_ += "<polygon" + Class(style_class) + " points=\"";
  for (const Point& corner : corners) out_ += Short(corner.x_m, 1) + "," + Short(corner.y_m, 1) + " ";
  out_.back() = '"';
  out_ += "/>\n";
}

void Svg::Dots(const std::vector<Point>& points, std::string_view style_class) {
  if (points.empty()) return;
  out_ += "<path" + Class(style_class) + " d=\"";
  for (const Point& at : points) out_ += "M" + Short(at.x_m, 1) + " " + Short(at.y_m, 1) + "h0";
  out_ += "\"/>\n";
}

void Svg::Circle(double x, double y, double radius, std::string_view style_class, std::string_view tip) {
  out_ += "<circle" + Class(style_class) + Attribute("cx", x) + Attribute("cy", y) + Attribute("r", radius) +
          Close("circle", tip);
}

void Svg::Ellipse(double x, double y, double major, double minor, double degrees,
                  std::string_view style_class) {
  out_ += "<ellipse" + Class(style_class) + Attribute("rx", major) + Attribute("ry", minor) +
          " transform=\"translate(" + Short(x) + " " + Short(y) + ") rotate(" + Short(degrees) + ")\"/>\n";
}

void Svg::Rect(double x, double y, double width, double height, std::string_view style_class,
               std::string_view tip) {
  out_ += "<rect" + Class(style_class) + Attribute("x", x) + Attribute("y", y) + Attribute("width", width) +
          Attribute("height", height) + Close("rect", tip);
}

void Svg::Text(double x, double y, std::string_view text, std::string_view style_class) {
  out_ +=
      "<text" + Class(style_class) + Attribute("x", x) + Attribute("y", y) + ">" + Escape(text) + "</text>\n";
}

void Svg::VerticalText(double x, double y, std::string_view text, std::string_view style_class) {
  out_ += "<text" + Class(style_class) + " transform=\"translate(" + Short(x) + " " + Short(y) +
          ") rotate(-90)\">" + Escape(text) + "</text>\n";
}

void Svg::Image(double x, double y, double width, double height, std::string_view png) {
  out_ += "<image" + Attribute("x", x) + Attribute("y", y) + Attribute("width", width) +
          Attribute("height", height) +
          " preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" href=\"data:image/png;base64," +
          Base64(png) + "\"/>\n";
}

void Svg::BeginClip(double x, double y, double width, double height) {
  // By what it is: the same drawing of another stage on the page has the same rectangle.
  Hasher hasher;
  for (const double value : {x, y, width, height}) hasher.Add(Short(value) + " ");
  const std::string id = id_ + "-" + hasher.Finish().Hex().substr(0, 8);
  out_ += "<clipPath id=\"" + id + "\"><rect" + Attribute("x", x) + Attribute("y", y) +
          Attribute("width", width) + Attribute("height", height) + "/></clipPath>\n<g clip-path=\"url(#" +
          id + ")\">\n";
}

void Svg::EndClip() { out_ += "</g>\n"; }

}  // namespace cairn::datasets::report
