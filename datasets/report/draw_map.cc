#include "datasets/report/draw_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/report/cell_picture.h"
#include "datasets/report/drawing/axes.h"
#include "datasets/report/drawing/canvas.h"
#include "datasets/report/drawing/format.h"
#include "datasets/report/drawing/labels.h"
#include "datasets/report/drawing/palette.h"
#include "datasets/report/grid_picture.h"
#include "datasets/report/pictures.h"
#include "datasets/report/scene.h"

namespace cairn::datasets {
namespace report {
namespace {

constexpr double kVisibleErrorM = 0.01;
constexpr double kDrawMapText = 11, kMargin = 22;

struct Legend {
  enum class Kind {
    kPath,
    kTruthPath,
    kLandmark,
    kTruthLandmark,
    kSpurious,
    kStart,
    kError,
    kSwatch,
    kEdge,
    kLoop
  } kind;
  std::string text;
  Rgb colour;
};

constexpr Rgb kRaw{194, 154, 12}, kGood{26, 127, 75}, kWall{210, 96, 26};
constexpr std::int64_t kMostCells = 1500;

// The scale of a picture of cells, and what is not on it.
void AddScale(std::vector<Legend>* items) {
  using enum Legend::Kind;
  for (const auto& [p, text] :
       {std::pair{0.0, "free"}, {0.25, "0.25"}, {0.5, "0.5"}, {0.75, "0.75"}, {1.0, "occupied"}})
    items->push_back({kSwatch, text, OfProbability(p)});
  items->push_back({kSwatch, "nothing known", kUnknown});
}

// Greys, where there is nothing but the grid.
bool IsTint(const Scene& scene) { return !scene.landmarks.empty(); }

std::vector<Legend> LegendOf(const Scene& scene, bool cells) {
  using enum Legend::Kind;
  std::vector<Legend> items;
  items.reserve(scene.paths.size());
  if (cells || (scene.grid && !IsTint(scene))) AddScale(&items);
  if (scene.grid && IsTint(scene))
    items.push_back({kSwatch, "P(landmark) of a cell, the stronger the likelier", kTint});
  for (const Path& path : scene.paths) {
    items.push_back({kPath, RobotTitle(path.robot), kRobots[path.index % kRobotColours]});
  }
  if (!scene.paths.empty())
    items.push_back({kStart, "start", kRobots[scene.paths.front().index % kRobotColours]});
  if (!scene.odometry_below.empty()) items.push_back({kPath, "odometry alone", kRaw});
  if (!scene.edges.empty()) items.push_back({kEdge, "edge that traces found occupied", kInk});
  const auto used = [](const Scene::Loop& loop) { return loop.used; };
  if (std::ranges::any_of(scene.loops, used)) items.push_back({kLoop, "loop that the path follows", kGood});
  if (!std::ranges::all_of(scene.loops, used)) items.push_back({kError, "loop that others contradict", kBad});
  if (!scene.truth_walls.empty()) items.push_back({kPath, "true wall", kWall});
  if (!scene.landmarks.empty()) items.push_back({kLandmark, "landmark, 95% region", kInk});
  if (!scene.truth_landmarks.empty()) items.push_back({kTruthLandmark, "true landmark", kTruth});
  const bool gaps =
      std::ranges::any_of(scene.truth_paths, [](const Path& path) { return !path.breaks.empty(); });
  if (!scene.truth_paths.empty())
    items.push_back({kTruthPath, gaps ? "true path, where it is known" : "true path", kTruePathGrey});
  const bool errs = std::any_of(scene.error_lines.begin(), scene.error_lines.end(), [](const auto& line) {
    return DistanceM(line.first, line.second) > kVisibleErrorM;
  });
  if (errs) items.push_back({kError, "error", kBad});
  const bool spurious = std::any_of(scene.landmarks.begin(), scene.landmarks.end(),
                                    [](const MapLandmark& landmark) { return landmark.spurious; });
  if (spurious) items.push_back({kSpurious, "spurious landmark", kBad});
  return items;
}

void DrawStart(Point at, Rgb colour, Canvas& canvas) {
  canvas.Dot(at, 8, kPaper);
  canvas.Dot(at, 6.5, colour);
}

// Places the legend's items in rows; `draw` says whether to draw them or only to count. Returns the height.
double DrawLegend(const std::vector<Legend>& items, double width, Canvas* canvas) {
  using enum Legend::Kind;
  constexpr double kSwatchWidth = 30, kGap = 26, kRow = 24;
  double x = kMargin, y = kMargin + kDrawMapText;
  for (const Legend& item : items) {
    const double needed = kSwatchWidth + 8 + Canvas::TextWidth(item.text, kDrawMapText) + kGap;
    if (x > kMargin && x + needed > width - kMargin) {
      x = kMargin;
      y += kRow;
    }
    if (canvas != nullptr) {
      const double middle = y - kDrawMapText / 2;
      const Point centre{x + kSwatchWidth / 2, middle};
      if (item.kind == kPath) canvas->Line({x, middle}, {x + kSwatchWidth, middle}, item.colour, 2);
      if (item.kind == kTruthPath) canvas->Line({x, middle}, {x + kSwatchWidth, middle}, item.colour, 5);
      if (item.kind == kLandmark) canvas->Ellipse(centre, 13, 8, 0, kSoft, 0.5);
      if (item.kind == kLandmark || item.kind == kSpurious) canvas->Dot(centre, 4, item.colour);
      if (item.kind == kError) canvas->Line({x, middle}, {x + kSwatchWidth, middle}, item.colour, 2);
      if (item.kind == kSwatch) {
        canvas->Fill({x, middle - 7}, {x + kSwatchWidth, middle + 7}, item.colour);
        canvas->Frame({x, middle - 7}, {x + kSwatchWidth, middle + 7}, kLine, 1);
      }
      if (item.kind == kEdge) {
        for (const double dx : {4.0, 11.0, 18.0, 26.0}) canvas->Dot({x + dx, middle}, 1.6, item.colour);
      }
      if (item.kind == kLoop) canvas->Dot(centre, 3, item.colour);
      if (item.kind == kStart) DrawStart(centre, item.colour, *canvas);
      if (item.kind == kTruthLandmark) canvas->Ring(centre, 8, item.colour, 2);
      canvas->Text({x + kSwatchWidth + 8, y}, item.text, kInk, kDrawMapText);
    }
    x += needed;
  }
  return y + kRow / 2;
}

class MapPainter {
 public:
  // `cells` may be null.
  MapPainter(const Scene& scene, const CellPicture* cells, Canvas& canvas, const MapFrame& frame)
      : scene_(scene), cells_(cells), canvas_(canvas), frame_(frame) {}

