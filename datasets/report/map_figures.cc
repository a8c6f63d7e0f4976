#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/report/axes.h"
#include "datasets/report/figures.h"
#include "datasets/report/format.h"
#include "datasets/report/grid_picture.h"
#include "datasets/report/svg.h"

namespace cairn::datasets::report {
namespace {

constexpr double kWidth = 1040;
constexpr double kLeft = 46, kRight = 10, kTop = 10, kBottom = 40;
constexpr double kLeastEllipsePixels = 3;  // a smaller one hides behind its landmark's dot

std::string RobotClass(const char* kind, std::size_t robot) {
  return std::string(kind) + " r" + std::to_string(robot % kRobotColours);
}

// With a true minus sign.
std::string TickText(double value) {
  const std::string text = Short(std::abs(value));
  return value < 0 && text != "0" ? "−" + text : text;
}

// To two significant digits: "0.034".
std::string TwoDigits(double value) {
  if (!(value > 0)) return "0";
  return Short(value, std::clamp(1 - static_cast<int>(std::floor(std::log10(value))), 0, 12));
}

std::vector<PointM> ToPixels(const MapFrame& frame, const std::vector<PointM>& points) {
  std::vector<PointM> pixels;
  pixels.reserve(points.size());
  for (const PointM& point : points) pixels.push_back({frame.X(point.x_m), frame.Y(point.y_m)});
  return pixels;
}

class MapCanvas {
 public:
  MapCanvas(Svg& svg, const MapFrame& frame) : svg_(svg), frame_(frame) {}

  void Axes(bool with_y_title) {
    const Panel& p = frame_.panel();
    const Box& box = frame_.box();
    svg_.Rect(p.left, p.top, p.width, p.height, "panel");
    for (const double x : Ticks(box.x_low_m, box.x_high_m, static_cast<int>(p.width / 90))) {
      svg_.Line(frame_.X(x), p.top, frame_.X(x), p.top + p.height, "grid");
      svg_.Text(frame_.X(x), p.top + p.height + 15, TickText(x), "tick middle");
    }
    for (const double y : Ticks(box.y_low_m, box.y_high_m, static_cast<int>(p.height / 60))) {
      svg_.Line(p.left, frame_.Y(y), p.left + p.width, frame_.Y(y), "grid");
      svg_.Text(p.left - 6, frame_.Y(y) + 4, TickText(y), "tick end");
    }
    svg_.Text(p.left + p.width / 2, p.top + p.height + 33, "x [m]", "axis middle");
    if (with_y_title) svg_.VerticalText(p.left - 36, p.top + p.height / 2, "y [m]", "axis middle");
    svg_.BeginClip(p.left, p.top, p.width, p.height);
  }

  // Ends what Axes began, and puts the scale bar on top.
  void Finish() {
    svg_.EndClip();
    const Panel& p = frame_.panel();
    svg_.Rect(p.left, p.top, p.width, p.height, "frame");
    const double bar_m = RoundBelow(frame_.box().width_m() / 5);
    const double width = bar_m * frame_.pixels_per_m();
    const double right = p.left + p.width - 14, y = p.top + p.height - 12;
    svg_.Rect(right - width - 8, y - 22, width + 16, 30, "plate");
    svg_.Line(right - width, y, right, y, "scale");
    svg_.Line(right - width, y - 4, right - width, y + 4, "scale");
    svg_.Line(right, y - 4, right, y + 4, "scale");
    svg_.Text(right - width / 2, y - 7, Short(bar_m) + " m", "tick middle strong");
  }

  void Paths(const std::vector<Path>& paths, const char* kind) {
    for (const Path& path : paths) svg_.Polyline(ToPixels(frame_, path.points), RobotClass(kind, path.index));
  }

  void Starts(const std::vector<Path>& paths) {
    for (const Path& path : paths) {
      if (path.points.empty()) continue;
      const PointM at = path.points.front();
      svg_.Circle(frame_.X(at.x_m), frame_.Y(at.y_m), 5, RobotClass("start", path.index),
                  path.robot + ": start");
    }
  }

  void Marks(const std::vector<Path>& marks) {
    for (const Path& path : marks) {
      for (const PointM& at : path.points) {
        svg_.Circle(frame_.X(at.x_m), frame_.Y(at.y_m), 2.6, RobotClass("mark", path.index));
      }
    }
  }

  void Truth(const Scene& scene) {
    for (const auto& [ours, theirs] : scene.error_lines) {
      svg_.Line(frame_.X(ours.x_m), frame_.Y(ours.y_m), frame_.X(theirs.x_m), frame_.Y(theirs.y_m), "miss");
    }
    for (const PointM& at : scene.truth_landmarks) {
      svg_.Circle(frame_.X(at.x_m), frame_.Y(at.y_m), 7, "truth-landmark");
    }
  }

