#include "datasets/report/report.h"

#include <vector>

#include "datasets/report/facts.h"
#include "datasets/report/figures.h"
#include "datasets/report/format.h"
#include "datasets/report/scene.h"
#include "datasets/report/style.h"

namespace cairn::datasets {
namespace report {
namespace {

std::string Section(const std::string& title, const std::string& body) {
  return body.empty() ? "" : "<section>\n<h2>" + title + "</h2>\n" + body + "</section>\n";
}

std::string Figure(const std::string& drawing, const std::string& caption) {
  return drawing.empty() ? ""
                         : "<figure>\n" + drawing + "<figcaption>" + caption + "</figcaption>\n</figure>\n";
}

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
  return Figure(
      LikelihoodFigure(iterations),
      "Of the data under the map with which the iteration began. A line joins iterations over the same "
      "data; hollow points are of a part of the data, or had no map to begin with.");
}

std::string TimeSection(const std::vector<RoundTime>& rounds) {
  double seconds = 0, compute = 0;
  std::int64_t tasks = 0;
  for (const RoundTime& round : rounds) {
    seconds += round.seconds;
    compute += round.compute_seconds;
    tasks += round.tasks;
  }
  return Figure(RoundsFigure(rounds), Count(static_cast<std::int64_t>(rounds.size()), "round") + " with " +
                                          Count(tasks, "task") + ": " + Duration(seconds) +
                                          " of wall time, " + Duration(compute) + " of computing.");
}

std::string Footer(const Blob& result) {
  std::string text = "Made by Cairn";
  if (result.Has("provenance/version")) text += " " + Escape(result.Text("provenance/version"));
  if (result.Has("provenance/workers")) {
    text += " with " + Count(result.Scalar<std::int64_t>("provenance/workers"), "worker");
  }
  return "<footer>" + text + ". Lengths in metres, headings counter-clockwise.</footer>\n";
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
  std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
      Escape(options.title) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n<main>\n";
  html +=
      "<h1>" + Escape(options.title) + "</h1>\n<p class=\"lead\">" + Escape(LeadHtml(result, log)) + "</p>\n";
  html += TilesHtml(result, evaluation);
  html += Section("Map", LegendHtml(scene) + Figure(MapFigure(scene), MapCaption(evaluation)));
  html += Section("Before and after", Figure(BeforeAfterFigure(scene), BeforeAfterCaption(scene)));
  html += Section("Landmark probability",
                  Figure(GridFigure(scene),
                         "P(landmark) of each cell, the largest over the landmark types; a "
                         "colour's strength goes with the root, so that doubt shows."));
  html += Section("Convergence", LikelihoodSection(Iterations(result)));
  html += Section("Time", TimeSection(RoundTimes(result)));
  html += Section("Robots", RobotsTableHtml(result, log, evaluation));
  html += Section("Landmarks", scene.landmarks.empty() ? "" : LandmarksTableHtml(scene));
  html += Section("Job", ProvenanceHtml(result));
  return html + Footer(result) + "</main>\n</body>\n</html>\n";
}

}  // namespace
}  // namespace report

std::string ReportHtml(const Blob& result, const Blob* log, const Evaluation* evaluation,
                       const ReportOptions& options) {
  return report::Page(result, log, evaluation, options);
}

}  // namespace cairn::datasets
