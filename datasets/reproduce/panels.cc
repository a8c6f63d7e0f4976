#include "datasets/reproduce/panels.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "datasets/report/drawing/axes.h"
#include "datasets/report/drawing/canvas.h"
#include "datasets/report/drawing/format.h"
#include "datasets/report/drawing/palette.h"

namespace cairn::datasets::report {
namespace {

constexpr double kPanelsText = 11, kGap = 18, kTitle = 30, kTicks = 34, kPanelsLeft = 48;
constexpr double kFigureWidth = 1400, kWidest = 640;
constexpr Rgb kPanelRaw{120, 132, 144};

class PanelPainter {
 public:
  PanelPainter(const PanelPicture& picture, const Box& box, const Panel& panel, Canvas& canvas)
      : picture_(picture), frame_(box, panel), canvas_(canvas) {}

  void Paint() {
    if (picture_.cells) PaintCells(*picture_.cells);
    if (picture_.density) PaintDensity(*picture_.density);
    for (const auto& path : picture_.raw) Line(path, kPanelRaw, 1.2);
    for (const Point& at : Seen(picture_.truth)) canvas_.Ring(At(at), 6.5, kTruth, 1.5);
    for (std::size_t r = 0; r < picture_.paths.size(); ++r)
      Line(picture_.paths[r], kRobots[r % kRobotColours], 1.5);
    for (const Point& at : Seen(picture_.marks)) canvas_.Ring(At(at), 4.5, kInk, 1.2);
    const bool small = picture_.density && picture_.paths.empty();  // a belief shows beside it
    const double dot = small ? 2 : 3.5;
    for (const Point& at : Seen(picture_.landmarks)) {
      if (!small) canvas_.Dot(At(at), dot + 1, kPaper);
      canvas_.Dot(At(at), dot, kInk);
    }
    if (picture_.robot && Inside(*picture_.robot)) canvas_.Ring(At(*picture_.robot), 9, kBad, 2);
    PaintAxes();
  }

 private:
  Point At(Point p) const { return {frame_.X(p.x_m), frame_.Y(p.y_m)}; }
  bool Inside(Point p) const {
    const Panel& panel = frame_.panel();
    const Point at = At(p);
    return at.x_m >= panel.left && at.x_m <= panel.left + panel.width && at.y_m >= panel.top &&
           at.y_m <= panel.top + panel.height;
  }
  std::vector<Point> Seen(const std::vector<Point>& points) const {
    std::vector<Point> seen;
    std::ranges::copy_if(points, std::back_inserter(seen), [this](Point p) { return Inside(p); });
    return seen;
  }
  void Line(const std::vector<Point>& points, Rgb colour, double width) {
    std::vector<Point> pixels;
    for (const Point& p : points) pixels.push_back(At(p));
    canvas_.Polyline(pixels, colour, width);
  }

  // What of the panel the cell [x, x + edge) x [y, y + edge) covers.
  void FillCell(double x_m, double y_m, double edge_m, Rgb colour) {
    const Panel& panel = frame_.panel();
    Point low = At({x_m, y_m + edge_m}), high = At({x_m + edge_m, y_m});
    low = {std::max(low.x_m, panel.left), std::max(low.y_m, panel.top)};
    high = {std::min(high.x_m, panel.left + panel.width), std::min(high.y_m, panel.top + panel.height)};
    if (low.x_m < high.x_m && low.y_m < high.y_m) canvas_.Fill(low, high, colour);
  }

  void PaintCells(const CellPicture& picture) {
    const CellBox& box = picture.box;
    for (std::int64_t row = 0; row < box.rows; ++row) {
      for (std::int64_t column = 0; column < box.columns; ++column)
        FillCell(box.origin_x_m + static_cast<double>(column) * box.cell_m,
                 box.origin_y_m + static_cast<double>(row) * box.cell_m, box.cell_m, picture.At(column, row));
    }
  }

  // The root of the share of the most likely cell: a hundredth of it still shows.
  void PaintDensity(const Grid& grid) {
    const double highest = *std::ranges::max_element(grid.probability);
    for (std::int64_t row = 0; row < grid.rows; ++row) {
      for (std::int64_t column = 0; column < grid.columns; ++column) {
        const double p = grid.probability[static_cast<std::size_t>(row * grid.columns + column)];
        if (!(p > 0)) continue;
        FillCell(grid.origin.x_m + static_cast<double>(column) * grid.cell_m,
                 grid.origin.y_m + static_cast<double>(row) * grid.cell_m, grid.cell_m,
                 Mix(kPaper, kDensity, std::sqrt(p / highest)));
      }
    }
  }

