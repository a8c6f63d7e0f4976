#include "datasets/report/pages/local_pictures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/report/drawing/axes.h"
#include "datasets/report/drawing/canvas.h"
#include "datasets/report/drawing/format.h"

namespace cairn::datasets::report {
namespace {

constexpr Rgb kPlotPaper{255, 255, 255}, kPlotInk{30, 34, 40}, kPale{176, 182, 190};
constexpr Rgb kEdge{198, 70, 40}, kAlong{38, 104, 178};
constexpr double kPictureMargin = 24;
constexpr float kOccupied = 0.05F;  // hits a scan from which on a cell is drawn as occupied

// A segment of `length` pixels about a point, at an angle of the world (y up).
void Stroke(Canvas* canvas, Point at, double angle_rad, double length, Rgb colour, double width) {
  const double dx = length / 2 * std::cos(angle_rad), dy = -length / 2 * std::sin(angle_rad);
  canvas->Line({at.x_m - dx, at.y_m - dy}, {at.x_m + dx, at.y_m + dy}, colour, width);
}

Rgb Shade(double share) {
  const double s = std::clamp(share, 0.0, 1.0);
  const auto mix = [&](int white, int dark) {
    return static_cast<int>(std::lround(white + s * (dark - white)));
  };
  return {mix(255, 70), mix(255, 84), mix(255, 104)};
}

void DrawHistogram(const LocalSnapshot& shot, double left, double top, double width, double height,
                   Canvas* canvas) {
  const double most = *std::ranges::max_element(shot.histogram);
  const auto sectors = static_cast<double>(shot.histogram.size());
  double sin = 0, cos = 0;
  for (std::size_t k = 0; k < shot.histogram.size(); ++k) {
    const double at = left + static_cast<double>(k) * width / sectors;
    const double high = most > 0 ? shot.histogram[k] / most * height : 0;
    canvas->Fill({at + 3, top + height - high}, {at + width / sectors - 3, top + height}, kPale);
    const double angle = 2 * std::numbers::pi * static_cast<double>(k) / sectors;  // modulo a quarter turn
    sin += shot.histogram[k] * std::sin(angle);
    cos += shot.histogram[k] * std::cos(angle);
    canvas->Text({at + width / sectors / 2, top + height + 16},
                 Short(90 * static_cast<double>(k) / sectors, 1), kPlotInk, 11, Align::kMiddle);
  }
  canvas->Line({left, top + height}, {left + width, top + height}, kPlotInk, 1);
  if (most <= 0) return;
  double peak = std::atan2(sin, cos) / (2 * std::numbers::pi);
  if (peak < 0) peak += 1;
  canvas->Dot({left + std::fmod((peak + 0.5 / sectors), 1.0) * width, top - 8}, 5, kEdge);
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

void DrawSide(const LocalTrace& trace, std::size_t feature, const LocalSide& side, double sign,
              const Strip& strip, Rgb colour, Canvas* canvas) {
  if (!side.HasEdge()) return;
  const double z = trace.Z(feature);
  const Point low = strip.At(z, sign * side.distance_low_m), high = strip.At(z, sign * side.distance_high_m);
  canvas->Line(low, high, colour, side.occupied ? 2 : 1);
  canvas->Dot(low, side.occupied ? 2.6 : 1.7, colour);
  canvas->Dot(high, side.occupied ? 2.6 : 1.7, colour);
  // "Only large intervals of edge orientation are shown" (figure 3).
  if (side.angle_high_rad - side.angle_low_rad < std::numbers::pi / 8) return;
  const Point middle{low.x_m, (low.y_m + high.y_m) / 2};
  for (const double angle : {side.angle_low_rad, side.angle_high_rad})
    Stroke(canvas, middle, angle, 0.3 * strip.per_m, kEdge, 1.4);
}

void DrawTrace(const LocalTrace& trace, const Strip& strip, Rgb colour, Canvas* canvas) {
  const Interval span = SpanOf(trace);
  canvas->Line(strip.At(span.low_z, 0), strip.At(span.high_z, 0), colour, 1.2);
  for (std::size_t f = 0; f < trace.features.size(); ++f) {
    DrawSide(trace, f, trace.features[f].left, 1, strip, colour, canvas);
    DrawSide(trace, f, trace.features[f].right, -1, strip, colour, canvas);
  }
}

void DrawScale(const Strip& strip, Point at, Canvas* canvas) {
  canvas->Line(at, {at.x_m + strip.per_m, at.y_m}, kPlotInk, 2);
  canvas->Text({at.x_m + strip.per_m + 6, at.y_m + 4}, "1 m", kPlotInk, 12);
}

// The immediate trace of a snapshot: on each side of each row the nearest edge, and the nearest occupied
// cell.
struct Nearest {
  double edge_m = HUGE_VAL, edge_rad = 0, occupied_m = HUGE_VAL;
};

void DrawImmediate(const Superposed& shown, const Strip& strip, Canvas* canvas) {
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
        Stroke(canvas, strip.At(z, shown.u_m + sign * side.edge_m), side.edge_rad, shot.cell_m * strip.per_m,
               kPlotInk, 2);
      else if (side.occupied_m < HUGE_VAL)
        canvas->Dot(strip.At(z, shown.u_m + sign * side.occupied_m), 3, kPlotInk);
    }
  }
  const Point robot = strip.At(shown.z_m, shown.u_m);
  canvas->Line({robot.x_m - 7, robot.y_m}, {robot.x_m + 7, robot.y_m}, kEdge, 2);
  canvas->Line({robot.x_m, robot.y_m - 7}, {robot.x_m, robot.y_m + 7}, kEdge, 2);
  const double frame = half * strip.per_m;
  canvas->Frame({robot.x_m - frame, robot.y_m - frame}, {robot.x_m + frame, robot.y_m + frame}, kPale, 1);
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

std::string LocalGridPng(const LocalSnapshot& shot) {
  const double pixel = std::max(6.0, std::floor(620.0 / static_cast<double>(shot.cells)));
  const double edge = pixel * static_cast<double>(shot.cells);
  const double histogram = 110;
  Canvas canvas(static_cast<int>(edge + 2 * kPictureMargin),
                static_cast<int>(edge + histogram + 4 * kPictureMargin), kPlotPaper);
  const double per_m = pixel / shot.cell_m, middle_x = kPictureMargin + edge / 2,
               middle_y = kPictureMargin + edge / 2;
  const auto at = [&](Point p) { return Point{middle_x + p.x_m * per_m, middle_y - p.y_m * per_m}; };
  const float most = *std::ranges::max_element(shot.occupancy);
  for (std::int64_t row = 0; row < shot.cells; ++row) {
    for (std::int64_t column = 0; column < shot.cells; ++column) {
      const Point centre = at(shot.Centre(column, row));
      const std::size_t i = shot.Index(column, row);
      const double share = most > 0 ? std::sqrt(shot.occupancy[i] / most) : 0;
      if (share > 0.02)
        canvas.Fill({centre.x_m - pixel / 2, centre.y_m - pixel / 2},
                    {centre.x_m + pixel / 2, centre.y_m + pixel / 2}, Shade(0.75 * share));
      if (!std::isnan(shot.edge_rad[i])) Stroke(&canvas, centre, shot.edge_rad[i], 0.8 * pixel, kAlong, 2);
    }
  }
  for (const LocalEdge& line : shot.edges) canvas.Line(at(line.a), at(line.b), kEdge, 4);
  constexpr double kRobotRadiusM = 0.25;
  canvas.Ring({middle_x, middle_y}, kRobotRadiusM * per_m, kPlotInk, 2);
  canvas.Frame({kPictureMargin, kPictureMargin}, {kPictureMargin + edge, kPictureMargin + edge}, kPale, 1);
  DrawScale({0, 0, 0, per_m}, {kPictureMargin, kPictureMargin - 10}, &canvas);
  DrawHistogram(shot, kPictureMargin, edge + 2.5 * kPictureMargin, edge, histogram, &canvas);
  return canvas.Png();
}

std::string TracePng(const LocalTrace& trace) {
  const Interval span = SpanOf(trace);
  const double length_m = std::max(span.high_z - span.low_z, 1.0);
  const double per_m = std::clamp(1300 / length_m, 30.0, 120.0);
  const double height = 2 * span.side_m * per_m;
  Canvas canvas(static_cast<int>(length_m * per_m + 2 * kPictureMargin),
                static_cast<int>(height + 3 * kPictureMargin), kPlotPaper);
  const Strip strip{kPictureMargin, kPictureMargin + height / 2, span.low_z, per_m};
  DrawTrace(trace, strip, kPlotInk, &canvas);
  DrawScale(strip, {kPictureMargin, height + 2 * kPictureMargin}, &canvas);
  return canvas.Png();
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

std::string SuperposedPng(const std::vector<Superposed>& shown) {
  constexpr double kPerM = 90;
  double width = 0, height = 0;
  std::vector<std::pair<double, double>> sizes;  // low z, height
  for (const Superposed& one : shown) {
    const Interval span = SpanOf(one.trace);
    const auto half_cells = one.shot.cells / 2 + 1;
    const double half = static_cast<double>(half_cells) * one.shot.cell_m;
    const double low = std::min(span.low_z, one.z_m - half), high = std::max(span.high_z, one.z_m + half);
    sizes.emplace_back(low, 2 * std::max(span.side_m, half + std::abs(one.u_m)) * kPerM);
    width = std::max(width, (high - low) * kPerM);
    height += sizes.back().second + kPictureMargin;
  }
  Canvas canvas(static_cast<int>(width + 2 * kPictureMargin), static_cast<int>(height + 2 * kPictureMargin),
                kPlotPaper);
  double top = kPictureMargin;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const Strip strip{kPictureMargin, top + sizes[i].second / 2, sizes[i].first, kPerM};
    DrawTrace(shown[i].trace, strip, kPale, &canvas);
    DrawImmediate(shown[i], strip, &canvas);
    const char letter = static_cast<char>('a' + i);
    canvas.Text({kPictureMargin, top + 14},
                std::string("(") + letter + ") at " + Short(shown[i].shot.time_s, 0) + " s", kPlotInk, 14);
    top += sizes[i].second + kPictureMargin;
  }
  DrawScale({kPictureMargin, 0, 0, kPerM}, {kPictureMargin, height + 1.2 * kPictureMargin}, &canvas);
  return canvas.Png();
}

}  // namespace cairn::datasets::report
