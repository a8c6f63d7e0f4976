#include "datasets/report/drawing/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "datasets/report/drawing/format.h"
#include "schema/hash.h"
#include "schema/text.h"

namespace cairn::datasets::report {
namespace {

constexpr double kMergedPixels = 0.5;

// "x="3.5" y="7"" of a list of names and numbers.
std::string Attributes(std::initializer_list<std::pair<const char*, double>> attributes) {
  std::string text;
  for (const auto& [name, value] : attributes) text += fmt::format(" {}=\"{}\"", name, Short(value));
  return text;
}

std::string PointsAttribute(const std::vector<Point>& points, bool merged) {
  std::string text = " points=\"";
  const Point* drawn = nullptr;
  for (const Point& point : points) {
    const bool near = drawn != nullptr && DistanceM(*drawn, point) < kMergedPixels;
    if (merged && near && &point != &points.back()) continue;
    drawn = &point;
    text += fmt::format("{},{} ", Short(point.x_m, 1), Short(point.y_m, 1));
  }
  text.back() = '"';
  return text;
}

std::string Turned(Point at, double degrees) {
  return fmt::format(" transform=\"translate({} {}) rotate({})\"", Short(at.x_m), Short(at.y_m),
                     Short(degrees));
}

std::string SvgOf(const Element& s, const std::string& id) {
  using enum Element::Kind;
  const Point at = s.points.empty() ? Point{} : s.points.front();
  const std::string of = s.classes.empty() ? "" : fmt::format(" class=\"{}\"", s.classes);
  const auto box = [&] {
    return Attributes({{"x", at.x_m}, {"y", at.y_m}, {"width", s.width}, {"height", s.height}});
  };
  const auto closed = [&](const char* tag) {
    return s.text.empty() ? "/>" : fmt::format("><title>{}</title></{}>", Escape(s.text), tag);
  };
  switch (s.kind) {
    case kLine:
      return fmt::format(
          "<line{}{}/>\n", of,
          Attributes({{"x1", at.x_m}, {"y1", at.y_m}, {"x2", s.points[1].x_m}, {"y2", s.points[1].y_m}}));
    case kPolyline:
      return fmt::format("<polyline{}{}/>\n", of, PointsAttribute(s.points, true));
    case kPolygon:
      return fmt::format("<polygon{}{}/>\n", of, PointsAttribute(s.points, false));
    case kDots: {
      std::string path;
      for (const Point& dot : s.points) path += fmt::format("M{} {}h0", Short(dot.x_m, 1), Short(dot.y_m, 1));
      return fmt::format("<path{} d=\"{}\"/>\n", of, path);
    }
    case kEllipse:
      if (s.width == s.height)
        return fmt::format("<circle{}{}{}\n", of,
                           Attributes({{"cx", at.x_m}, {"cy", at.y_m}, {"r", s.width}}), closed("circle"));
      return fmt::format("<ellipse{}{}{}/>\n", of, Attributes({{"rx", s.width}, {"ry", s.height}}),
                         Turned(at, s.degrees));
    case kRect: {
      const Rgb c = s.fill.value_or(kPaper);
      const std::string fill = s.fill ? fmt::format(" fill=\"#{:02x}{:02x}{:02x}\"", c[0], c[1], c[2]) : "";
      return fmt::format("<rect{}{}{}{}\n", of, box(), fill, closed("rect"));
    }
    case kText:
      return fmt::format("<text{}{}>{}</text>\n", of,
                         s.degrees == 0 ? Attributes({{"x", at.x_m}, {"y", at.y_m}}) : Turned(at, s.degrees),
                         Escape(s.text));
    case kImage:
      return fmt::format(
          "<image{} preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" "
          "href=\"data:image/png;base64,{}\"/>\n",
          box(), Base64(s.raster.Png()));
    case kBeginClip: {
      // By what it is: the same drawing of another stage on the page has the same rectangle.
      Hasher hasher;
      hasher.Add(box());
      const std::string clip = id + "-" + hasher.Finish().Hex().substr(0, 8);
      return fmt::format("<clipPath id=\"{0}\"><rect{1}/></clipPath>\n<g clip-path=\"url(#{0})\">\n", clip,
                         box());
    }
    case kEndClip:
      return "</g>\n";
  }
  return {};
}

}  // namespace

void Picture::Line(Point from, Point to, std::string_view classes) {
  elements_.push_back({Element::Kind::kLine, std::string(classes), {from, to}});
}

void Picture::Polyline(std::vector<Point> points, std::string_view classes) {
  if (points.size() >= 2)
    elements_.push_back({Element::Kind::kPolyline, std::string(classes), std::move(points)});
}

void Picture::Polygon(std::vector<Point> corners, std::string_view classes) {
  if (corners.size() >= 3)
    elements_.push_back({Element::Kind::kPolygon, std::string(classes), std::move(corners)});
}

void Picture::Dots(std::vector<Point> points, std::string_view classes) {
  if (!points.empty()) elements_.push_back({Element::Kind::kDots, std::string(classes), std::move(points)});
}

void Picture::Circle(Point at, double radius, std::string_view classes, std::string_view tip) {
  elements_.push_back(
      {Element::Kind::kEllipse, std::string(classes), {at}, radius, radius, 0, std::string(tip)});
}

void Picture::Ellipse(Point at, double major, double minor, double degrees, std::string_view classes) {
  elements_.push_back({Element::Kind::kEllipse, std::string(classes), {at}, major, minor, degrees});
}

void Picture::Rect(const Panel& p, std::string_view classes, std::string_view tip, std::optional<Rgb> fill) {
  elements_.push_back({Element::Kind::kRect,
                       std::string(classes),
                       {{p.left, p.top}},
                       p.width,
                       p.height,
                       0,
                       std::string(tip),
                       fill});
}

void Picture::Text(Point at, std::string_view text, std::string_view classes, double degrees) {
  elements_.push_back({Element::Kind::kText, std::string(classes), {at}, 0, 0, degrees, std::string(text)});
}

void Picture::Image(const Panel& p, Raster raster) {
  elements_.push_back(
      {Element::Kind::kImage, "", {{p.left, p.top}}, p.width, p.height, 0, "", {}, std::move(raster)});
}

void Picture::BeginClip(const Panel& p) {
  elements_.push_back({Element::Kind::kBeginClip, "", {{p.left, p.top}}, p.width, p.height});
}

void Picture::EndClip() { elements_.push_back({Element::Kind::kEndClip, "", {}}); }

void Picture::Add(const Picture& other, Point by) {
  for (Element shape : other.elements_) {
    for (Point& point : shape.points) point = {point.x_m + by.x_m, point.y_m + by.y_m};
    elements_.push_back(std::move(shape));
  }
}

std::string Picture::SvgShapes() const {
  Hasher hasher;
  hasher.Add(label_);
  const std::string id = "c" + hasher.Finish().Hex().substr(0, 10);
  std::string svg;
  for (const Element& shape : elements_) svg += SvgOf(shape, id);
  return svg;
}

std::string Picture::Svg() const {
  return empty() ? ""
                 : fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n{}</svg>\n",
                               Short(width_), Short(height_), Escape(label_), SvgShapes());
}

