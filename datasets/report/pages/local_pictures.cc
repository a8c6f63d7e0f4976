#include "datasets/report/pages/local_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/report/drawing/format.h"

namespace cairn::datasets::report {
namespace {

constexpr double kPictureMargin = 24;
constexpr Rgb kShade{70, 84, 104};
constexpr float kOccupied = 0.05F;  // hits a scan from which on a cell is drawn as occupied

// A segment of `length` pixels about a point, at an angle of the world (y up).
void Stroke(Picture* picture, Point at, double angle_rad, double length, std::string_view classes) {
  const double dx = length / 2 * std::cos(angle_rad), dy = -length / 2 * std::sin(angle_rad);
  picture->Line({at.x_m - dx, at.y_m - dy}, {at.x_m + dx, at.y_m + dy}, classes);
}

void DrawHistogram(const LocalSnapshot& shot, const Panel& panel, Picture* picture) {
  const double most = *std::ranges::max_element(shot.histogram);
  const auto sectors = static_cast<double>(shot.histogram.size());
  const double pitch = panel.width / sectors;
  double sin = 0, cos = 0;
  for (std::size_t k = 0; k < shot.histogram.size(); ++k) {
    const double left = panel.left + static_cast<double>(k) * pitch;
    const double high = most > 0 ? shot.histogram[k] / most * panel.height : 0;
    picture->Rect({left + 3, panel.bottom() - high, pitch - 6, high}, "bar");
    const double angle = 2 * std::numbers::pi * static_cast<double>(k) / sectors;  // modulo a quarter turn
    sin += shot.histogram[k] * std::sin(angle);
    cos += shot.histogram[k] * std::cos(angle);
    picture->Text({left + pitch / 2, panel.bottom() + 16},
                  Short(90 * static_cast<double>(k) / sectors, 1) + "°", "tick middle");
  }
  picture->Line({panel.left, panel.bottom()}, {panel.right(), panel.bottom()}, "scale");
  if (most <= 0) return;
  double peak = std::atan2(sin, cos) / (2 * std::numbers::pi);
  if (peak < 0) peak += 1;
  picture->Circle({panel.left + std::fmod(peak + 0.5 / sectors, 1.0) * panel.width, panel.top - 8}, 5,
                  "spurious");
}

// The box of a trace in its own frame.
struct Interval {
  double low_z = 0, high_z = 0, side_m = 1;
};
Interval SpanOf(const LocalTrace& trace) {
  Interval span{trace.Z(0), trace.Z(trace.features.empty() ? 0 : trace.features.size() - 1), 1};
  constexpr double kWidest_m = 20;  // what is farther off is cut
  for (const LocalFeature& feature : trace.features) {
    for (const LocalSide* side : {&feature.left, &feature.right})
      if (side->HasEdge())
        span.side_m = std::clamp(side->distance_high_m + 0.3, span.side_m, std::max(span.side_m, kWidest_m));
  }
  return span;
}

// Where z and u of a trace lie in a picture: z from left to right, u upwards.
struct Strip {
  double left = 0, middle = 0, low_z = 0, per_m = 50;
  Point At(double z_m, double u_m) const { return {left + (z_m - low_z) * per_m, middle - u_m * per_m}; }
};

// `kind`: trace, or recorded, of one beneath another.
void DrawSide(const LocalTrace& trace, std::size_t feature, const LocalSide& side, double sign,
              const Strip& strip, std::string_view kind, Picture* picture) {
  if (!side.HasEdge()) return;
  const double z = trace.Z(feature);
  const Point low = strip.At(z, sign * side.distance_low_m), high = strip.At(z, sign * side.distance_high_m);
  picture->Line(low, high, fmt::format("{}{}", kind, side.occupied ? " occupied" : ""));
  for (const Point& end : {low, high}) picture->Circle(end, side.occupied ? 2 : 1, kind);
  // "Only large intervals of edge orientation are shown" (figure 3).
  if (side.angle_high_rad - side.angle_low_rad < std::numbers::pi / 8) return;
  const Point middle{low.x_m, (low.y_m + high.y_m) / 2};
  for (const double angle : {side.angle_low_rad, side.angle_high_rad})
    Stroke(picture, middle, angle, 0.3 * strip.per_m, "miss");
}

void DrawTrace(const LocalTrace& trace, const Strip& strip, std::string_view kind, Picture* picture) {
  const Interval span = SpanOf(trace);
  picture->Line(strip.At(span.low_z, 0), strip.At(span.high_z, 0), kind);
  for (std::size_t f = 0; f < trace.features.size(); ++f) {
    DrawSide(trace, f, trace.features[f].left, 1, strip, kind, picture);
    DrawSide(trace, f, trace.features[f].right, -1, strip, kind, picture);
  }
}

void DrawMetre(double per_m, Point at, Picture* picture) {
  picture->Line(at, {at.x_m + per_m, at.y_m}, "scale");
  picture->Text({at.x_m + per_m + 6, at.y_m + 4}, "1 m", "tick strong");
}

// The immediate trace of a snapshot: on each side of each row the nearest edge, and the nearest occupied
// cell.
struct Nearest {
  double edge_m = HUGE_VAL, edge_rad = 0, occupied_m = HUGE_VAL;
};

void DrawImmediate(const Superposed& shown, const Strip& strip, Picture* picture) {
  const LocalSnapshot& shot = shown.shot;
  const auto half_cells = shot.cells / 2;
  const auto half = static_cast<double>(half_cells) * shot.cell_m;
  const auto rows = static_cast<std::size_t>(shot.cells);
  std::vector<Nearest> left(rows), right(rows);
  const double c = std::cos(shown.turn_rad), s = std::sin(shown.turn_rad);
  for (std::int64_t row = 0; row < shot.cells; ++row) {
    for (std::int64_t column = 0; column < shot.cells; ++column) {
      const Point at = shot.Centre(column, row);
      const double z = c * at.x_m - s * at.y_m, u = s * at.x_m + c * at.y_m;
      const auto slice = std::lround((z + half) / shot.cell_m);
      if (slice < 0 || slice >= shot.cells || std::abs(u) < shot.cell_m / 2) continue;
      Nearest& side = (u > 0 ? left : right)[static_cast<std::size_t>(slice)];
      const std::size_t i = shot.Index(column, row);
      if (!std::isnan(shot.edge_rad[i]) && std::abs(u) < side.edge_m) {
        side.edge_m = std::abs(u);
        side.edge_rad = shot.edge_rad[i] + shown.turn_rad;
      }
      if (shot.occupancy[i] > kOccupied) side.occupied_m = std::min(side.occupied_m, std::abs(u));
    }
  }
  for (std::size_t slice = 0; slice < rows; ++slice) {
    const double z = shown.z_m + static_cast<double>(slice) * shot.cell_m - half;
    for (const double sign : {1.0, -1.0}) {
      const Nearest& side = (sign > 0 ? left : right)[slice];
      if (side.edge_m < HUGE_VAL)
        Stroke(picture, strip.At(z, shown.u_m + sign * side.edge_m), side.edge_rad, shot.cell_m * strip.per_m,
               "scale");
      else if (side.occupied_m < HUGE_VAL)
        picture->Circle(strip.At(z, shown.u_m + sign * side.occupied_m), 2.5, "landmark");
    }
  }
  const Point robot = strip.At(shown.z_m, shown.u_m);
  picture->Line({robot.x_m - 7, robot.y_m}, {robot.x_m + 7, robot.y_m}, "miss");
  picture->Line({robot.x_m, robot.y_m - 7}, {robot.x_m, robot.y_m + 7}, "miss");
  const double frame = half * strip.per_m;
  picture->Rect({robot.x_m - frame, robot.y_m - frame, 2 * frame, 2 * frame}, "frame");
}

std::size_t EdgesOf(const LocalSnapshot& shot) {
  return static_cast<std::size_t>(
      std::ranges::count_if(shot.edge_rad, [](float e) { return !std::isnan(e); }));
}

std::optional<Superposed> Superpose(const LocalResult& result, const LocalSnapshot& shot,
                                    const Track& odometry) {
  const auto pose = PoseAt(result.paths.at(shot.robot), shot.time_s, HUGE_VAL),
             reckoned = PoseAt(odometry, shot.time_s, HUGE_VAL);
  if (!pose || !reckoned) return std::nullopt;
  constexpr double kRecentS = 2, kNowS = 0.3;
  std::optional<Superposed> best;
  std::vector<bool> corrected(result.traces.size(), false);
  for (const LocalPosition& at : result.positions.at(shot.robot)) {
    if (at.time_s > shot.time_s || at.time_s < shot.time_s - kRecentS) continue;
    const LocalTrace& trace = result.traces[at.trace];
    if (at.corrected) corrected[at.trace] = true;
    if (!corrected[at.trace] || at.time_s < shot.time_s - kNowS) continue;
    if (trace.last_s > shot.time_s - 10) continue;  // the one that is being recorded, or just was
    const bool same = best && best->trace.first_s == trace.first_s;
    if (best && !same && trace.features.size() <= best->trace.features.size()) continue;
    const double turn =
        (pose->heading_rad - trace.frame.heading_rad) - (reckoned->heading_rad - shot.frame_rad);
    constexpr double kQuarter = std::numbers::pi / 2;
    best = Superposed{shot, trace, at.z_m, at.u_m, std::round(turn / kQuarter) * kQuarter};
  }
  return best;
}

}  // namespace

Picture LocalGridPicture(const LocalSnapshot& shot) {
  const double pixel = std::max(6.0, std::floor(620.0 / static_cast<double>(shot.cells))),
               edge = pixel * static_cast<double>(shot.cells), histogram = 110;
  Picture picture(edge + 2 * kPictureMargin, edge + histogram + 4 * kPictureMargin, "Local grids");
  const Panel panel{kPictureMargin, kPictureMargin, edge, edge};
  const double half_m = 0.5 * shot.cell_m * static_cast<double>(shot.cells);
  const MapFrame frame({-half_m, half_m, -half_m, half_m}, panel);
  const float most = *std::ranges::max_element(shot.occupancy);
  Raster hits{
      static_cast<std::uint32_t>(shot.cells), static_cast<std::uint32_t>(shot.cells), PngColour::kRgba, {}};
  for (std::int64_t row = shot.cells - 1; row >= 0; --row) {
    for (std::int64_t column = 0; column < shot.cells; ++column) {
      hits.Add(kShade);
      const double share = most > 0 ? std::sqrt(shot.occupancy[shot.Index(column, row)] / most) : 0;
      hits.pixels.push_back(static_cast<std::uint8_t>(std::lround(191 * std::clamp(share, 0.0, 1.0))));
    }
  }
  picture.Image(panel, std::move(hits));
  for (std::int64_t row = 0; row < shot.cells; ++row) {
    for (std::int64_t column = 0; column < shot.cells; ++column) {
      const float angle = shot.edge_rad[shot.Index(column, row)];
      if (!std::isnan(angle))
        Stroke(&picture, frame.At(shot.Centre(column, row)), angle, 0.8 * pixel, "curve");
    }
  }
  for (const LocalEdge& line : shot.edges) picture.Line(frame.At(line.a), frame.At(line.b), "sensed");
  constexpr double kRobotRadiusM = 0.25;
  picture.Circle(frame.At(Point{}), kRobotRadiusM * frame.pixels_per_m(), "ring");
  picture.Rect(panel, "frame");
  DrawMetre(frame.pixels_per_m(), {kPictureMargin, kPictureMargin - 10}, &picture);
  DrawHistogram(shot, {kPictureMargin, edge + 2.5 * kPictureMargin, edge, histogram}, &picture);
  return picture;
}

Picture TracePicture(const LocalTrace& trace) {
  const Interval span = SpanOf(trace);
  const double length_m = std::max(span.high_z - span.low_z, 1.0);
  const double per_m = std::clamp(1000 / length_m, 30.0, 120.0), height = 2 * span.side_m * per_m;
  Picture picture(length_m * per_m + 2 * kPictureMargin, height + 3 * kPictureMargin, "An edge trace");
  DrawTrace(trace, {kPictureMargin, kPictureMargin + height / 2, span.low_z, per_m}, "trace", &picture);
  DrawMetre(per_m, {kPictureMargin, height + 2 * kPictureMargin}, &picture);
  return picture;
}

std::vector<Superposed> Superpositions(const LocalResult& result, const std::vector<Track>& odometry) {
  std::vector<Superposed> shown;
  for (const LocalSnapshot& shot : result.snapshots) {
    if (auto one = Superpose(result, shot, odometry.at(shot.robot))) shown.push_back(std::move(*one));
  }
  std::ranges::stable_sort(shown, std::greater<>{}, [](const Superposed& s) { return EdgesOf(s.shot); });
  constexpr std::size_t kMost = 2;
  if (shown.size() > kMost) shown.erase(shown.begin() + kMost, shown.end());
  return shown;
}

Picture SuperposedPicture(const std::vector<Superposed>& shown) {
  constexpr double kPerM = 90;
  Picture drawn;
  double top = kPictureMargin, width = 0;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const Superposed& one = shown[i];
    const Interval span = SpanOf(one.trace);
    const auto half_cells = one.shot.cells / 2 + 1;
    const double half = static_cast<double>(half_cells) * one.shot.cell_m;
    const double low = std::min(span.low_z, one.z_m - half), high = std::max(span.high_z, one.z_m + half),
                 height = 2 * std::max(span.side_m, half + std::abs(one.u_m)) * kPerM;
    const Strip strip{kPictureMargin, top + height / 2, low, kPerM};
    DrawTrace(one.trace, strip, "recorded", &drawn);
    DrawImmediate(one, strip, &drawn);
    drawn.Text({kPictureMargin, top + 14},
               fmt::format("({}) at {} s", static_cast<char>('a' + i), Short(one.shot.time_s, 0)), "heading");
    top += height + kPictureMargin;
    width = std::max(width, (high - low) * kPerM);
  }
  DrawMetre(kPerM, {kPictureMargin, top + 0.2 * kPictureMargin}, &drawn);
  Picture picture(width + 2 * kPictureMargin, top + kPictureMargin, "Immediate traces on recorded ones");
  picture.Add(drawn, {0, 0});
  return picture;
}

}  // namespace cairn::datasets::report
