#include "datasets/reproduce/panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "datasets/report/drawing/charts.h"
#include "datasets/report/pictures.h"

namespace cairn::datasets::report {
namespace {

constexpr double kGap = 12, kTitle = 30, kTicks = 44, kPanelsLeft = 46;
constexpr double kFigureWidth = 1000, kWidest = 460;

class PanelPainter {
 public:
  PanelPainter(const PanelPicture& shown, const Box& box, const Panel& panel, Picture* picture)
      : shown_(shown), frame_(box, panel), picture_(*picture) {}

  void Paint() {
    const Panel& panel = frame_.panel();
    DrawAxes(frame_,
             {.x = "x [m]", .y = "y [m]", .y_ticks = std::max(2, static_cast<int>(panel.height / 50))},
             &picture_);
    picture_.BeginClip(panel);
    if (shown_.cells) picture_.Image(frame_.At(BoxOf(shown_.cells->box)), CellsRaster(*shown_.cells));
    if (shown_.density)
      picture_.Image(frame_.At(BoxOf(*shown_.density)), GridRaster(*shown_.density, GridColours::kDensity));
    for (const auto& path : shown_.raw) picture_.Polyline(Pixels(path), "path");
    Circles(shown_.truth, 6.5, "truth-landmark");
    for (std::size_t r = 0; r < shown_.paths.size(); ++r)
      picture_.Polyline(Pixels(shown_.paths[r]), PathClass(r));
    Circles(shown_.marks, 4.5, "ring");
    // A belief shows beside them.
    Circles(shown_.landmarks, shown_.density && shown_.paths.empty() ? 2 : 3.5, "landmark");
    if (shown_.robot) Circles({*shown_.robot}, 9, "ring wrong");
    picture_.EndClip();
    DrawFrame(frame_, &picture_);
    picture_.Text({panel.left, panel.top - 9}, shown_.title, "strong");
  }

  static std::string PathClass(std::size_t robot) { return fmt::format("path r{}", robot % kRobotColours); }

 private:
  std::vector<Point> Pixels(const std::vector<Point>& points) const {
    std::vector<Point> pixels;
    for (const Point& p : points) pixels.push_back(frame_.At(p));
    return pixels;
  }
  void Circles(const std::vector<Point>& points, double radius, std::string_view classes) {
    for (const Point& at : Pixels(points)) picture_.Circle(at, radius, classes);
  }

  const PanelPicture& shown_;
  MapFrame frame_;
  Picture& picture_;
};

std::vector<LegendEntry> LegendOf(const std::vector<PanelPicture>& panels) {
  const auto any = [&](auto has) { return std::ranges::any_of(panels, has); };
  std::vector<LegendEntry> entries;
  const auto dense = std::ranges::find_if(panels, [](const auto& p) { return p.density.has_value(); });
  if (dense != panels.end()) {
    LegendEntry entry{Picture(kMarkWidth, kMarkHeight), dense->density_name + ", the darker the likelier"};
    for (int i = 0; i < 24; ++i)
      entry.mark.Rect({1.0 + i, 1, 1, 12}, "", "", Mix(kPaper, kDensity, (i + 1) / 24.0));
    entries.push_back(std::move(entry));
  }
  if (any([](const auto& p) { return p.cells.has_value(); })) {
    for (const auto& [text, colour] :
         {std::pair{"free", kPaper}, {"0.5", kEvenChance}, {"occupied", kBlack}, {"nothing known", kUnknown}})
      entries.push_back(SwatchEntry(colour, text));
  }
  if (any([](const auto& p) { return !p.raw.empty(); })) entries.push_back(LineEntry("path", "raw odometry"));
  if (any([](const auto& p) { return !p.marks.empty(); }))
    entries.push_back(DotEntry("ring", 4.5, "an observation there"));
  std::size_t robots = 0;
  for (const PanelPicture& p : panels) robots = std::max(robots, p.paths.size());
  for (std::size_t r = 0; r < robots; ++r)
    entries.push_back(LineEntry(PanelPainter::PathClass(r),
                                robots == 1 ? "most likely path" : fmt::format("path of robot {}", r + 1)));
  if (any([](const auto& p) { return !p.landmarks.empty(); }))
    entries.push_back(DotEntry("landmark", 3.5, "landmark of the map"));
  if (any([](const auto& p) { return !p.truth.empty(); }))
    entries.push_back(DotEntry("truth-landmark", 6, "true landmark"));
  if (any([](const auto& p) { return p.robot.has_value(); }))
    entries.push_back(DotEntry("ring wrong", 6.5, "true place of the robot"));
  return entries;
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
  const double pitch_x = kPanelsLeft + width + kGap, pitch_y = kTitle + height + kTicks;
  Picture picture(columns * pitch_x);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const std::size_t in_column = i / static_cast<std::size_t>(columns);
    const auto column = static_cast<double>(i % static_cast<std::size_t>(columns)),
               row = static_cast<double>(in_column);
    PanelPainter(panels[i], box, {column * pitch_x + kPanelsLeft, row * pitch_y + kTitle, width, height},
                 &picture)
        .Paint();
  }
  picture.SetHeight(rows * pitch_y + DrawLegend(LegendOf(panels), kPanelsLeft, rows * pitch_y, &picture));
  return picture.Png();
}

}  // namespace cairn::datasets::report