  void Landmarks(const Scene& scene, bool with_names) {
    for (const MapLandmark& landmark : scene.landmarks) {
      const double x = frame_.X(landmark.at.x_m), y = frame_.Y(landmark.at.y_m);
      const EllipseM& e = landmark.ellipse;
      const double major = e.major_m * frame_.pixels_per_m(), minor = e.minor_m * frame_.pixels_per_m();
      if (major >= kLeastEllipsePixels) {
        svg_.Ellipse(x, y, major, std::max(minor, 0.5), -e.angle_rad * 180 / std::numbers::pi, "ellipse");
      }
      svg_.Circle(x, y, 3.2, landmark.spurious ? "landmark spurious" : "landmark", Tip(landmark));
      if (with_names) svg_.Text(x + 8, y - 7, landmark.name, "name");
    }
  }

  void Probability(const Grid& grid, const std::string& png) {
    const double width = static_cast<double>(grid.columns) * grid.cell_m * frame_.pixels_per_m();
    const double height = static_cast<double>(grid.rows) * grid.cell_m * frame_.pixels_per_m();
    const double top_m = grid.origin.y_m + static_cast<double>(grid.rows) * grid.cell_m;
    svg_.Image(frame_.X(grid.origin.x_m), frame_.Y(top_m), width, height, png);
  }

 private:
  static std::string Tip(const MapLandmark& landmark) {
    std::string tip = "landmark " + landmark.name + " at (" + Short(landmark.at.x_m) + ", " +
                      Short(landmark.at.y_m) + ") m, seen " + Short(landmark.count, 1) +
                      " times, 95% within " + Short(landmark.ellipse.major_m) + " m";
    if (landmark.error_m) tip += ", " + Short(*landmark.error_m) + " m from the true one";
    if (landmark.spurious) tip += ", no true one near it";
    return tip;
  }

  Svg& svg_;
  const MapFrame& frame_;
};

double Outer(double panel_height) { return kTop + panel_height + kBottom; }

}  // namespace

std::string MapFigure(const Scene& scene) {
  const Box box = BoundsOf(scene, false);
  const double width = kWidth - kLeft - kRight;
  const double height = PanelHeight(box, width, 300, 860);
  Svg svg(kWidth, Outer(height), "Landmark map with the robots' paths");
  const MapFrame frame(box, {kLeft, kTop, width, height});
  MapCanvas canvas(svg, frame);
  canvas.Axes(true);
  canvas.Paths(scene.truth_paths, "truth-path");
  canvas.Paths(scene.paths, "path");
  canvas.Truth(scene);
  canvas.Landmarks(scene, true);
  canvas.Starts(scene.paths);
  canvas.Finish();
  return svg.Finish();
}

std::string BeforeAfterFigure(const Scene& scene) {
  if (scene.odometry.empty()) return {};
  constexpr double kGap = 44;
  const Box box = BoundsOf(scene, true);
  const double width = (kWidth - kLeft - kRight - kGap) / 2;
  const double height = PanelHeight(box, width, 220, 620);
  constexpr double kTitle = 22;
  Svg svg(kWidth, kTitle + Outer(height), "Raw odometry and corrected paths side by side");
  for (const bool corrected : {false, true}) {
    const double left = kLeft + (corrected ? width + kGap : 0);
    const MapFrame frame(box, {left, kTop + kTitle, width, height});
    svg.Text(left, kTitle - 2, corrected ? "corrected: most likely poses" : "raw odometry", "heading");
    MapCanvas canvas(svg, frame);
    canvas.Axes(!corrected);
    canvas.Paths(corrected ? scene.paths : scene.odometry, "path");
    if (corrected)
      canvas.Landmarks(scene, false);
    else
      canvas.Marks(scene.odometry_marks);
    canvas.Starts(corrected ? scene.paths : scene.odometry);
    canvas.Finish();
  }
  return svg.Finish();
}

std::string GridFigure(const Scene& scene) {
  if (!scene.grid) return {};
  constexpr double kKey = 90;
  const Box box = BoundsOf(scene, false);
  const double width = kWidth - kLeft - kRight - kKey;
  const double height = PanelHeight(box, width, 260, 720);
  Svg svg(kWidth, Outer(height), "Probability of a landmark in each cell of the map");
  const MapFrame frame(box, {kLeft, kTop, width, height});
  const double highest = HighestProbability(*scene.grid);
  MapCanvas canvas(svg, frame);
  canvas.Axes(true);
  canvas.Probability(*scene.grid, GridPng(*scene.grid, highest));
  canvas.Finish();
  const double x = kLeft + width + 18, y = kTop + 10, key_height = std::min(height - 20, 260.0);
  svg.Image(x, y, 16, key_height, KeyPng(128));
  svg.Rect(x, y, 16, key_height, "frame");
  // The picture's strength goes with the root of the probability.
  for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const double probability = share * share * highest;
    svg.Text(x + 22, y + key_height * (1 - share) + 4, TwoDigits(probability), "tick");
  }
  return svg.Finish();
}

}  // namespace cairn::datasets::report
