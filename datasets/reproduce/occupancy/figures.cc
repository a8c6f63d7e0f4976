#include "datasets/reproduce/occupancy/figures.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "datasets/reproduce/figure_panels.h"
#include "datasets/reproduce/occupancy/hand_tests.h"
#include "datasets/reproduce/occupancy/panels.h"
#include "datasets/reproduce/occupancy/scores.h"
#include "datasets/reproduce/occupancy/thresholds.h"

namespace cairn::datasets {
namespace {

using report::MapLayer;
using report::PanelPicture;

std::string Number(double value, int digits) { return Say("%.*f", digits, value); }

double DoorWallM(const Blob& log) { return log.Get<double>("truth/doors/y_m")[0]; }

struct DriveSpan {
  double from_m, to_m;
};
DriveSpan SpanOf(const Blob& log) {
  const auto x = log.Get<double>("robot/0/poses/x_m");
  return {x.front(), x.back()};
}

double StripesOf(const Occupancy& map, const Blob& log) {
  const DriveSpan span = SpanOf(log);
  return Stripes(map, DoorWallM(log), span.from_m, span.to_m);
}

// Of one kind of hall, over seeds.
struct HallRow {
  HallScores defaults, evidence, likely, uncertain;
};

void TableRow(const std::string& name, const std::string& map, const HallScores& scores, PaperTable* table) {
  const double maps = std::max(scores.maps, 1);
  table->rows.push_back({name, map, Say("%d of %d", scores.doors_right, scores.maps),
                         Number(scores.false_occupied / maps, 1), Say("%.1f%%", 100 * scores.MissedShare()),
                         Say("%.1f%%", 100 * scores.MissedFreeShare()), Number(scores.stripes / maps, 4)});
}

HallRow ScoreHalls(const OccupancyStudy& study, const StageResults& results, int readings, bool closed) {
  HallRow row;
  for (const HallCase& hall : study.halls) {
    if (hall.door_readings != readings || hall.closed != closed) continue;
    const GridMaps maps = GridMapsOf(results, hall.name);
    const Blob& log = study.inputs.at(hall.name);
    const GridEvaluation defaults = EvaluateGrid(*maps.defaults, log),
                         evidence = EvaluateGrid(*maps.evidence, log),
                         forward = EvaluateGrid(*maps.forward, log);
    row.defaults.Add(defaults.map, StripesOf(ReadOccupancy(*maps.defaults), log));
    row.evidence.Add(evidence.map, StripesOf(ReadOccupancy(*maps.evidence), log));
    row.uncertain.Add(forward.map, StripesOf(ReadOccupancy(*maps.forward), log));
    row.likely.Add(*forward.most_likely, StripesOf(ReadMostLikely(*maps.forward), log));
  }
  return row;
}

PaperFigure HallwayFigure(const OccupancyStudy& study, const StageResults& results) {
  std::vector<PanelPicture> panels;
  PaperTable table{{"hallway", "map", "doors right", "false cells", "wall missed", "held free", "stripes"},
                   {}};
  int default_open = 0, evidence_open = 0, forward_open = 0, forward_closed = 0, halls = 0;
  for (const int readings : {1, 3, 16}) {
    const std::string name =
        "hall_" + std::to_string(study.halls.front().seed) + "_" + std::to_string(readings) + "_open";
    AddGridPanels(Say("n = %d: ", readings), GridMapsOf(results, name), &panels);
    for (const bool closed : {false, true}) {
      const HallRow row = ScoreHalls(study, results, readings, closed);
      const std::string what = Say("n = %d, %s", readings, closed ? "closed" : "open");
      TableRow(what, "log-odds", row.defaults, &table);
      TableRow(what, "log-odds, chosen", row.evidence, &table);
      TableRow(what, "most likely", row.likely, &table);
      TableRow(what, "with uncertainty", row.uncertain, &table);
      halls = row.evidence.maps;
      (closed ? forward_closed : forward_open) += row.uncertain.doors_right;
      if (closed) continue;
      evidence_open += row.evidence.doors_right;
      default_open += row.defaults.doors_right;
    }
  }
  return {
      .file = "figure_03.png",
      .title = "Figure 3: a hallway with an open door",
      .claim =
          "With as little as n = 1 or 3 door detections standard grids fail to map the door, the forward "
          "model succeeds; with n = 16 both do. Standard maps have stripes almost perpendicular to the wall.",
      .measured =
          Say("%d halls for each n: open door found with uncertainty %d of %d, by log-odds %d, with the "
              "setting chosen %d; "
              "closed door found closed with uncertainty %d of %d. False cells are means a map; stripes: "
              "mean change of the probability between neighbours along the wall, 0.15 to 0.75 m before it",
              halls, forward_open, 3 * halls, default_open, evidence_open, forward_closed, 3 * halls),
      .png = DrawGridPanels(panels, 2),
      .table = table};
}

std::string HeldOutText(const std::optional<HeldOutScore>& score) {
  return score ? Number(score->log_likelihood_per_reading, 3) : "-";
}

std::string DoorsText(const LayerScore& score) {
  const auto right =
      std::ranges::count_if(score.doors, [](const DoorScore& d) { return d.open == d.truly_open; });
  return Say("%td of %zu", right, score.doors.size());
}

struct OneMap {
  std::string name;
  LayerScore score, held_out;
  Occupancy cells;
};

std::vector<OneMap> ScoreMaps(const OccupancyStudy& study, const StageResults& results,
                              const std::string& name) {
  const Blob& log = study.inputs.at(name);
  const GridMaps maps = GridMapsOf(results, name), held_out = GridMapsOf(results, name + "_heldout");
  std::vector<OneMap> scored;
  const auto add = [&](const char* title, const Blob& map, const Blob& out) {
    scored.push_back({title, EvaluateGrid(map, log).map, EvaluateGrid(out, log).map, ReadOccupancy(map)});
  };
  add("log-odds", *maps.defaults, *held_out.defaults);
  add("log-odds, chosen", *maps.evidence, *held_out.evidence);
  const GridEvaluation forward = EvaluateGrid(*maps.forward, log), out = EvaluateGrid(*held_out.forward, log);
  scored.push_back({"most likely", *forward.most_likely, *out.most_likely, ReadMostLikely(*maps.forward)});
  scored.push_back({"with uncertainty", forward.map, out.map, ReadOccupancy(*maps.forward)});
  return scored;
}

PaperTable TableOf(const std::vector<OneMap>& maps) {
  PaperTable table{{"map", "doors open", "false cells", "wall missed", "held out [nat a reading]"}, {}};
  for (const OneMap& map : maps) {
    const CellScore& cells = *map.score.cells;
    table.rows.push_back({map.name, DoorsText(map.score), std::to_string(cells.false_occupied),
                          Say("%.1f%%", 100.0 * static_cast<double>(cells.missed_occupied) /
                                            static_cast<double>(std::max<std::int64_t>(cells.due, 1))),
                          HeldOutText(map.held_out.held_out)});
  }
  return table;
}

PaperFigure NarrowDoorsFigure(const OccupancyStudy& study, const StageResults& results) {
  const std::vector<OneMap> maps = ScoreMaps(study, results, "doors");
  std::vector<PanelPicture> panels;
  AddGridPanels("", GridMapsOf(results, "doors"), &panels);
  return {.file = "figure_04.png",
          .title = "Figure 4: two narrow doors, and somebody who walks by",
          .claim =
              "The open doors are visible in the forward model's map only; several dots in it stem from the "
              "person.",
          .measured = Say("doors open by log-odds %s, with uncertainty %s; false cells %lld and %lld",
                          DoorsText(maps[0].score).c_str(), DoorsText(maps[3].score).c_str(),
                          static_cast<long long>(maps[0].score.cells->false_occupied),
                          static_cast<long long>(maps[3].score.cells->false_occupied)),
          .png = DrawGridPanels(panels, 2),
          .table = TableOf(maps)};
}

double SmoothFound(const Occupancy& map, const Blob& log) {
  const DriveSpan span = SpanOf(log);
  return WallFound(map, ReadSegments(log, "truth/walls/", {}).front(), span.from_m, span.to_m);
}

PaperFigure SmoothWallFigure(const OccupancyStudy& study, const StageResults& results) {
  const Blob& log = study.inputs.at("smooth");
  const std::vector<OneMap> maps = ScoreMaps(study, results, "smooth");
  std::vector<PanelPicture> panels;
  AddGridPanels("", GridMapsOf(results, "smooth"), &panels);
  PaperTable table = TableOf(maps);
  table.head.emplace_back("smooth wall found");
  for (std::size_t m = 0; m < maps.size(); ++m)
    table.rows[m].push_back(Say("%.1f%%", 100 * SmoothFound(maps[m].cells, log)));
  const std::vector<InverseSonar> settings = InverseSonars();
  for (std::size_t k = 0; k < settings.size(); ++k) {
    const Blob& map = ResultOf(results, "smooth_setting_" + std::to_string(k));
    const GridEvaluation score = EvaluateGrid(map, log);
    table.rows.push_back({"log-odds, " + SettingText(settings[k]), DoorsText(score.map),
                          std::to_string(score.map.cells->false_occupied),
                          Say("%.1f%%", 100.0 * static_cast<double>(score.map.cells->missed_occupied) /
                                            static_cast<double>(score.map.cells->due)),
                          "-", Say("%.1f%%", 100 * SmoothFound(ReadOccupancy(map), log))});
  }
  return {
      .file = "figure_05.png",
      .title = "Figure 5: 50 m of corridor with a smooth wall",
      .claim =
          "Standard grids miss the smooth wall entirely and model open doors as closed; another parameter "
          "setting identifies large fractions of the wall but none of the doors. The forward model has a "
          "better bottom wall, the doors, and a trace of the person behind the robot.",
      .measured =
          Say("smooth wall found by log-odds %.0f%%, with uncertainty %.0f%%; doors %s and %s; false cells "
              "%lld and %lld",
              100 * SmoothFound(maps[0].cells, log), 100 * SmoothFound(maps[3].cells, log),
              DoorsText(maps[0].score).c_str(), DoorsText(maps[3].score).c_str(),
              static_cast<long long>(maps[0].score.cells->false_occupied),
              static_cast<long long>(maps[3].score.cells->false_occupied)),
      .png = DrawGridPanels(panels, 1),
      .table = table};
}

PaperFigure LogFigure(const OccupancyStudy& study, const StageResults& results) {
  const Blob& log = study.inputs.at("log");
  const GridMaps maps = GridMapsOf(results, "log");
  std::vector<PanelPicture> panels;
  AddGridPanels("", maps, &panels);
  const GridEvaluation defaults = EvaluateGrid(*maps.defaults, log),
                       chosen = EvaluateGrid(*maps.evidence, log), forward = EvaluateGrid(*maps.forward, log);
  PaperTable table{{"map", "held out [nat a reading]"},
                   {{"log-odds", HeldOutText(defaults.map.held_out)},
                    {"log-odds, chosen", HeldOutText(chosen.map.held_out)},
                    {"most likely", HeldOutText(forward.most_likely->held_out)},
                    {"with uncertainty", HeldOutText(forward.map.held_out)}}};
  return {.file = "log.png",
          .title = "The log given by --log",
          .claim = "Empirical results in high-noise regimes: considerably more accurate maps.",
          .measured = Say("%lld readings held out, in blocks of time; scoring parameters fitted for each map",
                          static_cast<long long>(forward.map.held_out ? forward.map.held_out->readings : 0)),
          .png = DrawGridPanels(panels, 1),
          .table = table};
}

// Each in a frame of its own: turned by up to half a turn against each other.
PaperFigure ChainFigure(const OccupancyStudy& study, const StageResults& results) {
  const Blob& log = study.inputs.at("loop");
  const Blob &raw = ResultOf(results, "loop_raw"), &evidence = ResultOf(results, "loop_evidence"),
             &forward = ResultOf(results, "loop_forward");
  const std::vector<PanelPicture> panels{
      GridPanel("log-odds, raw odometry", raw, MapLayer::kProbability),
      GridPanel("log-odds, poses of landmark_map", evidence, MapLayer::kProbability),
      GridPanel("forward model, poses of landmark_map", forward, MapLayer::kProbability)};
  PaperTable table{{"map", "pose error [m]", "false cells", "wall missed"}, {}};
  const auto add = [&](const std::string& name, const Blob& map) {
    const GridEvaluation score = EvaluateGrid(map, log);
    table.rows.push_back({name, Number(score.pose_rmse_m.value_or(NAN), 2),
                          std::to_string(score.map.cells->false_occupied),
                          Say("%.1f%%", 100.0 * static_cast<double>(score.map.cells->missed_occupied) /
                                            static_cast<double>(score.map.cells->due))});
  };
  for (std::size_t k = 0; k < panels.size(); ++k)
    add(panels[k].title, k == 0 ? raw : k == 1 ? evidence : forward);
  return {
      .file = "chain.png",
      .title = "From landmarks to occupancy (Thrun, Burgard, Fox 1998, figures 5 and 6)",
      .claim = "Raw odometry gives a map that is of no use; poses from the landmark map give one that is.",
      .measured =
          "a loop of corridors, 330 m, walls by sonar; the map's poses laid over the true ones by one rigid "
          "motion: error " +
          table.rows[0][1] + " m raw, " + table.rows[1][1] + " m corrected",
      .png = DrawGridPanels(panels, 3),
      .table = table};
}

}  // namespace

std::vector<PaperFigure> OccupancyFigures(const OccupancyStudy& study, const StageResults& results) {
  std::vector<PaperFigure> figures{CrossingFigure(study, results),    DensityFigure(),
                                   HallwayFigure(study, results),     ThresholdFigure(study, results),
                                   NarrowDoorsFigure(study, results), SmoothWallFigure(study, results),
                                   ChainFigure(study, results)};
  if (study.inputs.contains("log")) figures.push_back(LogFigure(study, results));
  return figures;
}
}  // namespace cairn::datasets