  void Paint() {
    if (cells_ != nullptr) PaintCells(*cells_);
    if (scene_.grid) PaintGrid(*scene_.grid);
    PaintRaster();
    for (const auto& [a, b] : scene_.truth_walls) canvas_.Line(At(a), At(b), kWall, 1.5);
    for (const Point& edge : scene_.edges) canvas_.Dot(At(edge), 1.6, kInk);
    for (const Path& path : scene_.truth_paths) PaintPath(path, kTruePathGrey, 5);
    for (const Path& path : scene_.odometry_below) PaintPath(path, kRaw, 1);
    for (const Path& path : scene_.paths) PaintPath(path, kRobots[path.index % kRobotColours], 1.5);
    for (const Scene::Loop& loop : scene_.loops) {
      if (!loop.used) canvas_.Line(At(loop.from), At(loop.to), kBad, 1.2);
      canvas_.Dot(At(loop.from), 2.4, loop.used ? kGood : kBad);
    }
    for (const auto& [ours, theirs] : scene_.error_lines) canvas_.Line(At(ours), At(theirs), kBad, 2);
    for (const Point& point : scene_.truth_landmarks) canvas_.Ring(At(point), 9, kTruth, 2);
    PaintLandmarks();
    PaintStarts();
    PaintFrame();
  }

 private:
  Point At(Point point) const { return {frame_.X(point.x_m), frame_.Y(point.y_m)}; }

  std::vector<Point> At(const std::vector<Point>& points) const {
    std::vector<Point> pixels;
    pixels.reserve(points.size());
    for (const Point& point : points) pixels.push_back(At(point));
    return pixels;
  }

  // A path's single places are dots.
  void PaintPath(const Path& path, Rgb colour, double width) {
    for (const std::vector<Point>& piece : Pieces(path)) {
      if (piece.size() == 1) canvas_.Dot(At(piece[0]), width / 2, colour);
      canvas_.Polyline(At(piece), colour, width);
    }
  }

