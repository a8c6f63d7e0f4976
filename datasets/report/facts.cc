#include "datasets/report/facts.h"

#include <cmath>

#include "datasets/confidence.h"
#include "datasets/report/format.h"
#include "datasets/report/parts.h"

namespace cairn::datasets::report {
namespace {

std::string RobotPrefix(std::size_t r) { return "robot/" + std::to_string(r) + "/"; }

std::string Metres(const std::optional<double>& value, int digits = 2) {
  return value ? Grouped(*value, digits) + " m" : "–";
}

struct LogFacts {
  double way_m = 0;
  double seconds = 0;
  std::int64_t controls = 0;
  std::int64_t observations = 0;
};

LogFacts FactsOf(const Blob& log, std::size_t r) {
  LogFacts facts;
  const std::string robot = RobotPrefix(r);
  for (const double forward : log.Get<double>(robot + "odometry/forward_m")) facts.way_m += std::abs(forward);
  const auto time = log.Get<double>(robot + "odometry/time_s");
  if (!time.empty()) facts.seconds = time.back() - time.front();
  facts.controls = static_cast<std::int64_t>(time.size());
  facts.observations = log.at(robot + "observations/time_s").size();
  return facts;
}

std::string LegendItem(const std::string& drawing, const std::string& what) {
  return "<li><svg viewBox=\"0 0 26 14\" aria-hidden=\"true\">" + drawing + "</svg>" + Escape(what) +
         "</li>\n";
}

}  // namespace

std::string LeadHtml(const Blob& result, const Blob* log) {
  const std::size_t robots = result.Texts("robots").size();
  std::string text = Count(static_cast<std::int64_t>(robots), "robot");
  if (log != nullptr) {
    LogFacts sum;
    for (std::size_t r = 0; r < robots; ++r) {
      const LogFacts facts = FactsOf(*log, r);
      sum.way_m += facts.way_m;
      sum.seconds += facts.seconds;
      sum.observations += facts.observations;
    }
    text += ", " + Grouped(sum.way_m) + " m of odometry in " + Duration(sum.seconds) + " of driving, " +
            Count(sum.observations, "landmark observation");
  }
  text += ". The map has " + Count(result.at("map/landmark_x_m").size(), "landmark") + ".";
  if (RefinementRefused(result))
    text += " Its refinement was " + NotRefined(result) + "; the landmarks stand where EM left them.";
  return text;
}

std::string TilesHtml(const Blob& result, const Evaluation* evaluation) {
  std::string tiles;
  if (evaluation != nullptr && evaluation->landmarks) {
    const LandmarkScore& score = *evaluation->landmarks;
    const bool all = score.missed == 0 && score.spurious == 0;
    tiles +=
        TileHtml(std::to_string(score.found) + " of " + std::to_string(score.found + score.missed),
                 "landmarks found" + (score.spurious > 0 ? ", " + std::to_string(score.spurious) + " spurious"
                                                         : std::string()),
                 all ? "good" : "");
    tiles += TileHtml(Metres(score.rmse_m), "landmark error, RMSE");
  } else {
    tiles += TileHtml(std::to_string(result.at("map/landmark_x_m").size()), "landmarks in the map");
  }
  if (evaluation != nullptr && evaluation->trajectory_rmse_m) {
    tiles += TileHtml(Metres(evaluation->trajectory_rmse_m), evaluation->robots.size() > 1
                                                                 ? "trajectory error, RMSE, worst robot"
                                                                 : "trajectory error, RMSE");
  }
  if (evaluation != nullptr && evaluation->topology_correct) {
    const bool correct = *evaluation->topology_correct;
    tiles += TileHtml(correct ? "right" : "wrong", "topology", correct ? "good" : "bad");
  }
  if (result.Has("history/log_likelihood")) {
    tiles += TileHtml(std::to_string(result.at("history/log_likelihood").size()), "iterations");
  }
  if (result.Has("provenance/seconds_s")) {
    tiles += TileHtml(Duration(result.Scalar<double>("provenance/seconds_s")), "wall time");
  }
  return "<div class=\"tiles\">\n" + tiles + "</div>\n";
}

std::string LegendHtml(const Scene& scene) {
  std::string items;
  for (const Path& path : scene.paths) {
    const std::string robot = " r" + std::to_string(path.index % kRobotColours) + "\"";
    items += LegendItem("<line class=\"path" + robot + " x1=\"1\" y1=\"7\" x2=\"25\" y2=\"7\"/>",
                        RobotTitle(path.robot));
  }
  items += LegendItem("<circle class=\"start\" cx=\"13\" cy=\"7\" r=\"5\"/>", "start");
  items += LegendItem(
      "<ellipse class=\"ellipse\" cx=\"13\" cy=\"7\" rx=\"11\" ry=\"6\"/><circle class=\"landmark\" "
      "cx=\"13\" cy=\"7\" r=\"3.2\"/>",
      "landmark and its 95% region");
  if (!scene.truth_landmarks.empty()) {
    items += LegendItem("<circle class=\"truth-landmark\" cx=\"13\" cy=\"7\" r=\"5.6\"/>", "true landmark");
    items += LegendItem("<line class=\"miss\" x1=\"2\" y1=\"7\" x2=\"24\" y2=\"7\"/>", "error");
  }
  if (!scene.truth_paths.empty()) {
    items += LegendItem("<line class=\"truth-path\" x1=\"1\" y1=\"7\" x2=\"25\" y2=\"7\"/>", "true path");
  }
  for (const MapLandmark& landmark : scene.landmarks) {
    if (!landmark.spurious) continue;
    items +=
        LegendItem("<circle class=\"landmark spurious\" cx=\"13\" cy=\"7\" r=\"3.2\"/>", "spurious landmark");
    break;
  }
  return "<ul class=\"legend\">\n" + items + "</ul>\n";
}

std::string RobotsTableHtml(const Blob& result, const Blob* log, const Evaluation* evaluation) {
  const std::vector<std::string> names = result.Texts("robots");
  std::vector<std::string> head = {"robot", "poses"};
  if (log != nullptr) head.insert(head.end(), {"way", "time", "controls", "observations"});
  if (evaluation != nullptr) head.insert(head.end(), {"position RMSE", "heading RMSE"});
  std::string rows = RowHtml(head, "th");
  for (std::size_t r = 0; r < names.size(); ++r) {
    const auto poses = static_cast<double>(result.at(RobotPrefix(r) + "poses/time_s").size());
    std::vector<std::string> cells = {RobotTitle(names[r]), Grouped(poses)};
    if (log != nullptr) {
      const LogFacts facts = FactsOf(*log, r);
      cells.insert(cells.end(), {Grouped(facts.way_m) + " m", Duration(facts.seconds),
                                 Grouped(static_cast<double>(facts.controls)),
                                 Grouped(static_cast<double>(facts.observations))});
    }
    if (evaluation != nullptr) {
      const RobotScore& score = evaluation->robots.at(r);
      const auto& heading = score.heading_rmse_rad;
      cells.push_back(Metres(score.rmse_m));
      cells.push_back(heading ? Grouped(*heading * 57.29577951308232, 1) + "°" : "–");
    }
    rows += RowHtml(cells);
  }
  return "<div class=\"scroll\"><table>\n" + rows + "</table></div>\n";
}

std::string LandmarksTableHtml(const Scene& scene) {
  const bool scored = !scene.truth_landmarks.empty();
  std::vector<std::string> head = {"landmark", "x", "y", "95% within", "observations"};
  if (scored) head.emplace_back("error");
  std::string rows = RowHtml(head, "th");
  for (const MapLandmark& landmark : scene.landmarks) {
    std::vector<std::string> cells = {landmark.name, Grouped(landmark.at.x_m, 2) + " m",
                                      Grouped(landmark.at.y_m, 2) + " m", Metres(landmark.ellipse.major_m),
                                      Grouped(landmark.count, 1)};
    if (scored) cells.push_back(landmark.spurious ? "spurious" : Metres(landmark.error_m));
    rows += RowHtml(cells);
  }
  return "<div class=\"scroll\"><table>\n" + rows + "</table></div>\n";
}

std::vector<Iteration> Iterations(const Blob& result) {
  std::vector<Iteration> iterations;
  if (!result.Has("history/log_likelihood")) return iterations;
  const auto values = result.Get<double>("history/log_likelihood");
  const auto prefix = result.Get<double>("history/prefix");
  const auto robots = result.Get<std::int64_t>("history/robots");
  if (prefix.size() != values.size() || robots.size() != values.size()) {
    throw InputError("the columns of 'history/' differ in length");
  }
  for (std::size_t i = 0; i < values.size(); ++i) iterations.push_back({values[i], prefix[i], robots[i]});
  return iterations;
}

std::vector<RoundTime> RoundTimes(const Blob& result) {
  std::vector<RoundTime> rounds;
  if (!result.Has("provenance/round/seconds_s")) return rounds;
  const auto seconds = result.Get<double>("provenance/round/seconds_s");
  const auto compute = result.Get<double>("provenance/round/compute_s");
  const auto tasks = result.Get<std::int64_t>("provenance/round/tasks");
  const std::vector<std::string> notes = result.Texts("provenance/round/note");
  std::vector<std::int64_t> counts;  // older files: each row is a round
  if (result.Has("provenance/round/rounds")) {
    const auto stored = result.Get<std::int64_t>("provenance/round/rounds");
    counts.assign(stored.begin(), stored.end());
    if (counts.size() != seconds.size())
      throw InputError("the columns of 'provenance/round/' differ in length");
  }
  if (compute.size() != seconds.size() || tasks.size() != seconds.size() || notes.size() != seconds.size()) {
    throw InputError("the columns of 'provenance/round/' differ in length");
  }
  for (std::size_t i = 0; i < seconds.size(); ++i)
    rounds.push_back({notes[i], seconds[i], compute[i], tasks[i], counts.empty() ? 1 : counts[i]});
  return rounds;
}

std::string ProvenanceHtml(const Blob& result) {
  std::string text;
  if (result.Has("provenance/job_yaml")) {
    text += "<pre>" + Escape(result.Text("provenance/job_yaml")) + "</pre>\n";
  }
  return text;
}

}  // namespace cairn::datasets::report
