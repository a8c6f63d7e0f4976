// A picture: shapes in pixels, y downwards, which look as their classes say (style.h). Written as SVG, whose
// colours are the page's, or as a PNG file on white paper.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/common/png.h"
#include "datasets/report/drawing/axes.h"
#include "datasets/report/drawing/palette.h"
#include "schema/geometry.h"

namespace cairn::datasets::report {

// Cells as pixels, row-major from the top.
struct Raster {
  std::uint32_t columns = 0, rows = 0;
  PngColour colour = PngColour::kRgb;
  std::vector<std::uint8_t> pixels = {};  // channels of a pixel together

  void Add(Rgb rgb) {
    for (const int channel : rgb) pixels.push_back(static_cast<std::uint8_t>(channel));
  }
  std::string Png() const { return EncodePng(columns, rows, pixels, colour); }
  bool operator==(const Raster&) const = default;
};

struct Element {
  enum class Kind : std::uint8_t {
    kLine,
    kPolyline,
    kPolygon,
    kDots,
    kEllipse,
    kRect,
    kText,
    kImage,
    kBeginClip,
    kEndClip,
    kBeginLayer,
    kEndLayer,
    kRounds
  } kind;
  std::string classes;
  std::vector<Point> points;  // ends, corners, centre; the upper left corner; a text's anchor on its baseline
  double width = 0, height = 0;      // of a rectangle; an ellipse's semi-axes
  double degrees = 0;                // clockwise
  std::string text = {};             // of a circle or a rectangle: shown when the pointer rests on it
  std::string name = {};             // of a circle: written beside it where there is room
  std::vector<double> times_s = {};  // of a polyline's points; empty where they have none
  std::vector<std::vector<Point>> rounds = {};  // what stood there before, round by round
  std::vector<Raster> rasters = {};             // the same of an image
  std::optional<Rgb> fill = {};                 // where no class says
  Raster raster = {};
};

inline constexpr double kFileScale = 1.4;  // pixels of a file for one of the picture's

class Picture {
 public:
  // `label` is what a screen reader says.
  explicit Picture(double width = 0, double height = 0, std::string label = "")
      : width_(width), height_(height), label_(std::move(label)) {}

  void Line(Point from, Point to, std::string_view classes);
  // In SVG only the points that its course takes (course.h).
  void Polyline(std::vector<Point> points, std::string_view classes, std::vector<double> times_s = {});
  // A filled area; nothing of fewer than three corners.
  void Polygon(std::vector<Point> corners, std::string_view classes);
  // One shape, which has as many parts: the stroke is as wide as they are.
  void Dots(std::vector<Point> points, std::string_view classes);
  void Circle(Point at, double radius, std::string_view classes, std::string_view tip = "",
              std::string_view name = "");
  void Ellipse(Point at, double major, double minor, double degrees, std::string_view classes);
  void Rect(const Panel& panel, std::string_view classes, std::string_view tip = "",
            std::optional<Rgb> fill = std::nullopt);
  void Text(Point at, std::string_view text, std::string_view classes, double degrees = 0);
  // Its pixels are kept sharp.
  void Image(const Panel& panel, Raster raster);
  // Everything until the matching EndClip is cut at this rectangle.
  void BeginClip(const Panel& panel);
  void EndClip();
  // Everything until the matching EndLayer can be shown and hidden by this name. Layers do not nest. One that
  // is not `shown` waits to be asked for: a file has nothing of it.
  void BeginLayer(std::string_view name, bool shown = true);
  void EndLayer();
  // What stood, one round after the other, in the place of what the layer shows: places that map_viewer.js
  // draws on demand.
  void Rounds(std::vector<std::vector<Point>> rounds, std::string_view classes);
  void Rounds(std::vector<Raster> rounds);
  // Where on the world what is clipped by the panel lies: then people can look around in it (map_viewer.js).
  void SetMap(const MapFrame& frame) { map_ = frame; }
  // All of another, moved by `by`.
  void Add(const Picture& other, Point by);

  void SetHeight(double height) { height_ = height; }
  double width() const { return width_; }
  double height() const { return height_; }
  bool empty() const { return elements_.empty(); }

  // The shapes alone, and whole; both empty where there is none.
  // An image that `shown` has too, which stands on the same page, is its.
  std::string SvgShapes(const Picture* shown = nullptr) const;
  std::string Svg(const Picture* shown = nullptr) const;
  // The bytes of a file `scale` times as wide and high. Letters beyond ASCII are drawn as ascii.h says.
  std::string Png(double scale = kFileScale) const;

 private:
  const Element* FindImage(const Raster& raster) const;

  double width_, height_;
  std::string label_;
  std::optional<MapFrame> map_;
  std::vector<Element> elements_;
};

// How wide a text is about, in a browser and in a file; `font`: its size in pixels.
double TextWidth(std::string_view text, double font = 12);

// What a mark or a colour means.
struct LegendEntry {
  Picture mark;  // in a box of 26 by 14
  std::string text;
};
inline constexpr double kMarkWidth = 26, kMarkHeight = 14;
LegendEntry LineEntry(std::string_view classes, const std::string& text);
LegendEntry DotEntry(std::string_view classes, double radius, const std::string& text);
LegendEntry SwatchEntry(Rgb colour, const std::string& text);

// Into rows from `left` to the picture's right edge. Returns their height.
double DrawLegend(const std::vector<LegendEntry>& entries, double left, double top, Picture* picture);

// RFC 4648, section 4.
std::string Base64(std::string_view bytes);

}  // namespace cairn::datasets::report
