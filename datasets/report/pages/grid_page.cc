#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "datasets/evaluate/matching/similarity.h"
#include "datasets/report/cell_picture.h"
#include "datasets/report/drawing/format.h"
#include "datasets/report/pages/facts.h"
#include "datasets/report/pages/pages.h"
#include "datasets/report/pages/parts.h"
#include "datasets/report/pictures.h"
#include "schema/kinds/grid_map.h"

namespace cairn::datasets::report {
namespace {

constexpr std::int64_t kMostCellsOfPage = 3000;     // along an edge: more are drawn as blocks
constexpr std::int64_t kMostCellsOfEarlier = 1000;  // of maps that came before

MapCells CellsOf(const CellPicture& picture, const std::vector<Raster>& earlier = {}) {
  const CellPicture blocks = InBlocks(picture, kMostCellsOfPage);
  return {CellsRaster(blocks), BoxOf(blocks.box), earlier};
}

using NamedCells = std::vector<std::pair<std::string, MapCells>>;

// A layer with what lies on it.
Picture LayerPicture(const MapCells& cells, const NamedCells& instead, const std::string& label,
                     const Scene& scene, double width) {
  return MapPicture(
      scene, width,
      {.below = cells, .instead = instead, .round_cells = true, .label = label, .highest = 0.9});
}

std::vector<Raster> EarlierRasters(const Blob& map) {
  std::vector<Raster> rasters;
  for (const CellPicture& earlier : EarlierMaps(map))
    rasters.push_back(CellsRaster(earlier, kMostCellsOfEarlier));
  return rasters;
}

std::string LayerHtml(const Blob& map, MapLayer layer, const std::string& label, const Scene& scene,
                      const std::vector<LegendEntry>& legend, const std::string& caption,
                      const std::vector<Raster>& earlier = {}, const NamedCells& instead = {}) {
  const auto picture = PictureOf(map, layer);
  if (!picture) return {};
  const MapCells cells = CellsOf(*picture, earlier);
  return LegendHtml(legend) +
         DrawingHtml([&](double width) { return LayerPicture(cells, instead, label, scene, width); },
                     caption);
}

// The pictures that have sections of their own, to lay over the map; a page has each picture's pixels once.
NamedCells OtherLayers(const Blob& map) {
  NamedCells layers;
  for (const auto& [name, layer] : {std::pair{"most likely map", MapLayer::kMostLikely},
                                    std::pair{"difference of log-likelihoods", MapLayer::kDifference},
                                    std::pair{"readings not explained", MapLayer::kDynamic}})
    if (const auto picture = PictureOf(map, layer)) layers.emplace_back(name, CellsOf(*picture));
  return layers;
}

std::vector<LegendEntry> DifferenceLegend() {
  std::vector<LegendEntry> legend;
  for (const double nats : {-kFullColourNats, -1.0, 1.0, kFullColourNats}) {
    const bool full = std::abs(nats) >= kFullColourNats;
    legend.push_back(SwatchEntry(OfDifference(nats),
                                 Short(nats) +
                                     (full ? " nat or " + std::string(nats < 0 ? "less" : "more") : " nat") +
                                     (nats < 0 ? ", free" : ", occupied")));
  }
  legend.push_back(SwatchEntry(kSaysNothing, "the data do not tell"));
  return legend;
}

void AddPaths(const Scene& scene, std::vector<LegendEntry>* legend) {
  for (const Path& path : scene.paths)
    legend->push_back(LineEntry(fmt::format("path r{}", path.index % kRobotColours),
                                "where " + RobotTitle(path.robot) + " scanned"));
  if (!scene.truth_walls.empty()) legend->push_back(LineEntry("wall", "true wall"));
}

std::string HistoryHtml(const Blob& map) {
  const auto history = FieldsIn<kinds::GridMap::History>("history/", map);
  if (!history.log_likelihood) return {};
  const std::span<const double> values = history.log_likelihood;
  const std::span<const std::int64_t> occupied = history.occupied.OrNone();
  // The empty map is so much less likely than any other that beside it the others' curve is flat.
  const bool from_empty = values.size() > 2 && !occupied.empty() && occupied[0] == 0;
  Curve curve;
  for (std::size_t round = from_empty ? 1 : 0; round < values.size(); ++round)
    curve.points.push_back({static_cast<double>(round), values[round]});
  const std::string left_out =
      from_empty ? " Round 0, left out, is of the empty map: " + Grouped(values[0]) + " nat." : "";
  return ChartHtml(
      {.title = "Log-likelihood",
       .x_label = "round",
       .y_label = "log p(data | map) [nat]",
       .curves = {curve}},
      "Of the data, each time that a map or parameters of the sensors were taken over." + left_out);
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
  for (const kinds::GridMap::Robot& robot : Read<kinds::GridMap>(map).robot) {
    for (const kinds::GridMap::Sensor& sensor : robot.sensors) {
      for (const std::uint8_t held_out : sensor.held_out.OrNone()) {
        ++count.scans;
        count.held_out += held_out;
      }
    }
  }
  return count;
}

std::string Lead(const Blob& map) {
  const GridBox box = ReadOccupancy(map).box;
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
    tiles += CountTileHtml(map.at("history/log_likelihood").size(), "iteration");
  if (Read<kinds::GridMap>(map).cut_short.Or(0) != 0)
    tiles += TileHtml("cut short", "the search, by the option rounds", "bad");
  return TilesHtml(tiles + WallTimeTile(map));
}

// Every single number that the result gives beside its map: parameters as given or estimated.
std::string Parameters(const Blob& map) {
  Table rows{{"parameter", "value"}};
  for (const auto& [name, array] : map.fields()) {
    if (array.size() != 1 || name.starts_with("map/") || name.starts_with("provenance/") ||
        name.starts_with("history/"))
      continue;
    if (array.type() == DType::kF64) rows.push_back({name, Short(array.As<double>()[0], 5)});
    if (array.type() == DType::kI64) rows.push_back({name, std::to_string(array.As<std::int64_t>()[0])});
    if (array.type() == DType::kI32) rows.push_back({name, std::to_string(array.As<std::int32_t>()[0])});
  }
  return rows.size() > 1 ? TableHtml(rows) : "";
}

// Cells of each kind that the dynamic layer marks.
std::string MovedHtml(const Blob& map) {
  const auto picture = PictureOf(map, MapLayer::kDynamic);
  if (!picture) return {};
  std::int64_t passed = 0, went = 0;
  for (const std::uint8_t kind : map.Get<std::uint8_t>("map/grid/dynamic")) {
    passed += kind == 1 ? 1 : 0;
    went += kind == 2 ? 1 : 0;
  }
  if (passed + went == 0) return "<p>Nothing here: no cell is marked.</p>\n";
  const std::vector<LegendEntry> legend{
      SwatchEntry(kForOccupied, "an obstacle of the map through which beams passed before or after: " +
                                    Count(went, "cell")),
      SwatchEntry(kForFree,
                  "free, but a reading may have ended here that nothing explains: " + Count(passed, "cell"))};
  return LayerHtml(
      map, MapLayer::kDynamic, "Readings that the map does not explain", {}, legend,
      "Somebody who passed leaves such cells, and so do readings that are wrong. A sonar's reading ended "
      "somewhere on its arc, and the whole arc is marked: most of these cells were free all the time.");
}

}  // namespace

std::string GridSoFarHtml(const Blob& map) {
  return SectionHtml("Map", LayerHtml(map, MapLayer::kProbability, "Map so far", {},
                                      {SwatchEntry(kPaper, "free"), SwatchEntry(kBlack, "occupied")},
                                      "The map that the search holds. What it does not know yet is free. The "
                                      "slider shows those that it held before.",
                                      EarlierRasters(map))) +
         SectionHtml("Convergence", HistoryHtml(map));
}

std::string GridMapHtml(const Blob& map, const Blob* log, const GridEvaluation* evaluation) {
  const Scene scene = GridSceneOf(map, log, evaluation);
  std::vector<LegendEntry> legend = ProbabilityLegend();
  AddPaths(scene, &legend);
  std::string html = Lead(map) + Tiles(map, evaluation);
  html += SectionHtml(
      "Map", LayerHtml(map, MapLayer::kProbability, "Occupancy probability", scene, legend,
                       "The darker, the likelier occupied; the lines are where scans were taken. Other "
                       "layers can be laid over it.",
                       {}, OtherLayers(map)));
  html += SectionHtml(
      "Most likely map",
      LayerHtml(
          map, MapLayer::kMostLikely, "Most likely map", {},
          {SwatchEntry(kPaper, "free"), SwatchEntry(kBlack, "occupied"),
           SwatchEntry(kUnknown, "nothing known")},
          "The map under which the data are likeliest: a cell is free unless they speak for an obstacle, "
          "however little they say; how sure that is shows the map above. The slider shows the maps that the "
          "search held before.",
          EarlierRasters(map)));
  html += SectionHtml(
      "What the data say of each cell",
      LayerHtml(map, MapLayer::kDifference, "Log-likelihood difference by cell", {}, DifferenceLegend(),
                "log p(data | cell occupied) - log p(data | cell free), all other cells as in the most "
                "likely map."));
  html += SectionHtml("Readings that the map does not explain", MovedHtml(map));
  html += SectionHtml("Convergence", HistoryHtml(map));
  html += SectionHtml("Parameters", Parameters(map));
  return html + SectionHtml("Time", TimeHtml(RoundTimes(map)));
}

}  // namespace cairn::datasets::report
