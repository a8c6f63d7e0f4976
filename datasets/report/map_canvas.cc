#include "datasets/report/map_canvas.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/report/drawing/format.h"
#include "datasets/report/drawing/labels.h"
#include "datasets/report/drawing/palette.h"

namespace cairn::datasets::report {
namespace {

constexpr double kLeastEllipsePixels = 3;  // a smaller one hides behind its landmark's dot
constexpr std::size_t kCrowd = 100;        // of landmarks, whose dots are small
constexpr double kNameHeight = 9, kNamePerLetter = 6.9, kClearOfNames = 4.2;

std::string RobotClass(const char* kind, std::size_t robot) {
  return std::string(kind) + " r" + std::to_string(robot % kRobotColours);
}

// With a true minus sign.
std::string TickText(double value) {
  const std::string text = Short(std::abs(value));
  return value < 0 && text != "0" ? "−" + text : text;
}

std::string Tip(const MapLandmark& landmark) {
  std::string tip = "landmark " + landmark.name + " at (" + Short(landmark.at.x_m) + ", " +
                    Short(landmark.at.y_m) + ") m, seen " + Short(landmark.count, 1) + " times, 95% within " +
                    Short(landmark.ellipse.major_m) + " m";
  if (landmark.error_m) tip += ", " + Short(*landmark.error_m) + " m from the true one";
  if (landmark.spurious) tip += ", no true one near it";
  return tip;
}

// Letters, not bytes.
double WidthOf(const std::string& text) {
  const auto letters =
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
  return kNamePerLetter * static_cast<double>(letters);
}

}  // namespace

void MapCanvas::Axes(bool with_y_title) {
  const Panel& p = frame_.panel();
  const Box& box = frame_.box();
  svg_.Rect(p.left, p.top, p.width, p.height, "panel");
  for (const double x : Ticks(box.x_low_m, box.x_high_m, std::max(2, static_cast<int>(p.width / 90)))) {
    svg_.Line(frame_.X(x), p.top, frame_.X(x), p.top + p.height, "grid");
    svg_.Text(frame_.X(x), p.top + p.height + 15, TickText(x), "tick middle");
  }
  for (const double y : Ticks(box.y_low_m, box.y_high_m, std::max(2, static_cast<int>(p.height / 60)))) {
    svg_.Line(p.left, frame_.Y(y), p.left + p.width, frame_.Y(y), "grid");
    svg_.Text(p.left - 6, frame_.Y(y) + 4, TickText(y), "tick end");
  }
  svg_.Text(p.left + p.width / 2, p.top + p.height + 33, "x [m]", "axis middle");
  if (with_y_title) svg_.VerticalText(p.left - 36, p.top + p.height / 2, "y [m]", "axis middle");
  svg_.BeginClip(p.left, p.top, p.width, p.height);
}

void MapCanvas::Finish() {
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

void MapCanvas::Image(const Box& box, std::string_view png) {
  svg_.Image(frame_.X(box.x_low_m), frame_.Y(box.y_high_m), box.width_m() * frame_.pixels_per_m(),
             box.height_m() * frame_.pixels_per_m(), png);
}

void MapCanvas::Paths(const std::vector<Path>& paths, const char* kind) {
  for (const Path& path : paths) {
    for (const std::vector<Point>& piece : Pieces(path)) {
      std::vector<Point> pixels;
      for (const Point& point : piece) pixels.push_back(At(point));
      svg_.Polyline(pixels, RobotClass(kind, path.index));
      if (pixels.size() == 1)
        svg_.Circle(pixels[0].x_m, pixels[0].y_m, 1.2,
                    RobotClass((std::string(kind) + "-point").c_str(), path.index));
    }
  }
}

void MapCanvas::Starts(const std::vector<Path>& paths) {
  for (const Path& path : paths) {
    if (path.points.empty()) continue;
    const Point at = At(path.points.front());
    svg_.Circle(at.x_m, at.y_m, 5, RobotClass("start", path.index), path.robot + ": start");
  }
}

void MapCanvas::Marks(const std::vector<Path>& marks) {
  for (const Path& path : marks) {
    for (const Point& point : path.points) {
      const Point at = At(point);
      svg_.Circle(at.x_m, at.y_m, 2.6, RobotClass("mark", path.index));
    }
  }
}

void MapCanvas::Line(Point from, Point to, const char* style_class) {
  const Point a = At(from), b = At(to);
  svg_.Line(a.x_m, a.y_m, b.x_m, b.y_m, style_class);
}

void MapCanvas::Truth(const Scene& scene) {
  for (const auto& [ours, theirs] : scene.error_lines) Line(ours, theirs, "miss");
  for (const Point& point : scene.truth_landmarks) {
    const Point at = At(point);
    svg_.Circle(at.x_m, at.y_m, 7, "truth-landmark");
  }
}

void MapCanvas::Walls(const Scene& scene) {
  for (const auto& [a, b] : scene.truth_walls) Line(a, b, "wall");
  std::vector<Point> pixels;
  for (const Point& point : scene.edges) pixels.push_back(At(point));
  svg_.Dots(pixels, "edge");
}

void MapCanvas::Loops(const Scene& scene) {
  for (const Scene::Loop& loop : scene.loops) {
    const Point at = At(loop.from);
    if (!loop.used) Line(loop.from, loop.to, "miss");
    svg_.Circle(at.x_m, at.y_m, 2.4, loop.used ? "loop" : "loop spurious");
  }
}

void MapCanvas::Landmarks(const Scene& scene, bool with_names) {
  const double radius = scene.landmarks.size() > kCrowd ? 2 : 3.2;
  for (const MapLandmark& landmark : scene.landmarks) {
    const Point at = At(landmark.at);
    const EllipseM& e = landmark.ellipse;
    const double major = e.major_m * frame_.pixels_per_m(), minor = e.minor_m * frame_.pixels_per_m();
    if (major >= kLeastEllipsePixels) {
      svg_.Ellipse(at.x_m, at.y_m, major, std::max(minor, 0.5), -e.angle_rad * 180 / std::numbers::pi,
                   "ellipse");
    }
    svg_.Circle(at.x_m, at.y_m, radius, landmark.spurious ? "landmark spurious" : "landmark", Tip(landmark));
  }
  if (with_names) Names(scene);
}

void MapCanvas::Names(const Scene& scene) {
  std::vector<Label> labels;
  for (const std::size_t k : NamedLandmarks(scene)) {
    const MapLandmark& landmark = scene.landmarks[k];
    labels.push_back({At(landmark.at), landmark.name, WidthOf(landmark.name), landmark.count});
  }
  for (const PlacedLabel& name : PlaceLabels(labels, frame_.panel(), kNameHeight, kClearOfNames))
    svg_.Text(name.baseline.x_m, name.baseline.y_m, labels[name.label].text, "name");
}

}  // namespace cairn::datasets::report
