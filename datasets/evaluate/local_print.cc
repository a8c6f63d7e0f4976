#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "datasets/evaluate/local.h"

namespace cairn::datasets {
namespace {

using Json = nlohmann::ordered_json;

Json OrNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json WallsJson(const std::optional<WallScore>& walls) {
  if (!walls) return nullptr;
  return {{"error_deg", walls->error_deg},
          {"within_2_deg", walls->within_2_deg},
          {"first_lock_s", walls->first_lock_s},
          {"sweeps", walls->sweeps},
          {"other_area_found", OrNull(walls->other_area_found)},
          {"other_area_false", OrNull(walls->other_area_false)}};
}

std::string Line(const char* name, const char* format, double value, const std::string& more = "") {
  char text[200];
  std::snprintf(text, sizeof text, format, value);
  std::string line = name;
  line.resize(std::max<std::size_t>(32, line.size() + 1), ' ');
  return line + text + more + "\n";
}

std::string Metres(const char* format, double a, double b) {
  char text[100];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

std::string Count(std::int64_t count, const char* of) { return ", " + std::to_string(count) + " " + of; }

}  // namespace

std::string LocalEvaluationJson(const LocalEvaluation& score, int indent) {
  const auto& traces = score.traces;
  const Json json = {
      {"trajectory",
       {{"rmse_m", score.path.rmse_m},
        {"mean_m", score.path.mean_m},
        {"worst_m", score.path.worst_m},
        {"heading_rmse_deg", score.heading_rmse_deg},
        {"odometry_rmse_m", score.odometry.rmse_m},
        {"odometry_mean_m", score.odometry.mean_m},
        {"odometry_worst_m", score.odometry.worst_m},
        {"in_trace_rmse_m", traces ? Json(traces->rmse_m) : Json(nullptr)},
        {"in_trace_mean_m", traces ? Json(traces->mean_m) : Json(nullptr)},
        {"in_trace_worst_m", traces ? Json(traces->worst_m) : Json(nullptr)},
        {"in_trace_odometry_mean_m", traces ? Json(score.traces_odometry.mean_m) : Json(nullptr)},
        {"in_trace_corrected", traces ? Json(score.corrected) : Json(nullptr)},
        {"poses", score.path.poses}}},
      {"wall_orientation", WallsJson(score.walls)},
      {"loops",
       {{"found", score.loops.found},
        {"wrong", score.loops.wrong},
        {"mean_m", score.loops.mean_m},
        {"rejected", score.loops.rejected},
        {"rejected_wrong", score.loops.rejected_wrong}}},
      {"traces", score.trace_count},
      {"cuts", score.cuts},
      {"seconds", OrNull(score.seconds)},
      {"alignment",
       {{"angle_rad", score.alignment.angle_rad},
        {"x_m", score.alignment.x_m},
        {"y_m", score.alignment.y_m}}}};
  return json.dump(indent);
}

std::string LocalEvaluationText(const LocalEvaluation& score) {
  std::string text =
      Line("trajectory.rmse_m", "%.3f m", score.path.rmse_m,
           Metres(", %.3f m on average, %.3f m at worst", score.path.mean_m, score.path.worst_m)) +
      Line("trajectory.odometry_rmse_m", "%.3f m", score.odometry.rmse_m,
           Metres(", %.3f m on average, %.3f m at worst", score.odometry.mean_m, score.odometry.worst_m)) +
      Line("trajectory.heading_rmse_deg", "%.2f degrees", score.heading_rmse_deg);
  if (score.traces) {
    text += Line("trajectory.in_trace_mean_m", "%.3f m", score.traces->mean_m,
                 Metres(" in the traces' own frames, %.3f m at worst; corrected at %.0f%% of the sweeps",
                        score.traces->worst_m, 100 * score.corrected));
    text += Line("trajectory.in_trace_odometry_mean_m", "%.3f m", score.traces_odometry.mean_m,
                 " by odometry alone since they were recorded");
  }
  if (score.walls) {
    text += Line("wall_orientation.error_deg", "%.2f degrees", score.walls->error_deg,
                 Metres(" on average, under 2 at %.1f%% of the sweeps after the first lock (%.1f s)",
                        100 * score.walls->within_2_deg, score.walls->first_lock_s));
    if (score.walls->other_area_found) {
      text += Line("wall_orientation.other_area", "%.0f%%", 100 * *score.walls->other_area_found,
                   Metres(" of the sweeps in turned areas told, %.1f%% of the others taken for such%.0s",
                          100 * score.walls->other_area_false.value_or(0), 0));
    }
  }
  text += Line("loops.found", "%.0f", static_cast<double>(score.loops.found),
               Count(score.loops.wrong, "of them wrong") + Count(score.loops.rejected, "more rejected"));
  return text + Line("traces", "%.0f", static_cast<double>(score.trace_count), Count(score.cuts, "cuts"));
}

}  // namespace cairn::datasets
