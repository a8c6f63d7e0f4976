#include "datasets/reproduce/occupancy_figures.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "datasets/report/cell_picture.h"
#include "datasets/report/palette.h"
#include "datasets/report/panels.h"
#include "datasets/report/plots.h"
#include "datasets/reproduce/figure_panels.h"
#include "datasets/reproduce/occupancy_scores.h"

namespace cairn::datasets {
namespace {

using report::MapLayer;
using report::PanelPicture;
using Results = std::map<std::string, Blob>;

const Blob& At(const Results& results, const std::string& stage) {
  const auto it = results.find(stage);
  if (it == results.end()) throw InputError("there is no result '" + stage + "'");
  return it->second;
}

// The maps that are compared: log-odds by evidence_map's own setting and by the one chosen, forward models.
struct Maps {
  const Blob *defaults, *evidence, *forward;
};
Maps MapsOf(const Results& results, const std::string& name) {
  return {&At(results, name + "_default"), &At(results, name + "_evidence"), &At(results, name + "_forward")};
}

PanelPicture Panel(const std::string& title, const Blob& map, MapLayer layer) {
  PanelPicture panel;
  panel.title = title;
  panel.cells = report::PictureOf(map, layer);
  if (!panel.cells) throw InputError(title + ": the map lacks what is to be drawn");
  return panel;
}

void AddPanels(const std::string& of, const Maps& maps, std::vector<PanelPicture>* panels) {
  panels->push_back(Panel(of + "log-odds", *maps.defaults, MapLayer::kProbability));
  panels->push_back(Panel(of + "log-odds, chosen", *maps.evidence, MapLayer::kProbability));
  panels->push_back(Panel(of + "most likely map", *maps.forward, MapLayer::kMostLikely));
  panels->push_back(Panel(of + "with uncertainty", *maps.forward, MapLayer::kProbability));
}

report::Box BoxOf(const std::vector<PanelPicture>& panels) {
  std::optional<report::Box> box;
  for (const PanelPicture& panel : panels) {
    const CellBox& cells = panel.cells->box;
    const report::Box here{
        cells.origin_x_m, cells.origin_x_m + static_cast<double>(cells.columns) * cells.cell_m,
        cells.origin_y_m, cells.origin_y_m + static_cast<double>(cells.rows) * cells.cell_m};
    box = box ? report::Around(*box, here) : here;
  }
  return *box;
}

std::string Drawn(const std::vector<PanelPicture>& panels, int columns) {
  return report::DrawPanels(panels, BoxOf(panels), columns);
}

std::string Number(double value, int digits) { return Say("%.*f", digits, value); }

// Figure 1. Of the cells where the short reading's end crosses what the long one says is free.
PaperFigure CrossingFigure(const OccupancyStudy& study, const Results& results) {
  const Maps maps = MapsOf(results, "crossing");
  const Blob& log = study.inputs.at("crossing");
  std::vector<PanelPicture> panels;
  AddPanels("", maps, &panels);
  const std::vector<ScoredSensor> scans = ReadScoredScans(*maps.forward, log);
  const auto in_overlap = [&](const Occupancy& map, int* cells, int* occupied) {
    const PoseM first = scans[0].BeamPose(0, 0), second = scans[0].BeamPose(1, 0);
    const double half = scans[0].opening_rad / 2;
    for (std::int64_t row = 0; row < map.box.rows; ++row) {
      for (std::int64_t column = 0; column < map.box.columns; ++column) {
        const PointM at = map.box.Centre(column, row);
        const auto within = [&](const PoseM& beam, double low_m, double high_m) {
          const double dx = at.x_m - beam.x_m, dy = at.y_m - beam.y_m, away = std::hypot(dx, dy);
          const double off = WrapAngle(std::atan2(dy, dx) - beam.heading_rad);
          return away > low_m && away < high_m && std::abs(off) < half;
        };
        if (!within(first, 0, scans[0].range_m[0] - 0.15)) continue;
        if (!within(second, scans[0].range_m[1] - 0.05, scans[0].range_m[1] + 0.05)) continue;
        ++*cells;
        *occupied += map.IsOccupied(column, row) ? 1 : 0;
      }
    }
  };
  int cells = 0, evidence = 0, likely = 0, ignored = 0;
  in_overlap(ReadOccupancy(*maps.defaults), &cells, &evidence);
  in_overlap(ReadMostLikely(*maps.forward), &ignored, &likely);
  return {.file = "figure_01.png",
          .title = "Figure 1: two crossing cones",
          .claim =
              "Each beam by itself, combined: a conflict where they overlap. There are maps that explain "
              "both without any.",
          .measured =
              Say("of %d cells at the end of the short reading and inside the long one's cone, occupied in "
                  "the log-odds map %d, in the most likely map %d",
                  cells, evidence, likely),
          .png = Drawn(panels, 4)};
}

// Figure 2: p(z | m) of two obstacles in a cone.
PaperFigure DensityFigure() {
  const ReadingModel model{0.6, 0.1, 0.12};
  ScoredReading reading{0, true, 6, {{2, 1}, {3.5, 1}}};
  report::PlotSeries density;
  density.name = "p(z | m)";
  density.colour = report::kRobots[0];
  double highest_near = 0, highest_far = 0;
  for (reading.z_m = 0; reading.z_m < reading.max_range_m; reading.z_m += 0.01) {
    const double p = std::exp(LogDensity(reading, model));
    density.points.push_back({reading.z_m, p, {}});
    double& highest = reading.z_m < 2.75 ? highest_near : highest_far;
    highest = std::max(highest, p);
  }
  reading.echo = false;
  const double none = std::exp(LogDensity(reading, model));
  for (const double z : {reading.max_range_m, reading.max_range_m + 1e-3})
    density.points.push_back({z, z == reading.max_range_m ? none : 0, {}});
  report::Plot plot;
  plot.title = "obstacles at 2 and 3.5 m, reach 6 m";
  plot.x_label = "range z [m]";
  plot.y_label = "p(z | m) [1/m]";
  plot.series = {density};
  return {.file = "figure_02.png",
          .title = "Figure 2: the forward model",
          .claim =
              "A large peak at the nearest obstacle, a smaller one at the farther, a third at the max-range; "
              "mixed with a uniform density.",
          .measured =
              Say("peaks of %.2f at 2 m, %.2f at 3.5 m, %.2f of readings without echo (a width of %.2f m); "
                  "p_hit %.1f, p_rand %.1f, sigma %.2f m",
                  highest_near, highest_far, none, kNoEchoSdM, model.p_hit, model.p_rand, model.sigma_m),
          .png = report::DrawPlots({plot}, {1, 620, 260})};
}

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

void Row(const std::string& name, const std::string& map, const HallScores& scores, PaperTable* table) {
  const double maps = std::max(scores.maps, 1);
  table->rows.push_back({name, map, Say("%d of %d", scores.doors_right, scores.maps),
                         Number(scores.false_occupied / maps, 1), Say("%.1f%%", 100 * scores.MissedShare()),
                         Number(scores.stripes / maps, 4)});
}

HallRow ScoreHalls(const OccupancyStudy& study, const Results& results, int readings, bool closed) {
  HallRow row;
  for (const HallCase& hall : study.halls) {
    if (hall.door_readings != readings || hall.closed != closed) continue;
    const Maps maps = MapsOf(results, hall.name);
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

PaperFigure HallwayFigure(const OccupancyStudy& study, const Results& results) {
  std::vector<PanelPicture> panels;
  PaperTable table{{"hallway", "map", "doors right", "false cells", "wall missed", "stripes"}, {}};
  int default_open = 0, evidence_open = 0, forward_open = 0, forward_closed = 0, halls = 0;
  for (const int readings : {1, 3, 16}) {
    const std::string name =
        "hall_" + std::to_string(study.halls.front().seed) + "_" + std::to_string(readings) + "_open";
    AddPanels(Say("n = %d: ", readings), MapsOf(results, name), &panels);
    for (const bool closed : {false, true}) {
      const HallRow row = ScoreHalls(study, results, readings, closed);
      const std::string what = Say("n = %d, %s", readings, closed ? "closed" : "open");
      Row(what, "log-odds", row.defaults, &table);
      Row(what, "log-odds, chosen", row.evidence, &table);
      Row(what, "most likely", row.likely, &table);
      Row(what, "with uncertainty", row.uncertain, &table);
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
      .png = Drawn(panels, 2),
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

std::vector<OneMap> ScoreMaps(const OccupancyStudy& study, const Results& results, const std::string& name) {
  const Blob& log = study.inputs.at(name);
  const Maps maps = MapsOf(results, name), held_out = MapsOf(results, name + "_heldout");
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

PaperFigure NarrowDoorsFigure(const OccupancyStudy& study, const Results& results) {
  const std::vector<OneMap> maps = ScoreMaps(study, results, "doors");
  std::vector<PanelPicture> panels;
  AddPanels("", MapsOf(results, "doors"), &panels);
  return {.file = "figure_04.png",
          .title = "Figure 4: two narrow doors, and somebody who walks by",
          .claim =
              "The open doors are visible in the forward model's map only; several dots in it stem from the "
              "person.",
          .measured = Say("doors open by log-odds %s, with uncertainty %s; false cells %lld and %lld",
                          DoorsText(maps[0].score).c_str(), DoorsText(maps[3].score).c_str(),
                          static_cast<long long>(maps[0].score.cells->false_occupied),
                          static_cast<long long>(maps[3].score.cells->false_occupied)),
          .png = Drawn(panels, 2),
          .table = TableOf(maps)};
}

double SmoothFound(const Occupancy& map, const Blob& log) {
  const DriveSpan span = SpanOf(log);
  return WallFound(map, ReadSegments(log, "truth/walls/", {}).front(), span.from_m, span.to_m);
}

std::string SettingText(const InverseSonar& sonar) {
  return Say("p_occupied %.3f, p_free %.2f, wall %.2f m%s", sonar.p_occupied, sonar.p_free, sonar.wall_m,
             sonar.graded ? ", graded" : "");
}

PaperFigure SmoothWallFigure(const OccupancyStudy& study, const Results& results) {
  const Blob& log = study.inputs.at("smooth");
  const std::vector<OneMap> maps = ScoreMaps(study, results, "smooth");
  std::vector<PanelPicture> panels;
  AddPanels("", MapsOf(results, "smooth"), &panels);
  PaperTable table = TableOf(maps);
  table.head.emplace_back("smooth wall found");
  for (std::size_t m = 0; m < maps.size(); ++m)
    table.rows[m].push_back(Say("%.1f%%", 100 * SmoothFound(maps[m].cells, log)));
  const std::vector<InverseSonar> settings = InverseSonars();
  for (std::size_t k = 0; k < settings.size(); ++k) {
    const Blob& map = At(results, "smooth_setting_" + std::to_string(k));
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
      .png = Drawn(panels, 1),
      .table = table};
}

PaperFigure LogFigure(const OccupancyStudy& study, const Results& results) {
  const Blob& log = study.inputs.at("log");
  const Maps maps = MapsOf(results, "log");
  std::vector<PanelPicture> panels;
  AddPanels("", maps, &panels);
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
          .png = Drawn(panels, 1),
          .table = table};
}

// Each in a frame of its own: turned by up to half a turn against each other.
PaperFigure ChainFigure(const OccupancyStudy& study, const Results& results) {
  const Blob& log = study.inputs.at("loop");
  const Blob &raw = At(results, "loop_raw"), &evidence = At(results, "loop_evidence"),
             &forward = At(results, "loop_forward");
  const std::vector<PanelPicture> panels{
      Panel("log-odds, raw odometry", raw, MapLayer::kProbability),
      Panel("log-odds, poses of landmark_map", evidence, MapLayer::kProbability),
      Panel("forward model, poses of landmark_map", forward, MapLayer::kProbability)};
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
      .png = Drawn(panels, 3),
      .table = table};
}

}  // namespace

std::vector<PaperFigure> OccupancyFigures(const OccupancyStudy& study, const Results& results) {
  std::vector<PaperFigure> figures{CrossingFigure(study, results),   DensityFigure(),
                                   HallwayFigure(study, results),    NarrowDoorsFigure(study, results),
                                   SmoothWallFigure(study, results), ChainFigure(study, results)};
  if (study.inputs.contains("log")) figures.push_back(LogFigure(study, results));
  return figures;
}

std::vector<PaperFigure> CurveFigures(const OccupancyStudy& study, const Results& results) {
  const std::vector<InverseSonar> settings = InverseSonars();
  PaperTable table{{"setting", "open found", "closed found", "false cells", "wall missed"}, {}};
  std::map<std::string, report::PlotSeries> curves;
  for (std::size_t k = 0; k < settings.size(); ++k) {
    std::map<bool, HallScores> scores;  // by whether the door is closed
    for (const HallCase& hall : study.halls) {
      const Blob& log = study.inputs.at(hall.name);
      scores[hall.closed].Add(EvaluateGrid(At(results, hall.name + "_setting_" + std::to_string(k)), log).map,
                              0);
    }
    HallScores &open = scores[false], &closed = scores[true];
    const double missed = (open.missed + closed.missed) / std::max(open.due + closed.due, 1.0);
    table.rows.push_back(
        {SettingText(settings[k]), Say("%d of %d", open.doors_right, open.maps),
         Say("%d of %d", closed.doors_right, closed.maps),
         Number((open.false_occupied + closed.false_occupied) / (open.maps + closed.maps), 1),
         Say("%.1f%%", 100 * missed)});
    const std::string shape = Say("wall %.2f m%s", settings[k].wall_m, settings[k].graded ? ", graded" : "");
    const auto [at, is_new] = curves.try_emplace(shape);
    report::PlotSeries& curve = at->second;
    curve.name = shape;
    if (is_new) curve.colour = report::kRobots[curves.size() - 1];
    curve.dots = true;
    curve.points.push_back({100 * (1 - missed), 100.0 * open.doors_right / open.maps, {}});
  }
  report::Plot plot;
  plot.title = "evidence_map: walls against doors";
  plot.x_label = "wall cells found [%]";
  plot.y_label = "open doors found [%]";
  for (const auto& [shape, curve] : curves) plot.series.push_back(curve);
  plot.y_low = 0;
  plot.y_high = 100;
  return {{.file = "curve.png",
           .title = "Section 4: walls found against doors found, by the inverse model's parameters",
           .claim =
               "One setting misses the wall, another identifies large fractions of it but none of the doors.",
           .measured =
               "of p_occupied and p_free only the ratio of their log-odds counts for what is above a half",
           .png = report::DrawPlots({plot}, {1, 520, 320}),
           .table = table}};
}

}  // namespace cairn::datasets
