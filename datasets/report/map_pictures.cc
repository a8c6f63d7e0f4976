#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/report/drawing/charts.h"
#include "datasets/report/drawing/format.h"
#include "datasets/report/drawing/labels.h"
#include "datasets/report/pictures.h"

namespace cairn::datasets::report {
namespace {

constexpr double kMapTop = 10, kMapRight = 10, kMapBottom = 40;
constexpr double kBesideFrom = 600;  // width from which on two maps stand side by side
constexpr std::size_t kCrowd = 100;  // of landmarks, whose dots are small
constexpr double kNameHeight = 9, kClearOfNames = 4.2;

bool IsVisible(const std::pair<Point, Point>& error) {
  constexpr double kVisible_m = 0.01;
  return DistanceM(error.first, error.second) > kVisible_m;
}

double Outer(double panel_height) { return kMapTop + panel_height + kMapBottom; }

// Left of a map: its ticks, and the axis's name.
double MapLeft(const Box& box) {
  const std::size_t digits = box.height_m() < 4 ? 1 : 0;
  const auto width = [&](double y) { return TextWidth(Grouped(y, static_cast<int>(digits)), 11.5); };
  return std::max(46.0, 28 + std::max(width(box.y_low_m), width(box.y_high_m)));
}

std::string RobotClass(std::string_view kind, std::size_t robot) {
  return fmt::format("{} r{}", kind, robot % kRobotColours);
}

std::string Tip(const MapLandmark& landmark) {
  return fmt::format(
      "landmark {} at ({}, {}) m, seen {}, 95% within {} m{}{}{}", landmark.name, Short(landmark.at.x_m),
      Short(landmark.at.y_m), landmark.count == 1 ? "once" : Short(landmark.count, 1) + " times",
      Short(landmark.ellipse.major_m),
      landmark.error_m ? fmt::format(", {} m from the true one", Short(*landmark.error_m)) : "",
      landmark.spurious ? ", no true one near it" : "", landmark.moved);
}

// What lies on a map, cut at its panel's edge.
class MapPainter {
 public:
  MapPainter(const MapFrame& frame, Picture* picture) : frame_(frame), picture_(*picture) {}

  void Cells(const MapCells& cells) {
    picture_.Image(frame_.At(cells.box), cells.raster);
    picture_.Rounds(cells.rounds);
  }

  void Paths(const std::vector<Path>& paths, const std::string& kind) {
    for (const Path& path : paths) DrawPath(path, kind);
  }

  void DrawPath(const Path& path, const std::string& kind) {
    for (const Path& piece : Pieces(path)) {
      if (piece.points.size() == 1)
        picture_.Circle(frame_.At(piece.points[0]), 1.2, RobotClass(kind + "-point", path.index));
      picture_.Polyline(Pixels(piece.points), RobotClass(kind, path.index), piece.time_s);
    }
  }

  void Starts(const std::vector<Path>& paths) {
    for (const Path& path : paths) {
      if (!path.points.empty())
        picture_.Circle(frame_.At(path.points.front()), 5, RobotClass("start", path.index),
                        path.robot + ": start");
    }
  }

  template <class Paint>
  void Layer(const std::string& name, const Paint& paint, bool shown = true) {
    picture_.BeginLayer(name, shown);
    paint();
    picture_.EndLayer();
  }

  void Marks(const std::vector<Path>& marks) {
    for (const Path& path : marks) {
      for (const Point& point : path.points)
        picture_.Circle(frame_.At(point), 2.6, RobotClass("mark", path.index));
    }
  }

  void Truth(const Scene& scene) {
    for (const auto& line : scene.error_lines)
      if (IsVisible(line)) Line(line.first, line.second, "miss");
    for (const Point& point : scene.truth_landmarks)
      picture_.Circle(frame_.At(point), 7, "truth-landmark",
                      fmt::format("true landmark at ({}, {}) m", Short(point.x_m), Short(point.y_m)));
  }

  void Walls(const Scene& scene) {
    for (const auto& [a, b] : scene.truth_walls) Line(a, b, "wall");
  }

  void Edges(const Scene& scene) { picture_.Dots(Pixels(scene.edges), "edge"); }

  void Loops(const Scene& scene) {
    for (const Scene::Loop& loop : scene.loops) {
      if (!loop.used) Line(loop.from, loop.to, "miss");
      picture_.Circle(
          frame_.At(loop.from), 2.4, loop.used ? "loop" : "loop spurious",
          fmt::format("loop at ({}, {}) m, {} m from where it was met before{}", Short(loop.from.x_m),
                      Short(loop.from.y_m), Short(DistanceM(loop.from, loop.to)),
                      loop.used ? "" : "; others contradict it"));
    }
  }

