#include <vector>

#include "datasets/report/drawing/format.h"
#include "datasets/report/pages/facts.h"
#include "datasets/report/pages/pages.h"
#include "datasets/report/pages/parts.h"
#include "datasets/report/pictures.h"
#include "datasets/report/scene.h"

namespace cairn::datasets::report {
namespace {

std::string MapCaption(const Scene& scene, const Evaluation* evaluation) {
  std::string caption = "Paths are the most likely poses.";
  if (NamedLandmarks(scene).size() < scene.landmarks.size())
    caption += " Landmarks without an identity are not named, being " +
               Grouped(static_cast<double>(scene.landmarks.size())) + "; the table below has them all.";
  else if (!scene.landmarks.empty())
    caption += " A name that would cover another is left out; point at the landmark to see it.";
  if (evaluation != nullptr && evaluation->aligned_on == "poses")
    caption += " Truth was laid over the result by one rigid motion, fitted to the poses of all robots.";
  if (evaluation != nullptr && evaluation->aligned_on == "landmarks")
    caption += " Truth was laid over it by one rigid motion, fitted to the landmarks.";
  return caption;
}

std::string BeforeAfterCaption(const Scene& scene) {
  std::string caption = "Both at one scale, each path from its first most likely pose.";
  bool marks = false;
  for (const Path& path : scene.odometry_marks) marks = marks || !path.points.empty();
  if (marks) caption += " Dots: where raw odometry has the robot when it is at a landmark.";
  return caption;
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

}  // namespace

std::string LandmarkMapHtml(const Blob& result, const Blob* log, const Evaluation* evaluation) {
  Check(result, log, evaluation);
  const Scene scene = MakeScene(result, log, evaluation);
  const std::vector<Iteration> iterations = Iterations(result);
  std::string html = "<p class=\"lead\">" + Escape(LeadHtml(result, log)) + "</p>\n";
  html += TilesHtml(result, evaluation);
  html += SectionHtml(
      "Map", LegendHtml(LegendOf(scene)) + DrawingHtml([&](double width) { return MapPicture(scene, width); },
                                                       MapCaption(scene, evaluation)));
  html += SectionHtml(
      "Before and after",
      DrawingHtml([&](double width) { return BeforeAfterPicture(scene, width); }, BeforeAfterCaption(scene)));
  html += SectionHtml("Landmark probability",
                      DrawingHtml([&](double width) { return GridPicture(scene, width); },
                                  "P(landmark) of each cell, the largest over the landmark types; a "
                                  "colour's strength goes with the root, so that doubt shows."));
  html += SectionHtml(
      "Convergence",
      DrawingHtml(
          [&](double width) { return LikelihoodPicture(iterations, width); },
          "Of the data under the map with which the iteration began, from the first that had one: iteration "
          "0 has no map, and is left out. A line joins iterations over the same data; hollow points are of a "
          "part of the data."));
  html += SectionHtml("Time", TimeHtml(RoundTimes(result)));
  html += SectionHtml("Robots", RobotsTableHtml(result, log, evaluation));
  return html + SectionHtml("Landmarks", scene.landmarks.empty() ? "" : LandmarksTableHtml(scene));
}

}  // namespace cairn::datasets::report