  void PaintCells(const CellPicture& picture) {
    const CellBox& box = picture.box;
    for (std::int64_t row = 0; row < box.rows; ++row) {
      for (std::int64_t column = 0; column < box.columns; ++column) {
        const Point low{box.origin_x_m + static_cast<double>(column) * box.cell_m,
                        box.origin_y_m + static_cast<double>(row) * box.cell_m};
        canvas_.Fill(At({low.x_m, low.y_m + box.cell_m}), At({low.x_m + box.cell_m, low.y_m}),
                     picture.At(column, row));
      }
    }
  }

  void PaintGrid(const Grid& grid) {
    const bool tint = IsTint(scene_);
    const double highest = tint ? HighestProbability(grid) : 1;
    for (std::int64_t row = 0; row < grid.rows; ++row) {
      for (std::int64_t column = 0; column < grid.columns; ++column) {
        const double p = grid.probability[static_cast<std::size_t>(row * grid.columns + column)];
        if (tint && !(p > 0)) continue;  // not a number: nothing is known
        const double share = highest > 0 ? std::clamp(p / highest, 0.0, 1.0) : 0;
        const double x = grid.origin.x_m + static_cast<double>(column) * grid.cell_m;
        const double y = grid.origin.y_m + static_cast<double>(row) * grid.cell_m;
        const Rgb colour = tint ? Mix(kPaper, kTint, std::sqrt(share)) : OfProbability(p);
        canvas_.Fill(At({x, y + grid.cell_m}), At({x + grid.cell_m, y}), colour);
      }
    }
  }

  void PaintRaster() {
    const Panel& p = frame_.panel();
    const Box& box = frame_.box();
    for (const double x : Ticks(box.x_low_m, box.x_high_m, static_cast<int>(p.width / 120))) {
      canvas_.Line({frame_.X(x), p.top}, {frame_.X(x), p.top + p.height}, kRaster, 1);
    }
    for (const double y : Ticks(box.y_low_m, box.y_high_m, static_cast<int>(p.height / 90))) {
      canvas_.Line({p.left, frame_.Y(y)}, {p.left + p.width, frame_.Y(y)}, kRaster, 1);
    }
  }

  void PaintLandmarks() {
    for (const MapLandmark& landmark : scene_.landmarks) {
      const EllipseM& e = landmark.ellipse;
      const double major = e.major_m * frame_.pixels_per_m(), minor = e.minor_m * frame_.pixels_per_m();
      const double degrees = -e.angle_rad * 180 / std::numbers::pi;
      if (major > 5) canvas_.Ellipse(At(landmark.at), major, std::max(minor, 1.0), degrees, kSoft, 0.5);
    }
    for (const MapLandmark& landmark : scene_.landmarks) {
      const Point at = At(landmark.at);
      canvas_.Dot(at, 5.2, kPaper);
      canvas_.Dot(at, 4, landmark.spurious ? kBad : kInk);
    }
    PaintNames();
  }

  void PaintNames() {
    std::vector<Label> labels;
    for (const std::size_t k : NamedLandmarks(scene_)) {
      const MapLandmark& landmark = scene_.landmarks[k];
      labels.push_back(
          {At(landmark.at), landmark.name, Canvas::TextWidth(landmark.name, kDrawMapText), landmark.count});
    }
    for (const PlacedLabel& name : PlaceLabels(labels, frame_.panel(), kDrawMapText, 6))
      canvas_.Text(name.baseline, labels[name.label].text, kInk, kDrawMapText, Align::kLeft, 2);
  }

  void PaintStarts() {
    for (const Path& path : scene_.paths) {
      if (path.points.empty()) continue;
      DrawStart(At(path.points.front()), kRobots[path.index % kRobotColours], canvas_);
    }
  }