  void Landmarks(const Scene& scene) {
    const double radius = scene.landmarks.size() > kCrowd ? 2 : 3.2;
    for (const MapLandmark& landmark : scene.landmarks) {
      const EllipseM& e = landmark.ellipse;
      const double major = e.major_m * frame_.pixels_per_m(), minor = e.minor_m * frame_.pixels_per_m();
      picture_.Ellipse(frame_.At(landmark.at), major, minor, -e.angle_rad * 180 / std::numbers::pi,
                       "ellipse");
      picture_.Circle(frame_.At(landmark.at), radius, landmark.spurious ? "landmark spurious" : "landmark",
                      Tip(landmark), landmark.name);
    }
  }

  void Moved(const Scene& scene) {
    for (const MapLandmark& landmark : scene.landmarks)
      if (!landmark.moved.empty()) picture_.Circle(frame_.At(landmark.at), 9, "moved", Tip(landmark));
  }

  void Rounds(const Scene& scene) {
    std::vector<std::vector<Point>> rounds;
    for (const std::vector<Point>& round : scene.rounds) rounds.push_back(Pixels(round));
    picture_.Rounds(std::move(rounds), "landmark");
  }

  void Names(const Scene& scene) {
    std::vector<Label> labels;
    for (const std::size_t k : NamedLandmarks(scene)) {
      const MapLandmark& landmark = scene.landmarks[k];
      labels.push_back(
          {frame_.At(landmark.at), landmark.name, TextWidth(landmark.name, 11.5), landmark.count});
    }
    for (const PlacedLabel& name : PlaceLabels(labels, frame_.panel(), kNameHeight, kClearOfNames))
      picture_.Text(name.baseline, labels[name.label].text, "name");
  }

 private:
  std::vector<Point> Pixels(const std::vector<Point>& points) const {
    std::vector<Point> pixels;
    for (const Point& point : points) pixels.push_back(frame_.At(point));
    return pixels;
  }
  void Line(Point from, Point to, const char* classes) {
    picture_.Line(frame_.At(from), frame_.At(to), classes);
  }

