#include "datasets/report/report.h"

#include <vector>

#include "datasets/report/facts.h"
#include "datasets/report/figures.h"
#include "datasets/report/format.h"
#include "datasets/report/grid_page.h"
#include "datasets/report/local_page.h"
#include "datasets/report/localization_page.h"
#include "datasets/report/networks_page.h"
#include "datasets/report/parts.h"
#include "datasets/report/scene.h"

namespace cairn::datasets {
namespace report {
namespace {

std::string MapCaption(const Evaluation* evaluation) {
  std::string caption = "Paths are the most likely poses. ";
  if (evaluation == nullptr) return caption;
  if (evaluation->aligned_on == "poses")
    caption += "Truth was laid over the result by one rigid motion, fitted to ";
  else if (evaluation->aligned_on == "landmarks")
    caption += "Truth was laid over it by one rigid motion, fitted to ";
  else
    return caption;
  return caption + (evaluation->aligned_on == "poses" ? "the poses of all robots." : "the landmarks.");
}

std::string BeforeAfterCaption(const Scene& scene) {
  std::string caption = "Both at one scale, each path from its first corrected pose.";
  bool marks = false;
  for (const Path& path : scene.odometry_marks) marks = marks || !path.points.empty();
  if (marks) caption += " Dots on the left: where raw odometry has the robot when it is at a landmark.";
  return caption;
}

std::string LikelihoodSection(const std::vector<Iteration>& iterations) {
  return FigureHtml(
      LikelihoodFigure(iterations),
      "Of the data under the map with which the iteration began. A line joins iterations over the same "
      "data; hollow points are of a part of the data, or had no map to begin with.");
}

void Check(const Blob& result, const Blob* log, const Evaluation* evaluation) {
  for (const char* name : {"robots", "map/landmark_x_m", "map/landmark_y_m"}) {
    if (!result.Has(name)) throw InputError(std::string("not a landmark_map: '") + name + "' is missing");
  }
  if (log != nullptr && log->Texts("robots") != result.Texts("robots")) {
    throw InputError("the log's robots are not the result's: was it made from this log?");
  }
  CAIRN_DEMAND(evaluation == nullptr || evaluation->robots.size() == result.Texts("robots").size(),
               "an evaluation of this result");
}

std::string Page(const Blob& result, const Blob* log, const Evaluation* evaluation,
                 const ReportOptions& options) {
  Check(result, log, evaluation);
  const Scene scene = MakeScene(result, log, evaluation);
  std::string html = "<p class=\"lead\">" + Escape(LeadHtml(result, log)) + "</p>\n";
  html += TilesHtml(result, evaluation);
  html += SectionHtml("Map", LegendHtml(scene) + FigureHtml(MapFigure(scene), MapCaption(evaluation)));
  html += SectionHtml("Before and after", FigureHtml(BeforeAfterFigure(scene), BeforeAfterCaption(scene)));
  html += SectionHtml("Landmark probability",
                      FigureHtml(GridFigure(scene),
                                 "P(landmark) of each cell, the largest over the landmark types; a "
                                 "colour's strength goes with the root, so that doubt shows."));
  html += SectionHtml("Convergence", LikelihoodSection(Iterations(result)));
  html += SectionHtml("Time", TimeHtml(RoundTimes(result)));
  html += SectionHtml("Robots", RobotsTableHtml(result, log, evaluation));
  html += SectionHtml("Landmarks", scene.landmarks.empty() ? "" : LandmarksTableHtml(scene));
  html += SectionHtml("Job", ProvenanceHtml(result));
  return PageHtml(options.title, html, result);
}

}  // namespace
}  // namespace report

std::string ReportHtml(const Blob& result, const Blob* log, const Evaluation* evaluation,
                       const ReportOptions& options) {
  return report::Page(result, log, evaluation, options);
}

std::string NetworksReportHtml(const Blob& result, const std::string& title) {
  return report::PageHtml(title, report::NetworksHtml(result), result);
}

std::string LocalizationReportHtml(const Blob& result, const Blob* samples, const std::string& title) {
  return report::PageHtml(title, report::LocalizationHtml(result, samples), result);
}

std::string GridMapReportHtml(const Blob& map, const Blob* log, const GridEvaluation* evaluation,
                              const std::string& title) {
  return report::PageHtml(title, report::GridMapHtml(map, log, evaluation), map);
}

std::string LocalMapReportHtml(const Blob& result, const Blob* log, const LocalEvaluation* evaluation,
                               const std::string& title) {
  return report::PageHtml(title, report::LocalHtml(result, log, evaluation), result);
}

}  // namespace cairn::datasets