double TextWidth(std::string_view text, double font) {
  return 0.6 * font * static_cast<double>(TextColumns(text));
}

LegendEntry LineEntry(std::string_view classes, const std::string& text) {
  LegendEntry entry{Picture(kMarkWidth, kMarkHeight), text};
  entry.mark.Line({1, 7}, {25, 7}, classes);
  return entry;
}

LegendEntry DotEntry(std::string_view classes, double radius, const std::string& text) {
  LegendEntry entry{Picture(kMarkWidth, kMarkHeight), text};
  entry.mark.Circle({13, 7}, radius, classes);
  return entry;
}

LegendEntry SwatchEntry(Rgb colour, const std::string& text) {
  LegendEntry entry{Picture(kMarkWidth, kMarkHeight), text};
  entry.mark.Rect({1, 1, 24, 12}, "swatch", "", colour);
  return entry;
}

double DrawLegend(const std::vector<LegendEntry>& entries, double left, double top, Picture* picture) {
  constexpr double kToText = kMarkWidth + 7, kBetween = 18, kRow = 20;
  double x = left, y = top;
  for (const LegendEntry& entry : entries) {
    const double needed = kToText + TextWidth(entry.text);
    if (x > left && x + needed > picture->width()) {
      x = left;
      y += kRow;
    }
    picture->Add(entry.mark, {x, y});
    picture->Text({x + kToText, y + 11}, entry.text, "");
    x += needed + kBetween;
  }
  return entries.empty() ? 0 : y + kRow - top;
}

std::string Base64(std::string_view bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      bits = bits << 8 | (i + j < bytes.size() ? static_cast<std::uint8_t>(bytes[i + j]) : 0U);
    }
    for (std::size_t j = 0; j < 4; ++j) {
      text += i + j <= bytes.size() ? kDigits[bits >> (18 - 6 * j) & 63] : '=';
    }
  }
  return text;
}

}  // namespace cairn::datasets::report