  const MapFrame& frame_;
  Picture& picture_;
};

// Below the map, of which it hides nothing.
void DrawScale(const MapFrame& frame, Picture* picture) {
  const double bar_m = RoundBelow(frame.x().length() / 5), width = bar_m * frame.pixels_per_m();
  const double right = frame.panel().right() - 1, left = right - width, y = frame.panel().bottom() + 29;
  picture->Line({left, y}, {right, y}, "scale");
  for (const double end : {left, right}) picture->Line({end, y - 4}, {end, y + 4}, "scale");
  picture->Text({left - 6, y + 4}, Short(bar_m) + " m", "tick end strong");
}

// Axes and scale round what `paint` draws.
template <class Paint>
void DrawMap(const Box& box, const Panel& panel, bool y_name, Picture* picture, const Paint& paint) {
  const MapFrame frame(box, panel);
  DrawAxes(frame,
           {.x = "x [m]",
            .y = y_name ? "y [m]" : "",
            .x_ticks = std::max(2, static_cast<int>(panel.width / 90)),
            .y_ticks = std::max(2, static_cast<int>(panel.height / 60)),
            .x_lines = true},
           picture);
  picture->BeginClip(panel);
  paint(MapPainter(frame, picture));
  picture->EndClip();
  DrawFrame(frame, picture);
  DrawScale(frame, picture);
}

// To two significant digits: "0.034".
std::string TwoDigits(double value) {
  if (!(value > 0)) return "0";
  return Short(value, std::clamp(1 - static_cast<int>(std::floor(std::log10(value))), 0, 12));
}

// Colour and opacity of a share in [0, 1] of the strongest.
void AddStrength(double share, GridColours colours, Raster* raster) {
  constexpr Rgb kWeak{0x6a, 0xa8, 0xe8}, kStrong{0xc2, 0x26, 0x5c};
  raster->Add(colours == GridColours::kTint      ? kTint
              : colours == GridColours::kDensity ? kDensity
                                                 : Mix(kWeak, kStrong, share));
  if (colours == GridColours::kBelief) share = std::min(1.0, 1.15 * share);
  raster->pixels.push_back(static_cast<std::uint8_t>(std::lround(255 * share)));
}

// Of a block's cells; NaN where none is a number.
double LargestIn(const Grid& grid, std::int64_t first_row, std::int64_t first_column, std::int64_t block) {
  double largest = NAN;
  for (std::int64_t y = first_row; y < std::min(grid.rows, first_row + block); ++y) {
    for (std::int64_t x = first_column; x < std::min(grid.columns, first_column + block); ++x) {
      const double p = grid.probability[static_cast<std::size_t>(y * grid.columns + x)];
      if (!(p <= largest) && !std::isnan(p)) largest = p;
    }
  }
  return largest;
}

}  // namespace

Box BoxOf(const Grid& grid) {
  return {grid.origin.x_m, grid.origin.x_m + static_cast<double>(grid.columns) * grid.cell_m, grid.origin.y_m,
          grid.origin.y_m + static_cast<double>(grid.rows) * grid.cell_m};
}

double HighestProbability(const Grid& grid) {
  double highest = 0;
  for (const double p : grid.probability) highest = std::max(highest, p);
  return highest;
}

Raster GridRaster(const Grid& grid, GridColours colours) {
  constexpr std::int64_t kMaxPixels = 1500;
  const std::int64_t block = (std::max(grid.columns, grid.rows) + kMaxPixels - 1) / kMaxPixels;
  const std::int64_t width = (grid.columns + block - 1) / block, height = (grid.rows + block - 1) / block;
  const bool greys = colours == GridColours::kGreys;
  Raster raster{static_cast<std::uint32_t>(width),
                static_cast<std::uint32_t>(height),
                greys ? PngColour::kRgb : PngColour::kRgba,
                {}};
  const double highest = HighestProbability(grid);
  for (std::int64_t row = height - 1; row >= 0; --row) {
    for (std::int64_t column = 0; column < width; ++column) {
      const double largest = LargestIn(grid, row * block, column * block, block);
      if (greys)
        raster.Add(OfProbability(largest));
      else
        AddStrength(largest > 0 ? std::sqrt(largest / highest) : 0, colours, &raster);
    }
  }
  return raster;
}

Picture MapPicture(const Scene& scene, double width, const MapView& view) {
  const Box box = view.round_cells ? view.below->box : BoundsOf(scene, false);
  const double left = MapLeft(box), inner = width - left - kMapRight;
  const double height =
      PanelHeight(box, inner, view.round_cells ? 90 : 0.3 * inner, std::max(view.highest * inner, 460.0));
  Picture picture(width, Outer(height), view.label);
  const Panel panel{left, kMapTop, inner, height};
  DrawMap(box, panel, true, &picture, [&](MapPainter painter) {
    if (view.below) painter.Layer("cells", [&] { painter.Cells(*view.below); });
    for (const auto& [name, cells] : view.instead) painter.Layer(name, [&] { painter.Cells(cells); }, false);
    painter.Layer("true walls", [&] { painter.Walls(scene); });
    painter.Layer("edges", [&] { painter.Edges(scene); });
    painter.Layer("true path", [&] { painter.Paths(scene.truth_paths, "truth-path"); });
    painter.Layer("odometry alone", [&] { painter.Paths(scene.odometry_below, "raw-path"); });
    if (!scene.odometry.empty())
      painter.Layer("odometry alone", [&] { painter.Paths(scene.odometry, "raw-path"); }, false);
    for (const Path& path : scene.paths)
      painter.Layer(RobotTitle(path.robot), [&] { painter.DrawPath(path, "path"); });
    painter.Layer("true landmarks", [&] { painter.Truth(scene); });
    painter.Layer("loops", [&] { painter.Loops(scene); });
    painter.Layer("landmarks", [&] {
      painter.Landmarks(scene);
      painter.Rounds(scene);
    });
    painter.Layer("what moved", [&] { painter.Moved(scene); });
    painter.Layer("names", [&] { painter.Names(scene); });
    painter.Layer("starts", [&] { painter.Starts(scene.paths); });
  });
  if (width >= kBesideFrom) picture.SetMap(MapFrame(box, panel));  // the page has another for a phone
  return picture;
}

std::vector<LegendEntry> LegendOf(const Scene& scene) {
  std::vector<LegendEntry> entries;
  const auto mark = [&](const std::string& text) -> Picture& {
    entries.push_back({Picture(kMarkWidth, kMarkHeight), text});
    return entries.back().mark;
  };
  const auto add_line = [&](std::string_view classes, const std::string& text) {
    entries.push_back(LineEntry(classes, text));
  };
  const auto add_dot = [&](std::string_view classes, double radius, const std::string& text) {
    entries.push_back(DotEntry(classes, radius, text));
  };
  for (const Path& path : scene.paths) add_line(RobotClass("path", path.index), RobotTitle(path.robot));
  if (!scene.paths.empty()) add_dot(RobotClass("start", scene.paths.front().index), 5, "start");
  if (!scene.odometry_below.empty()) add_line("raw-path", "odometry alone");
  if (!scene.landmarks.empty()) {
    Picture& landmark = mark("landmark and its 95% region");
    landmark.Ellipse({13, 7}, 11, 6, 0, "ellipse");
    landmark.Circle({13, 7}, 3.2, "landmark");
  }
  if (!scene.edges.empty())
    mark("edge that traces found occupied").Dots({{5, 7}, {11, 7}, {17, 7}, {22, 7}}, "edge");
  const auto used = [](const Scene::Loop& loop) { return loop.used; };
  if (std::ranges::any_of(scene.loops, used)) add_dot("loop", 2.4, "loop that the path follows");
  if (!std::ranges::all_of(scene.loops, used)) add_line("miss", "loop that others contradict");
  if (!scene.truth_walls.empty()) add_line("wall", "true wall");
  if (!scene.truth_landmarks.empty()) add_dot("truth-landmark", 5.6, "true landmark");
  if (std::ranges::any_of(scene.landmarks, [](const MapLandmark& l) { return !l.moved.empty(); }))
    add_dot("moved", 5.6, "was moved while the log lasted");
  if (std::ranges::any_of(scene.error_lines, IsVisible)) add_line("miss", "error");
  const auto gaps = [](const Path& path) { return !path.breaks.empty(); };
  if (!scene.truth_paths.empty())
    add_line("truth-path",
             std::ranges::any_of(scene.truth_paths, gaps) ? "true path, where it is known" : "true path");
  if (std::ranges::any_of(scene.landmarks, &MapLandmark::spurious))
    add_dot("landmark spurious", 3.2, "spurious landmark");
  return entries;
}

Picture BeforeAfterPicture(const Scene& scene, double width) {
  if (scene.odometry.empty()) return Picture();
  constexpr double kGap = 10, kTitle = 22;
  const bool beside = width >= kBesideFrom;
  const Box box = BoundsOf(scene, true);
  const double left = MapLeft(box), pitch_x = beside ? (width + kGap) / 2 : width + kGap;
  const double inner = pitch_x - kGap - left - kMapRight;
  const double height = PanelHeight(box, inner, 0.45 * inner, 1.28 * inner);
  const double pitch_y = kTitle + Outer(height);
  Picture picture(width, beside ? pitch_y : 2 * pitch_y, "Raw odometry and most likely poses");
  for (const bool mapped : {false, true}) {
    const Panel panel{left + (mapped && beside ? pitch_x : 0),
                      kMapTop + kTitle + (mapped && !beside ? pitch_y : 0), inner, height};
    picture.Text({panel.left, panel.top - kMapTop - 2}, mapped ? "most likely poses" : "raw odometry",
                 "heading");
    DrawMap(box, panel, !mapped || !beside, &picture, [&](MapPainter painter) {
      painter.Paths(mapped ? scene.paths : scene.odometry, "path");
      if (mapped)
        painter.Landmarks(scene);
      else
        painter.Marks(scene.odometry_marks);
      painter.Starts(mapped ? scene.paths : scene.odometry);
    });
  }
  return picture;
}

Picture GridPicture(const Scene& scene, double width) {
  if (!scene.grid) return Picture();
  constexpr double kKey = 80;
  const Box box = BoundsOf(scene, false);
  const double left = MapLeft(box), inner = width - left - kMapRight - kKey;
  const double height = PanelHeight(box, inner, 0.3 * inner, std::max(0.8 * inner, 420.0));
  const double highest = HighestProbability(*scene.grid);
  Picture picture(width, Outer(height), "Probability of a landmark in each cell of the map");
  DrawMap(box, {left, kMapTop, inner, height}, true, &picture,
          [&](MapPainter painter) { painter.Cells({GridRaster(*scene.grid), BoxOf(*scene.grid)}); });
  constexpr int kShades = 128;
  Raster shades{1, kShades, PngColour::kRgba, {}};
  for (int y = 0; y < kShades; ++y) AddStrength(1 - (y + 0.5) / kShades, GridColours::kBelief, &shades);
  const Panel key{left + inner + 18, kMapTop + 10, 16, std::min(height - 20, 260.0)};
  picture.Image(key, std::move(shades));
  picture.Rect(key, "frame");
  // The picture's strength goes with the root of the probability.
  for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0})
    picture.Text({key.right() + 6, key.top + key.height * (1 - share) + 4},
                 TwoDigits(share * share * highest), "tick");
  return picture;
}

}  // namespace cairn::datasets::report
