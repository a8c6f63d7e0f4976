#include <cstdio>
#include <nlohmann/json.hpp>

#include "datasets/evaluate/evaluate.h"

namespace cairn::datasets {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
Json OrNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json LandmarksJson(const std::optional<LandmarkScore>& score) {
  Json json = {{"found", nullptr},     {"missed", nullptr}, {"spurious", nullptr},
               {"within_3m", nullptr}, {"rmse_m", nullptr}, {"rmse_similarity_m", nullptr},
               {"gospa_m", nullptr}};
  if (!score) return json;
  json["found"] = score->found;
  json["missed"] = score->missed;
  json["spurious"] = score->spurious;
  json["within_3m"] = score->within_3m;
  json["rmse_m"] = OrNull(score->rmse_m);
  json["rmse_similarity_m"] = OrNull(score->rmse_similarity_m);
  json["gospa_m"] = score->gospa_m;
  return json;
}

std::string ScoreLine(const std::string& name, const std::string& value) {
  return name + std::string(name.size() < 32 ? 32 - name.size() : 1, ' ') + value + "\n";
}

std::string Number(const std::optional<double>& value, const char* unit) {
  if (!value) return "unknown";
  char text[64];
  std::snprintf(text, sizeof text, "%.3f %s", *value, unit);
  return text;
}

std::string Angle(const std::optional<double>& value_rad) {
  constexpr double kDegree = 57.29577951308232;
  return value_rad ? Number(*value_rad * kDegree, "deg") : Number(value_rad, "deg");
}

double Share(std::int64_t n, std::int64_t of) { return static_cast<double>(n) / static_cast<double>(of); }

std::string LandmarksText(const LandmarkScore& score) {
  std::string text =
      ScoreLine("landmarks.found", std::to_string(score.found) + " of " +
                                       std::to_string(score.found + score.missed) + " observed");
  text += ScoreLine("landmarks.missed", std::to_string(score.missed));
  text += ScoreLine("landmarks.spurious", std::to_string(score.spurious));
  text += ScoreLine("landmarks.within_3m", std::to_string(score.within_3m));
  text += ScoreLine("landmarks.rmse_m", Number(score.rmse_m, "m"));
  text += ScoreLine("landmarks.rmse_similarity_m", Number(score.rmse_similarity_m, "m"));
  text += ScoreLine("landmarks.gospa_m", Number(score.gospa_m, "m"));
  return text;
}

Json TopologyJson(const Evaluation& evaluation) {
  const auto count = [&](std::int64_t n) { return evaluation.topology_correct ? Json(n) : Json(nullptr); };
  const auto share = [&](std::int64_t n, std::int64_t of) {
    return evaluation.topology_correct && of > 0 ? Json(Share(n, of)) : Json(nullptr);
  };
  return {{"correct", OrNull(evaluation.topology_correct)},
          {"associations", count(evaluation.associations)},
          {"wrong", count(evaluation.wrong)},
          {"wrong_share", share(evaluation.wrong, evaluation.associations)},
          {"observations", count(evaluation.observations)},
          {"unused", count(evaluation.unused)},
          {"unused_share", share(evaluation.unused, evaluation.observations)}};
}

std::string CountOf(std::int64_t n, std::int64_t of, const char* what) {
  char text[96];
  std::snprintf(text, sizeof text, of > 0 ? "%lld of %lld %s (%.1f%%)" : "%lld of %lld %s",
                static_cast<long long>(n), static_cast<long long>(of), what,
                of > 0 ? 100 * Share(n, of) : 0.0);
  return text;
}

std::string TopologyText(const Evaluation& evaluation) {
  const auto& correct = evaluation.topology_correct;
  std::string text = ScoreLine("topology.correct", !correct ? "unknown" : *correct ? "yes" : "no");
  if (!correct) return text;
  text += ScoreLine("topology.wrong", CountOf(evaluation.wrong, evaluation.associations, "associations"));
  text += ScoreLine("topology.unused",
                    CountOf(evaluation.unused, evaluation.observations, "observations of landmarks"));
  return text;
}

}  // namespace

std::string EvaluationJson(const Evaluation& evaluation, int indent) {
  Json robots = Json::array();
  for (const RobotScore& robot : evaluation.robots) {
    robots.push_back({{"name", robot.name},
                      {"rmse_m", OrNull(robot.rmse_m)},
                      {"heading_rmse_rad", OrNull(robot.heading_rmse_rad)},
                      {"poses", robot.poses}});
  }
  Json json;
  json["landmarks"] = LandmarksJson(evaluation.landmarks);
  json["trajectory"] = {{"rmse_m", OrNull(evaluation.trajectory_rmse_m)}, {"robots", robots}};
  json["topology"] = TopologyJson(evaluation);
  json["iterations"] = evaluation.iterations;
  json["seconds"] = OrNull(evaluation.seconds);
  if (!evaluation.refinement_refused.empty()) json["refinement"] = evaluation.refinement_refused;
  json["alignment"] = {{"on", evaluation.aligned_on},
                       {"angle_rad", evaluation.alignment.angle_rad},
                       {"x_m", evaluation.alignment.x_m},
                       {"y_m", evaluation.alignment.y_m},
                       {"scale_if_fitted", evaluation.scale}};
  return json.dump(indent);
}

std::string EvaluationText(const Evaluation& evaluation) {
  std::string text;
  if (evaluation.landmarks)
    text += LandmarksText(*evaluation.landmarks);
  else
    text += ScoreLine("landmarks", "unknown: the truth has none");
  text += ScoreLine("trajectory.rmse_m", Number(evaluation.trajectory_rmse_m, "m, the worst robot"));
  for (const RobotScore& robot : evaluation.robots) {
    text +=
        ScoreLine("  " + robot.name, Number(robot.rmse_m, "m") +
                                         (robot.rmse_m ? ", heading " + Angle(robot.heading_rmse_rad) : ""));
  }
  text += TopologyText(evaluation);
  text += ScoreLine("iterations", std::to_string(evaluation.iterations));
  text += ScoreLine("seconds", Number(evaluation.seconds, "s"));
  if (!evaluation.refinement_refused.empty()) text += ScoreLine("refinement", evaluation.refinement_refused);
  text += ScoreLine("aligned on", evaluation.aligned_on);
  return text;
}

}  // namespace cairn::datasets
