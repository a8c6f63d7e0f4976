#include <algorithm>
#include <map>

#include "datasets/report/drawing/charts.h"
#include "datasets/reproduce/figure_panels.h"
#include "datasets/reproduce/occupancy/figures.h"
#include "datasets/reproduce/occupancy/panels.h"
#include "datasets/reproduce/occupancy/scores.h"

namespace cairn::datasets {

std::vector<PaperFigure> CurveFigures(const OccupancyStudy& study, const StageResults& results) {
  const std::vector<InverseSonar> settings = InverseSonars();
  PaperTable table{{"setting", "open found", "closed found", "false cells", "wall missed"}, {}};
  std::map<std::string, report::Curve> curves;
  for (std::size_t k = 0; k < settings.size(); ++k) {
    std::map<bool, HallScores> scores;  // by whether the door is closed
    for (const HallCase& hall : study.halls) {
      const Blob& log = study.inputs.at(hall.name);
      scores[hall.closed].Add(
          EvaluateGrid(ResultOf(results, hall.name + "_setting_" + std::to_string(k)), log).map, 0);
    }
    HallScores &open = scores[false], &closed = scores[true];
    const double missed = (open.missed + closed.missed) / std::max(open.due + closed.due, 1.0);
    table.rows.push_back(
        {SettingText(settings[k]), Say("%d of %d", open.doors_right, open.maps),
         Say("%d of %d", closed.doors_right, closed.maps),
         Say("%.1f", (open.false_occupied + closed.false_occupied) / (open.maps + closed.maps)),
         Say("%.1f%%", 100 * missed)});
    const std::string shape = Say("wall %.2f m%s", settings[k].wall_m, settings[k].graded ? ", graded" : "");
    const auto [at, is_new] = curves.try_emplace(shape);
    report::Curve& curve = at->second;
    curve.name = shape;
    if (is_new) curve.colour = curves.size() - 1;
    curve.dots = true;
    curve.points.push_back({100 * (1 - missed), 100.0 * open.doors_right / open.maps});
  }
  report::LineChart plot;
  plot.title = "evidence_map: walls against doors";
  plot.x_label = "wall cells found [%]";
  plot.y_label = "open doors found [%]";
  for (const auto& [shape, curve] : curves) plot.curves.push_back(curve);
  plot.y_low = 0;
  plot.y_high = 100;
  return {{.file = "curve.png",
           .title = "Section 4: walls found against doors found, by the inverse model's parameters",
           .claim =
               "One setting misses the wall, another identifies large fractions of it but none of the doors.",
           .measured =
               "of p_occupied and p_free only the ratio of their log-odds counts for what is above a half",
           .png = report::ChartsPicture({plot}, 1, 520, 320).Png(),
           .table = table}};
}
}  // namespace cairn::datasets
