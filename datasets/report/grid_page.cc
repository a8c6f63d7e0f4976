#include "datasets/report/grid_page.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "datasets/evaluate/similarity.h"
#include "datasets/report/axes.h"
#include "datasets/report/cell_picture.h"
#include "datasets/report/facts.h"
#include "datasets/report/format.h"
#include "datasets/report/line_chart.h"
#include "datasets/report/parts.h"
#include "datasets/report/svg.h"

namespace cairn::datasets::report {
namespace {

constexpr double kWidth = 1040, kLeft = 46, kRight = 10, kTop = 10, kBottom = 40;

// Where each robot was when it scanned: of its sensor of most scans.
std::map<std::string, std::vector<PointM>> WaysOf(const Blob& map) {
  std::map<std::string, std::vector<PointM>> ways;
  for (const auto& [name, array] : map.fields()) {
    constexpr std::string_view kLast = "held_out";
    if (!name.starts_with("robot/") || !name.ends_with(kLast)) continue;
    const std::string sensor = name.substr(0, name.size() - kLast.size());
    const auto x = map.Get<double>(sensor + "x_m"), y = map.Get<double>(sensor + "y_m");
    if (x.size() != y.size()) throw InputError("'" + sensor + "': columns of different length");
    std::vector<PointM>& way = ways[sensor.substr(0, sensor.find('/', std::string("robot/").size()))];
    if (x.size() <= way.size()) continue;
    way.clear();
    for (std::size_t i = 0; i < x.size(); ++i) way.push_back({x[i], y[i]});
  }
  return ways;
}

std::vector<Wall> TrueWalls(const Blob* log, const GridEvaluation* evaluation) {
  if (log == nullptr || evaluation == nullptr || !log->Has("truth/walls/x_m")) return {};
  return ReadSegments(*log, "truth/walls/", evaluation->to_map);
}

Box BoxOf(const CellBox& cells) {
  return {cells.origin_x_m, cells.origin_x_m + static_cast<double>(cells.columns) * cells.cell_m,
          cells.origin_y_m, cells.origin_y_m + static_cast<double>(cells.rows) * cells.cell_m};
}

void DrawAxes(const MapFrame& frame, Svg* svg) {
  const Panel& p = frame.panel();
  const Box& box = frame.box();
  svg->Rect(p.left, p.top, p.width, p.height, "frame");
  for (const double x : Ticks(box.x_low_m, box.x_high_m, static_cast<int>(p.width / 90)))
    svg->Text(frame.X(x), p.top + p.height + 15, Short(x), "tick middle");
  for (const double y : Ticks(box.y_low_m, box.y_high_m, static_cast<int>(std::max(p.height / 60, 2.0))))
    svg->Text(p.left - 6, frame.Y(y) + 4, Short(y), "tick end");
  svg->Text(p.left + p.width / 2, p.top + p.height + 33, "x [m]", "axis middle");
  svg->VerticalText(p.left - 36, p.top + p.height / 2, "y [m]", "axis middle");
}

std::string LayerFigure(const Blob& map, MapLayer layer, const std::string& label,
                        const std::vector<Wall>& walls,
                        const std::map<std::string, std::vector<PointM>>& ways) {
  const auto picture = PictureOf(map, layer);
  if (!picture) return {};
  const Box box = BoxOf(picture->box);
  const double width = kWidth - kLeft - kRight, height = PanelHeight(box, width, 90, 900);
  Svg svg(kWidth, kTop + height + kBottom, label);
  const MapFrame frame(box, {kLeft, kTop, width, height});
  svg.BeginClip(kLeft, kTop, width, height);
  svg.Image(frame.X(box.x_low_m), frame.Y(box.y_high_m), box.width_m() * frame.pixels_per_m(),
            box.height_m() * frame.pixels_per_m(), CellsPng(*picture));
  for (const Wall& wall : walls)
    svg.Line(frame.X(wall.a.x_m), frame.Y(wall.a.y_m), frame.X(wall.b.x_m), frame.Y(wall.b.y_m), "wall");
  std::size_t robot = 0;
  for (const auto& [name, way] : ways) {
    std::vector<PointM> pixels;
    for (const PointM& at : way) pixels.push_back({frame.X(at.x_m), frame.Y(at.y_m)});
    svg.Polyline(pixels, "path r" + std::to_string(robot++ % kRobotColours));
  }
  svg.EndClip();
  DrawAxes(frame, &svg);
  return svg.Finish();
}

std::string HistoryFigure(const Blob& map) {
  if (!map.Has("history/log_likelihood")) return {};
  Curve curve;
  for (const double value : map.Get<double>("history/log_likelihood"))
    curve.points.push_back({static_cast<double>(curve.points.size()), value});
  Svg svg(kWidth, 270, "Log-likelihood by round");
  const bool any =
      Draw({"Log-likelihood", "round", "log p(data | map) [nat]", {curve}}, {86, 24, kWidth - 96, 200}, &svg);
  return any ? svg.Finish() : "";
}

std::string CellTiles(const LayerScore& score, const std::string& of) {
  std::string tiles;
  if (score.cells) {
    tiles += TileHtml(Grouped(static_cast<double>(score.cells->false_occupied)), "false obstacles" + of);
    tiles += TileHtml(Grouped(static_cast<double>(score.cells->missed_occupied)) + " of " +
                          Grouped(static_cast<double>(score.cells->due)),
                      "wall cells missed" + of);
  }
  std::int64_t right = 0;
  for (const DoorScore& door : score.doors) right += door.open == door.truly_open ? 1 : 0;
  if (!score.doors.empty()) {
    const auto doors = static_cast<std::int64_t>(score.doors.size());
    tiles += TileHtml(std::to_string(right) + " of " + std::to_string(doors), "doors right" + of,
                      right == doors ? "good" : "bad");
  }
  if (score.held_out)
    tiles += TileHtml(Short(score.held_out->log_likelihood_per_reading, 3) + " nat",
                      "log-likelihood of a held-out reading" + of);
  return tiles;
}

struct ScanCount {
  std::int64_t scans = 0, held_out = 0;
};
ScanCount CountScans(const Blob& map) {
  ScanCount count;
  for (const auto& [name, array] : map.fields()) {
    if (!name.starts_with("robot/") || !name.ends_with("/held_out")) continue;
    for (const std::uint8_t held_out : map.Get<std::uint8_t>(name)) {
      ++count.scans;
      count.held_out += held_out;
    }
  }
  return count;
}

std::string Lead(const Blob& map) {
  const CellBox box = ReadOccupancy(map).box;
  const ScanCount count = CountScans(map);
  std::string text = Short(static_cast<double>(box.columns) * box.cell_m) + " by " +
                     Short(static_cast<double>(box.rows) * box.cell_m) + " m in cells of " +
                     Short(box.cell_m, 4) + " m";
  if (count.scans > 0) text += ", of " + Count(count.scans - count.held_out, "scan");
  if (count.held_out > 0) text += "; " + Count(count.held_out, "scan") + " left out, to score it with";
  return "<p class=\"lead\">" + Escape(text + ".") + "</p>\n";
}

std::string Tiles(const Blob& map, const GridEvaluation* evaluation) {
  std::string tiles;
  if (evaluation != nullptr) {
    tiles += CellTiles(evaluation->map, "");
    if (evaluation->most_likely) tiles += CellTiles(*evaluation->most_likely, ", most likely map");
  }
  if (map.Has("history/log_likelihood"))
    tiles += TileHtml(std::to_string(map.at("history/log_likelihood").size()), "rounds");
  if (map.Has("search/cut_short") && map.Scalar<std::uint8_t>("search/cut_short") != 0)
    tiles += TileHtml("cut short", "the search, by the option rounds", "bad");
  if (map.Has("provenance/seconds_s"))
    tiles += TileHtml(Duration(map.Scalar<double>("provenance/seconds_s")), "wall time");
  return tiles.empty() ? "" : "<div class=\"tiles\">\n" + tiles + "</div>\n";
}

// Every single number that the result gives beside its map: parameters as given or estimated.
std::string Parameters(const Blob& map) {
  std::string rows;
  for (const auto& [name, array] : map.fields()) {
    if (array.size() != 1 || name.starts_with("map/") || name.starts_with("provenance/") ||
        name.starts_with("history/"))
      continue;
    if (array.type() == DType::kF64) rows += RowHtml({name, Short(array.As<double>()[0], 5)});
    if (array.type() == DType::kI64) rows += RowHtml({name, std::to_string(array.As<std::int64_t>()[0])});
    if (array.type() == DType::kI32) rows += RowHtml({name, std::to_string(array.As<std::int32_t>()[0])});
  }
  return rows.empty() ? ""
                      : "<div class=\"scroll\"><table>\n" + RowHtml({"parameter", "value"}, "th") + rows +
                            "</table></div>\n";
}

}  // namespace

std::string GridMapHtml(const Blob& map, const Blob* log, const GridEvaluation* evaluation) {
  const std::vector<Wall> walls = TrueWalls(log, evaluation);
  const auto ways = WaysOf(map);
  const std::string on_top = walls.empty() ? "" : " Thin lines: the true walls.";
  std::string html = Lead(map) + Tiles(map, evaluation);
  html += SectionHtml(
      "Map", FigureHtml(LayerFigure(map, MapLayer::kProbability, "Occupancy probability", walls, ways),
                        "Black: occupied, white: free, grey: nothing is known. The line is where the scans "
                        "were taken." +
                            on_top));
  html += SectionHtml("Most likely map",
                      FigureHtml(LayerFigure(map, MapLayer::kMostLikely, "Most likely map", {}, {}),
                                 "The map under which the data are likeliest."));
  html += SectionHtml(
      "What the data say of each cell",
      FigureHtml(
          LayerFigure(map, MapLayer::kDifference, "Log-likelihood difference by cell", {}, {}),
          "log p(data | cell occupied) - log p(data | cell free), all other cells as in the most likely "
          "map. Red: occupied, blue: free, in full colour from " +
              Short(kFullColourNats) + " nats on; grey: the data do not tell."));
  html += SectionHtml(
      "What moved",
      FigureHtml(LayerFigure(map, MapLayer::kDynamic, "Cells in which something moved", {}, {}),
                 "Red: an obstacle of the map through which beams passed before or after; blue: free, but "
                 "readings ended there, or on that arc, that nothing in the map explains."));
  html += SectionHtml("Convergence", FigureHtml(HistoryFigure(map), "Of the data, after each round."));
  html += SectionHtml("Parameters", Parameters(map));
  html += SectionHtml("Time", TimeHtml(RoundTimes(map)));
  html += SectionHtml("Job", ProvenanceHtml(map));
  return html;
}

}  // namespace cairn::datasets::report
