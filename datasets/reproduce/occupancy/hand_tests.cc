#include "datasets/reproduce/occupancy/hand_tests.h"

#include <algorithm>
#include <cmath>

#include "datasets/evaluate/grid.h"
#include "datasets/report/drawing/charts.h"
#include "datasets/reproduce/figure_panels.h"

namespace cairn::datasets {

using report::PanelPicture;

PaperFigure CrossingFigure(const OccupancyStudy& study, const StageResults& results) {
  const GridMaps maps = GridMapsOf(results, "crossing");
  const Blob& log = study.inputs.at("crossing");
  std::vector<PanelPicture> panels;
  AddGridPanels("", maps, &panels);
  const std::vector<ScoredSensor> scans = ReadScoredScans(*maps.forward, log);
  const auto in_overlap = [&](const Occupancy& map, int* cells, int* occupied) {
    const Pose first = scans[0].BeamPose(0, 0), second = scans[0].BeamPose(1, 0);
    const double half = scans[0].opening_rad / 2;
    for (std::int64_t row = 0; row < map.box.rows; ++row) {
      for (std::int64_t column = 0; column < map.box.columns; ++column) {
        const Point at = map.box.Centre(column, row);
        const auto within = [&](const Pose& beam, double low_m, double high_m) {
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
          .png = DrawGridPanels(panels, 4)};
}

PaperFigure DensityFigure() {
  const ReadingModel model{0.6, 0.1, 0.12};
  ScoredReading reading{0, true, 6, {{2, 1}, {3.5, 1}}};
  report::Curve density;
  density.name = "p(z | m)";
  double highest_near = 0, highest_far = 0;
  for (reading.z_m = 0; reading.z_m < reading.max_range_m; reading.z_m += 0.01) {
    const double p = std::exp(LogDensity(reading, model));
    density.points.push_back({reading.z_m, p});
    double& highest = reading.z_m < 2.75 ? highest_near : highest_far;
    highest = std::max(highest, p);
  }
  reading.echo = false;
  const double none = std::exp(LogDensity(reading, model));
  for (const double z : {reading.max_range_m, reading.max_range_m + 1e-3})
    density.points.push_back({z, z == reading.max_range_m ? none : 0});
  report::LineChart plot;
  plot.title = "obstacles at 2 and 3.5 m, reach 6 m";
  plot.x_label = "range z [m]";
  plot.y_label = "p(z | m) [1/m]";
  plot.curves = {density};
  return {.file = "figure_02.png",
          .title = "Figure 2: the forward model",
          .claim =
              "A large peak at the nearest obstacle, a smaller one at the farther, a third at the max-range; "
              "mixed with a uniform density.",
          .measured =
              Say("peaks of %.2f at 2 m, %.2f at 3.5 m, %.2f of readings without echo (a width of %.2f m); "
                  "p_hit %.1f, p_rand %.1f, sigma %.2f m",
                  highest_near, highest_far, none, kNoEchoSdM, model.p_hit, model.p_rand, model.sigma_m),
          .png = report::ChartsPicture({plot}, 1, 620, 260).Png()};
}

}  // namespace cairn::datasets
