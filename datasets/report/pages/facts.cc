#include "datasets/report/pages/facts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "datasets/report/drawing/format.h"
#include "datasets/report/pages/parts.h"
#include "schema/kinds/landmark_map.h"
#include "schema/kinds/log.h"
#include "schema/kinds/provenance.h"

namespace cairn::datasets::report {
namespace {

std::string Metres(const std::optional<double>& value, int digits = 2) {
  return value ? Grouped(*value, digits) + " m" : "–";
}

struct LogFacts {
  double travelled_m = 0;
  double seconds = 0;
  std::int64_t controls = 0;
  std::int64_t observations = 0;
};

LogFacts FactsOf(const kinds::Log::Robot& robot) {
  LogFacts facts;
  for (const double forward : robot.odometry.forward_m) facts.travelled_m += std::abs(forward);
  const std::span<const double> time = robot.odometry.time_s;
  if (!time.empty()) facts.seconds = time.back() - time.front();
  facts.controls = static_cast<std::int64_t>(time.size());
  facts.observations = static_cast<std::int64_t>(robot.observations.time_s.size());
  return facts;
}

// What stands in double quotes from `at` on, as a job's YAML has it.
std::string Unquoted(std::string_view line, std::size_t at) {
  std::string text;
  for (++at; at < line.size() && line[at] != '"'; ++at) {
    if (line[at] == '\\' && at + 1 < line.size()) ++at;
    text += line[at];
  }
  return text;
}

// A file's name without its folder and its ending.
std::string StemOf(const std::string& path) {
  const std::size_t slash = path.find_last_of('/'), begin = slash == std::string::npos ? 0 : slash + 1;
  const std::size_t dot = path.find_last_of('.');
  return path.substr(begin, dot == std::string::npos || dot <= begin ? std::string::npos : dot - begin);
}

// The job's name, and its input files by name.
struct JobNames {
  std::string name;
  std::map<std::string, std::string> inputs;
};

// Of the YAML that the coordinator writes: `name: "…"` and, under `inputs:`, lines of `  log: "…"`.
JobNames NamesIn(const std::string& yaml) {
  JobNames names;
  bool inputs = false;
  std::istringstream lines(yaml);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(':'), quote = line.find('"');
    if (!line.starts_with(' ')) inputs = line.starts_with("inputs:");
    if (colon == std::string::npos || quote == std::string::npos || quote < colon) continue;
    if (line.starts_with("name:")) names.name = Unquoted(line, quote);
    if (inputs && line.starts_with("  ")) names.inputs[line.substr(2, colon - 2)] = Unquoted(line, quote);
  }
  return names;
}

}  // namespace

std::string LeadHtml(const Blob& result, const Blob* log) {
  const std::size_t robots = result.Texts("robots").size();
  std::string text = Count(static_cast<std::int64_t>(robots), "robot");
  if (log != nullptr) {
    LogFacts sum;
    for (const kinds::Log::Robot& robot : Read<kinds::Log>(*log).robot) {
      const LogFacts facts = FactsOf(robot);
      sum.travelled_m += facts.travelled_m;
      sum.seconds += facts.seconds;
      sum.observations += facts.observations;
    }
    text += ", " + Grouped(sum.travelled_m) + " m of odometry in " + Duration(sum.seconds) + " of driving, " +
            Count(sum.observations, "landmark observation");
  }
  text += ". The map has " + Count(result.at("map/landmark_x_m").size(), "landmark") + ".";
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
    tiles += CountTileHtml(result.at("history/log_likelihood").size(), "iteration");
  }
  return TilesHtml(tiles + WallTimeTile(result));
}

std::string WallTimeTile(const Blob& result) {
  const auto seconds = kinds::Provenance::In(result).seconds_s.Optional();
  return seconds ? TileHtml(Duration(*seconds), "wall time") : "";
}