  void PaintAxes() {
    const Panel& p = frame_.panel();
    const Box& box = frame_.box();
    const double bottom = p.top + p.height;
    canvas_.Frame({p.left, p.top}, {p.left + p.width, bottom}, kLine, 1);
    const std::vector<double> xs = Ticks(box.x_low_m, box.x_high_m, static_cast<int>(p.width / 70));
    const std::vector<double> ys = Ticks(box.y_low_m, box.y_high_m, static_cast<int>(p.height / 50));
    for (const double x : xs) {
      canvas_.Line({frame_.X(x), bottom}, {frame_.X(x), bottom - 5}, kSoft, 1);
      const std::string unit = x == xs.back() ? " m" : "";
      canvas_.Text({frame_.X(x), bottom + 15}, Short(x) + unit, kSoft, kPanelsText - 2, Align::kMiddle);
    }
    for (const double y : ys) {
      canvas_.Line({p.left, frame_.Y(y)}, {p.left + 5, frame_.Y(y)}, kSoft, 1);
      const std::string unit = y == ys.back() ? " m" : "";
      canvas_.Text({p.left - 5, frame_.Y(y) + 4}, Short(y) + unit, kSoft, kPanelsText - 2, Align::kRight);
    }
    canvas_.Text({p.left, p.top - 9}, picture_.title, kInk, kPanelsText);
  }

