#include "datasets/report/drawing/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "datasets/report/drawing/course.h"
#include "datasets/report/drawing/format.h"
#include "schema/hash.h"
#include "schema/text.h"

namespace cairn::datasets::report {
namespace {

// Finer than what is seen at first, for those who look closer.
constexpr double kCoursePixels = 0.03;

// "x,y x,y;x,y": a round after the other.
std::string RoundsOf(const Element& s) {
  std::string text;
  for (const Raster& raster : s.rasters) text += Base64(raster.Png()) + ";";
  for (const std::vector<Point>& round : s.rounds) {
    if (!text.empty()) text.back() = ';';
    for (const Point& point : round) text += fmt::format("{},{} ", Short(point.x_m), Short(point.y_m));
  }
  return text.substr(0, text.size() - 1);
}

// "x="3.5" y="7"" of a list of names and numbers.
std::string Attributes(std::initializer_list<std::pair<const char*, double>> attributes) {
  std::string text;
  for (const auto& [name, value] : attributes) text += fmt::format(" {}=\"{}\"", name, Short(value));
  return text;
}

std::string PointsAttribute(const std::vector<Point>& points) {
  std::string text = " points=\"";
  for (const Point& point : points) text += fmt::format("{},{} ", Short(point.x_m), Short(point.y_m));
  text.back() = '"';
  return text;
}

std::string CourseAttributes(const Element& line, bool timed) {
  std::vector<Point> points;
  std::string times;
  timed = timed && !line.times_s.empty();
  for (const std::size_t i :
       CourseOf(line.points, timed ? line.times_s : std::vector<double>(), kCoursePixels)) {
    points.push_back(line.points[i]);
    if (timed) times += (times.empty() ? "" : " ") + Short(line.times_s[i], 3);
  }
  return PointsAttribute(points) + (times.empty() ? "" : fmt::format(" data-time=\"{}\"", times));
}

std::string Turned(Point at, double degrees) {
  return fmt::format(" transform=\"translate({} {}) rotate({})\"", Short(at.x_m), Short(at.y_m),
                     Short(degrees));
}

bool IsImage(const Element& s) { return s.kind == Element::Kind::kImage; }

std::string BoxAttributes(const Element& s) {
  const Point at = s.points.front();
  return Attributes({{"x", at.x_m}, {"y", at.y_m}, {"width", s.width}, {"height", s.height}});
}

std::string ImageId(const Element& image) {
  Hasher hasher;
  hasher.Add(BoxAttributes(image));
  hasher.Add(std::as_bytes(std::span(image.raster.pixels)));
  return "i" + hasher.Finish().Hex().substr(0, 12);
}

// Where `shown` is, in the place of `image`.
std::string UseOf(const Element& shown, const Element& image) {
  const double x = image.width / shown.width, y = image.height / shown.height;
  return fmt::format("<use href=\"#{}\" transform=\"translate({} {}) scale({} {})\"/>\n", ImageId(shown),
                     Short(image.points[0].x_m - x * shown.points[0].x_m, 4),
                     Short(image.points[0].y_m - y * shown.points[0].y_m, 4), Short(x, 6), Short(y, 6));
}

// `map`: of a picture in which people can look around.
std::string SvgOf(const Element& s, const std::string& id, bool map) {
  using enum Element::Kind;
  const Point at = s.points.empty() ? Point{} : s.points.front();
  const std::string of = s.classes.empty() ? "" : fmt::format(" class=\"{}\"", s.classes);
  const auto closed = [&](const char* tag) {
    return s.text.empty() ? "/>" : fmt::format("><title>{}</title></{}>", Escape(s.text), tag);
  };
  switch (s.kind) {
    case kLine:
      return fmt::format(
          "<line{}{}/>\n", of,
          Attributes({{"x1", at.x_m}, {"y1", at.y_m}, {"x2", s.points[1].x_m}, {"y2", s.points[1].y_m}}));
    case kPolyline:
      return fmt::format("<polyline{}{}/>\n", of, CourseAttributes(s, map));
    case kPolygon:
      return fmt::format("<polygon{}{}/>\n", of, PointsAttribute(s.points));
    case kDots: {
      std::string path;
      for (const Point& dot : s.points) path += fmt::format("M{} {}h0", Short(dot.x_m, 1), Short(dot.y_m, 1));
      return fmt::format("<path{} d=\"{}\"/>\n", of, path);
    }
    case kEllipse:
      if (s.width == s.height)
        return fmt::format(
            "<circle{}{}{}{}\n", of, Attributes({{"cx", at.x_m}, {"cy", at.y_m}, {"r", s.width}}),
            s.name.empty() ? "" : fmt::format(" data-name=\"{}\"", Escape(s.name)), closed("circle"));
      return fmt::format("<ellipse{}{}{}/>\n", of, Attributes({{"rx", s.width}, {"ry", s.height}}),
                         Turned(at, s.degrees));
    case kRect: {
      const Rgb c = s.fill.value_or(kPaper);
      const std::string fill = s.fill ? fmt::format(" fill=\"#{:02x}{:02x}{:02x}\"", c[0], c[1], c[2]) : "";
      return fmt::format("<rect{}{}{}{}\n", of, BoxAttributes(s), fill, closed("rect"));
    }
    case kText:
      return fmt::format("<text{}{}>{}</text>\n", of,
                         s.degrees == 0 ? Attributes({{"x", at.x_m}, {"y", at.y_m}}) : Turned(at, s.degrees),
                         Escape(s.text));
    case kImage:
      return fmt::format(
          "<image id=\"{}\"{} preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" "
          "href=\"data:image/png;base64,{}\"/>\n",
          ImageId(s), BoxAttributes(s), Base64(s.raster.Png()));
    case kBeginClip: {
      // By what it is: the same drawing of another stage on the page has the same rectangle.
      Hasher hasher;
      hasher.Add(BoxAttributes(s));
      const std::string clip = id + "-" + hasher.Finish().Hex().substr(0, 8);
      return fmt::format("<clipPath id=\"{0}\"><rect{1}/></clipPath>\n<g clip-path=\"url(#{0})\">\n", clip,
                         BoxAttributes(s));
    }
    case kBeginLayer:
      return fmt::format("<g{} data-layer=\"{}\">\n", of, Escape(s.text));
    case kEndClip:
    case kEndLayer:
      return "</g>\n";
    case kRounds:
      return map ? fmt::format("<g{} data-rounds=\"{}\"/>\n", of, RoundsOf(s)) : "";
  }
  return {};
}

}  // namespace

void Picture::Line(Point from, Point to, std::string_view classes) {
  elements_.push_back({Element::Kind::kLine, std::string(classes), {from, to}});
}

void Picture::Polyline(std::vector<Point> points, std::string_view classes, std::vector<double> times_s) {
  if (points.size() < 2) return;
  elements_.push_back({.kind = Element::Kind::kPolyline,
                       .classes = std::string(classes),
                       .points = std::move(points),
                       .times_s = std::move(times_s)});
}

void Picture::Polygon(std::vector<Point> corners, std::string_view classes) {
  if (corners.size() >= 3)
    elements_.push_back({Element::Kind::kPolygon, std::string(classes), std::move(corners)});
}

void Picture::Dots(std::vector<Point> points, std::string_view classes) {
  if (!points.empty()) elements_.push_back({Element::Kind::kDots, std::string(classes), std::move(points)});
}

void Picture::Circle(Point at, double radius, std::string_view classes, std::string_view tip,
                     std::string_view name) {
  elements_.push_back({.kind = Element::Kind::kEllipse,
                       .classes = std::string(classes),
                       .points = {at},
                       .width = radius,
                       .height = radius,
                       .text = std::string(tip),
                       .name = std::string(name)});
}

void Picture::Ellipse(Point at, double major, double minor, double degrees, std::string_view classes) {
  elements_.push_back({Element::Kind::kEllipse, std::string(classes), {at}, major, minor, degrees});
}

void Picture::Rect(const Panel& p, std::string_view classes, std::string_view tip, std::optional<Rgb> fill) {
  elements_.push_back({.kind = Element::Kind::kRect,
                       .classes = std::string(classes),
                       .points = {{p.left, p.top}},
                       .width = p.width,
                       .height = p.height,
                       .text = std::string(tip),
                       .fill = fill});
}

void Picture::Text(Point at, std::string_view text, std::string_view classes, double degrees) {
  elements_.push_back({Element::Kind::kText, std::string(classes), {at}, 0, 0, degrees, std::string(text)});
}

void Picture::Image(const Panel& p, Raster raster) {
  elements_.push_back({.kind = Element::Kind::kImage,
                       .classes = "",
                       .points = {{p.left, p.top}},
                       .width = p.width,
                       .height = p.height,
                       .raster = std::move(raster)});
}

void Picture::BeginClip(const Panel& p) {
  elements_.push_back({Element::Kind::kBeginClip, "", {{p.left, p.top}}, p.width, p.height});
}

void Picture::EndClip() { elements_.push_back({Element::Kind::kEndClip, "", {}}); }

void Picture::BeginLayer(std::string_view name, bool shown) {
  elements_.push_back({.kind = Element::Kind::kBeginLayer,
                       .classes = shown ? "" : "off",
                       .points = {},
                       .text = std::string(name)});
}

void Picture::EndLayer() {
  elements_.push_back({.kind = Element::Kind::kEndLayer, .classes = "", .points = {}});
}

void Picture::Rounds(std::vector<std::vector<Point>> rounds, std::string_view classes) {
  if (rounds.empty()) return;
  elements_.push_back({.kind = Element::Kind::kRounds,
                       .classes = std::string(classes),
                       .points = {},
                       .rounds = std::move(rounds)});
}

void Picture::Rounds(std::vector<Raster> rounds) {
  if (rounds.empty()) return;
  elements_.push_back(
      {.kind = Element::Kind::kRounds, .classes = "", .points = {}, .rasters = std::move(rounds)});
}

void Picture::Add(const Picture& other, Point by) {
  for (Element shape : other.elements_) {
    const auto move = [by](Point& point) { point = {point.x_m + by.x_m, point.y_m + by.y_m}; };
    std::ranges::for_each(shape.points, move);
    for (std::vector<Point>& round : shape.rounds) std::ranges::for_each(round, move);
    elements_.push_back(std::move(shape));
  }
}

std::string Picture::SvgShapes(const Picture* shown) const {
  Hasher hasher;
  hasher.Add(label_);
  const std::string id = "c" + hasher.Finish().Hex().substr(0, 10);
  std::string svg;
  for (const Element& shape : elements_) {
    const Element* same = shown != nullptr && IsImage(shape) ? shown->FindImage(shape.raster) : nullptr;
    svg += same != nullptr ? UseOf(*same, shape) : SvgOf(shape, id, map_.has_value());
  }
  return svg;
}

const Element* Picture::FindImage(const Raster& raster) const {
  const auto found = std::ranges::find_if(
      elements_, [&](const Element& shape) { return IsImage(shape) && shape.raster == raster; });
  return found == elements_.end() ? nullptr : &*found;
}

std::string Picture::Svg(const Picture* shown) const {
  if (empty()) return "";
  std::string map;
  if (map_) {
    const Panel& p = map_->panel();
    map = fmt::format(" data-panel=\"{} {} {} {}\" data-metres=\"{} {} {} {}\"", Short(p.left), Short(p.top),
                      Short(p.width), Short(p.height), Short(map_->x().low, 6), Short(map_->x().high, 6),
                      Short(map_->y().low, 6), Short(map_->y().high, 6));
  }
  return fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\"{}>\n{}</svg>\n",
                     Short(width_), Short(height_), Escape(label_), map, SvgShapes(shown));
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