  // What was drawn beyond the panel is covered, then come the axes.
  void PaintFrame() {
    const Panel& p = frame_.panel();
    const double right = p.left + p.width, bottom = p.top + p.height, far = 20000;
    canvas_.Fill({0, 0}, {far, p.top}, kPaper);
    canvas_.Fill({0, bottom}, {far, far}, kPaper);
    canvas_.Fill({0, 0}, {p.left, far}, kPaper);
    canvas_.Fill({right, 0}, {far, far}, kPaper);
    canvas_.Frame({p.left, p.top}, {right, bottom}, kLine, 1);
    const Box& box = frame_.box();
    for (const double x : Ticks(box.x_low_m, box.x_high_m, static_cast<int>(p.width / 120))) {
      canvas_.Text({frame_.X(x), bottom + 20}, Short(x), kSoft, kDrawMapText, Align::kMiddle);
    }
    for (const double y : Ticks(box.y_low_m, box.y_high_m, static_cast<int>(p.height / 90))) {
      canvas_.Text({p.left - 8, frame_.Y(y) + kDrawMapText / 2}, Short(y), kSoft, kDrawMapText,
                   Align::kRight);
    }
    canvas_.Text({p.left + p.width / 2, bottom + 44}, "x [m]", kSoft, kDrawMapText, Align::kMiddle);
    canvas_.Text({p.left + 8, p.top + 18}, "y [m]", kSoft, kDrawMapText, Align::kLeft, 2);
    PaintScale(right, bottom);
  }

  void PaintScale(double right, double bottom) {
    const double bar_m = RoundBelow(frame_.box().width_m() / 6);
    const double width = bar_m * frame_.pixels_per_m(), end = right - 20, y = bottom - 18;
    canvas_.Fill({end - width - 10, y - 26}, {end + 10, y + 10}, kPaper);
    canvas_.Line({end - width, y}, {end, y}, kInk, 2);
    for (const double x : {end - width, end}) canvas_.Line({x, y - 6}, {x, y + 6}, kInk, 2);
    canvas_.Text({end - width / 2, y - 10}, Short(bar_m) + " m", kInk, kDrawMapText, Align::kMiddle);
  }

  const Scene& scene_;
  const CellPicture* cells_;
  Canvas& canvas_;
  const MapFrame& frame_;
};

Box BoxOf(const CellBox& cells) {
  return {cells.origin_x_m, cells.origin_x_m + static_cast<double>(cells.columns) * cells.cell_m,
          cells.origin_y_m, cells.origin_y_m + static_cast<double>(cells.rows) * cells.cell_m};
}

std::string Draw(const Scene& scene, const CellPicture* cells, int width_px) {
  CAIRN_DEMAND(width_px >= 400 && width_px <= 10000, "400 to 10000 pixels");
  const std::vector<Legend> legend = LegendOf(scene, cells != nullptr);
  const double legend_height = DrawLegend(legend, width_px, nullptr);
  const Box box = cells != nullptr ? BoxOf(cells->box) : BoundsOf(scene, false);
  constexpr double kDrawMapLeft = 70, kDrawMapRight = 22, kDrawMapBottom = 60;
  Panel panel{kDrawMapLeft, legend_height + 16, width_px - kDrawMapLeft - kDrawMapRight, 0};
  panel.height = PanelHeight(box, panel.width, 0.25 * panel.width, 1.4 * panel.width);
  Canvas canvas(width_px, static_cast<int>(std::ceil(panel.top + panel.height + kDrawMapBottom)), kPaper);
  const MapFrame frame(box, panel);
  MapPainter(scene, cells, canvas, frame).Paint();
  DrawLegend(legend, width_px, &canvas);
  return canvas.Png();
}

}  // namespace
}  // namespace report

std::string DrawMapPng(const Blob& result, const Blob* log, const Evaluation* evaluation, int width_px) {
  return DrawScenePng(report::MakeScene(result, log, evaluation), width_px);
}

std::string DrawGridPng(const Blob& map, const Blob* log, const GridEvaluation* evaluation, int width_px) {
  const auto cells = report::PictureOf(map, report::MapLayer::kProbability);
  const report::CellPicture blocks = report::InBlocks(*cells, report::kMostCells);
  return report::Draw(report::GridSceneOf(map, log, evaluation), &blocks, width_px);
}

std::string DrawScenePng(const report::Scene& scene, int width_px) {
  bool drawable = scene.grid.has_value() || !scene.landmarks.empty();
  for (const report::Path& path : scene.paths) drawable = drawable || !path.points.empty();
  if (!drawable) throw InputError("there is neither a map nor a path in it to draw");
  return report::Draw(scene, nullptr, width_px);
}

}  // namespace cairn::datasets