std::string TitleOf(const Blob& result) {
  const Texts yaml = kinds::Provenance::In(result).job_yaml;
  if (!yaml) return {};
  const JobNames names = NamesIn(yaml.Scalar());
  // The log, or what else it is of; networks and tables of errors that a job reads beside it are none of
  // these.
  std::string of;
  for (const char* input : {"log", "samples"}) {
    const auto found = names.inputs.find(input);
    if (found != names.inputs.end() && of.empty()) of = StemOf(found->second);
  }
  if (of.empty() && names.inputs.size() == 1) of = StemOf(names.inputs.begin()->second);
  constexpr std::size_t kMostNamed = 3;
  if (of.empty() && names.inputs.size() <= kMostNamed) {
    for (const auto& [name, path] : names.inputs) of += (of.empty() ? "" : ", ") + StemOf(path);
  }
  if (of.empty() || of == names.name) return names.name;
  return names.name.empty() ? of : of + ": " + names.name;
}

std::string RobotsTableHtml(const Blob& result, const Blob* log, const Evaluation* evaluation) {
  const auto map = Read<kinds::LandmarkMap>(result);
  const auto in_log = Read<kinds::Log>(log != nullptr ? *log : Blob());
  const std::vector<std::string>& names = map.robots.values();
  std::vector<std::string> head = {"robot", "poses"};
  if (log != nullptr) head.insert(head.end(), {"path", "time", "controls", "observations"});
  if (evaluation != nullptr) head.insert(head.end(), {"position RMSE", "heading RMSE"});
  Table rows{head};
  for (std::size_t r = 0; r < names.size(); ++r) {
    const auto poses = static_cast<double>(map.robot[r].poses.time_s.size());
    std::vector<std::string> cells = {RobotTitle(names[r]), Grouped(poses)};
    if (log != nullptr) {
      const LogFacts facts = FactsOf(in_log.robot.at(r));
      cells.insert(cells.end(), {Grouped(facts.travelled_m) + " m", Duration(facts.seconds),
                                 Grouped(static_cast<double>(facts.controls)),
                                 Grouped(static_cast<double>(facts.observations))});
    }
    if (evaluation != nullptr) {
      const RobotScore& score = evaluation->robots.at(r);
      const auto& heading = score.heading_rmse_rad;
      cells.push_back(Metres(score.rmse_m));
      cells.push_back(heading ? Grouped(*heading * 57.29577951308232, 1) + "°" : "–");
    }
    rows.push_back(std::move(cells));
  }
  return TableHtml(rows);
}

std::string LandmarksTableHtml(const Scene& scene) {
  const bool scored = !scene.truth_landmarks.empty();
  constexpr std::size_t kMostUnfolded = 30;
  std::vector<std::string> head = {"landmark", "x", "y", "95% within", "observations"};
  if (scored) head.emplace_back("error");
  Table rows{head};
  for (const MapLandmark& landmark : scene.landmarks) {
    std::vector<std::string> cells = {landmark.name, Grouped(landmark.at.x_m, 2) + " m",
                                      Grouped(landmark.at.y_m, 2) + " m", Metres(landmark.ellipse.major_m),
                                      Grouped(landmark.count, 1)};
    if (scored) cells.push_back(landmark.spurious ? "spurious" : Metres(landmark.error_m));
    rows.push_back(std::move(cells));
  }
  const std::string table = TableHtml(rows);
  if (scene.landmarks.size() <= kMostUnfolded) return table;
  return "<details><summary>All " + Grouped(static_cast<double>(scene.landmarks.size())) + "</summary>\n" +
         table + "</details>\n";
}

std::vector<Iteration> Iterations(const Blob& result) {
  std::vector<Iteration> iterations;
  const auto history = FieldsIn<kinds::LandmarkMap::History>("history/", result);
  for (std::size_t i = 0; i < history.log_likelihood.OrNone().size(); ++i)
    iterations.push_back({history.log_likelihood[i], history.prefix[i], history.robots[i]});
  return iterations;
}

std::vector<RoundTime> RoundTimes(const Blob& result) {
  std::vector<RoundTime> rounds;
  const kinds::Provenance::Rounds of = kinds::Provenance::In(result).round;
  for (std::size_t i = 0; i < of.seconds_s.OrNone().size(); ++i)  // in older files each row is a round
    rounds.push_back(
        {of.note[i], of.seconds_s[i], of.compute_s[i], of.tasks[i], of.rounds ? of.rounds[i] : 1});
  return rounds;
}

std::string ProvenanceHtml(const Blob& result) {
  std::string text;
  if (const Texts yaml = kinds::Provenance::In(result).job_yaml)
    text += "<pre>" + Escape(yaml.Scalar()) + "</pre>\n";
  return text;
}

}  // namespace cairn::datasets::report