  const PanelPicture& picture_;
  MapFrame frame_;
  Canvas& canvas_;
};

struct Key {
  std::string text;
  std::function<void(Canvas&, Point)> draw;  // around a point
};

std::vector<Key> KeysOf(const std::vector<PanelPicture>& panels) {
  const auto any = [&](auto has) { return std::ranges::any_of(panels, has); };
  const auto line = [](Rgb colour) {
    return [colour](Canvas& c, Point at) { c.Line({at.x_m - 13, at.y_m}, {at.x_m + 13, at.y_m}, colour, 2); };
  };
  std::vector<Key> keys;
  const auto dense = std::ranges::find_if(panels, [](const auto& p) { return p.density.has_value(); });
  if (dense != panels.end()) {
    keys.push_back({dense->density_name + ", the darker the likelier", [](Canvas& c, Point at) {
                      for (int i = 0; i < 26; ++i)
                        c.Fill({at.x_m - 13 + i, at.y_m - 6}, {at.x_m - 12 + i, at.y_m + 6},
                               Mix(kPaper, kDensity, (i + 1) / 26.0));
                    }});
  }
  if (any([](const auto& p) { return p.cells.has_value(); })) {
    for (const auto& [text, colour] : {std::pair{"free", kPaper},
                                       {"0.5", kEvenChance},
                                       {"occupied", kBlack},
                                       {"nothing known", kUnknown}}) {
      const Rgb filled = colour;
      keys.push_back({text, [filled](Canvas& c, Point at) {
                        c.Fill({at.x_m - 13, at.y_m - 6}, {at.x_m + 13, at.y_m + 6}, filled);
                        c.Frame({at.x_m - 13, at.y_m - 6}, {at.x_m + 13, at.y_m + 6}, kLine, 1);
                      }});
    }
  }
  if (any([](const auto& p) { return !p.raw.empty(); })) keys.push_back({"raw odometry", line(kPanelRaw)});
  if (any([](const auto& p) { return !p.marks.empty(); }))
    keys.push_back({"an observation there", [](Canvas& c, Point at) { c.Ring(at, 4.5, kInk, 1.2); }});
  std::size_t robots = 0;
  for (const PanelPicture& p : panels) robots = std::max(robots, p.paths.size());
  for (std::size_t r = 0; r < robots; ++r) {
    const std::string name = robots == 1 ? "most likely path" : "path of robot " + std::to_string(r + 1);
    keys.push_back({name, line(kRobots[r % kRobotColours])});
  }
  if (any([](const auto& p) { return !p.landmarks.empty(); }))
    keys.push_back({"landmark of the map", [](Canvas& c, Point at) { c.Dot(at, 3.5, kInk); }});
  if (any([](const auto& p) { return !p.truth.empty(); }))
    keys.push_back({"true landmark", [](Canvas& c, Point at) { c.Ring(at, 6.5, kTruth, 1.5); }});
  if (any([](const auto& p) { return p.robot.has_value(); }))
    keys.push_back({"true place of the robot", [](Canvas& c, Point at) { c.Ring(at, 9, kBad, 2); }});
  return keys;
}

// In rows of a width; null only counts. Returns their height.
double DrawKeys(const std::vector<Key>& keys, double width, double top, Canvas* canvas) {
  constexpr double kRow = 24, kAfterMark = 20, kBetween = 36;
  double x = kPanelsLeft + 13, y = top + kRow / 2;
  for (const Key& key : keys) {
    const double needed = kAfterMark + Canvas::TextWidth(key.text, kPanelsText) + kBetween;
    if (x + needed - kBetween > width && x > kPanelsLeft + 13) {
      x = kPanelsLeft + 13;
      y += kRow;
    }
    if (canvas != nullptr) {
      key.draw(*canvas, {x, y});
      canvas->Text({x + kAfterMark, y + 4}, key.text, kInk, kPanelsText);
    }
    x += needed;
  }
  return y + kRow - top;
}

void Stretch(Point p, Box* box) {
  box->x_low_m = std::min(box->x_low_m, p.x_m);
  box->x_high_m = std::max(box->x_high_m, p.x_m);
  box->y_low_m = std::min(box->y_low_m, p.y_m);
  box->y_high_m = std::max(box->y_high_m, p.y_m);
}

void StretchToDensity(const Grid& grid, Box* box) {
  Stretch(grid.origin, box);
  Stretch({grid.origin.x_m + static_cast<double>(grid.columns) * grid.cell_m,
           grid.origin.y_m + static_cast<double>(grid.rows) * grid.cell_m},
          box);
}

}  // namespace

Box Around(const Box& a, const Box& b) {
  return {std::min(a.x_low_m, b.x_low_m), std::max(a.x_high_m, b.x_high_m), std::min(a.y_low_m, b.y_low_m),
          std::max(a.y_high_m, b.y_high_m)};
}

Box BoundsOf(const std::vector<PanelPicture>& panels) {
  Box box{HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL};
  for (const PanelPicture& p : panels) {
    for (const auto* points : {&p.marks, &p.landmarks, &p.truth}) {
      for (const Point& at : *points) Stretch(at, &box);
    }
    for (const auto* paths : {&p.raw, &p.paths}) {
      for (const auto& path : *paths) {
        for (const Point& at : path) Stretch(at, &box);
      }
    }
    if (p.robot) Stretch(*p.robot, &box);
  }
  const bool empty = box.x_low_m > box.x_high_m;
  for (const PanelPicture& p : panels) {
    if (empty && p.density) StretchToDensity(*p.density, &box);
  }
  if (box.x_low_m > box.x_high_m) return {-0.5, 0.5, -0.5, 0.5};
  const double pad = std::max(0.5, 0.05 * std::max(box.width_m(), box.height_m()));
  return {box.x_low_m - pad, box.x_high_m + pad, box.y_low_m - pad, box.y_high_m + pad};
}

std::string DrawPanels(const std::vector<PanelPicture>& panels, const Box& box, int columns) {
  CAIRN_DEMAND(columns > 0 && !panels.empty(), "something to draw");
  const double width = std::min(kWidest, (kFigureWidth - columns * (kPanelsLeft + kGap)) / columns);
  const double height = PanelHeight(box, width, 0.3 * width, 1.4 * width);
  const int rows = (static_cast<int>(panels.size()) + columns - 1) / columns;
  const double row_height = kTitle + height + kTicks;
  const std::vector<Key> keys = KeysOf(panels);
  const double file_width = columns * (kPanelsLeft + width + kGap);
  const double keys_height = DrawKeys(keys, file_width, 0, nullptr);
  Canvas canvas(static_cast<int>(std::ceil(file_width)),
                static_cast<int>(std::ceil(rows * row_height + keys_height)), kPaper);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const auto column = static_cast<double>(i % static_cast<std::size_t>(columns));
    const std::size_t row = i / static_cast<std::size_t>(columns);
    const double top = static_cast<double>(row) * row_height + kTitle;
    const Panel panel{column * (kPanelsLeft + width + kGap) + kPanelsLeft, top, width, height};
    PanelPainter(panels[i], box, panel, canvas).Paint();
  }
  DrawKeys(keys, file_width, rows * row_height, &canvas);
  return canvas.Png();
}

}  // namespace cairn::datasets::report
