#include "datasets/evaluate/window_scores_print.h"

#include <cmath>
#include <cstdio>

namespace cairn::datasets {
namespace {

using Json = nlohmann::ordered_json;

void PutScore(const Score& score, bool any, Json* json) {
  (*json)["posterior_error_m"] = any ? Json(score.posterior_error_m) : Json(nullptr);
  (*json)["error_reduction"] = score.error_reduction ? Json(*score.error_reduction) : Json(nullptr);
  const auto& interval = score.interval_95;
  (*json)["error_reduction_95"] = interval ? Json({interval->low, interval->high}) : Json(nullptr);
}

Json WindowScoreJson(const WindowScore& score) {
  const bool any = score.truths > 0;
  Json json = {{"window_m", WindowJson(score.window_m)},
               {"truths", score.truths},
               {"left_out", score.left_out},
               {"prior_error_m", any ? Json(score.prior_error_m) : Json(nullptr)}};
  PutScore(score.soft, any, &json);
  Json sampled;
  PutScore(score.sampled, any, &sampled);
  sampled["error_reduction_sd"] = any ? Json(score.sampled_sd) : Json(nullptr);
  json["sampled"] = sampled;
  json["interval_over"] = score.interval_over;
  json["clusters"] = score.clusters;
  return json;
}

// snprintf, as a string.
template <class... Values>
std::string Formatted(const char* format, Values... values) {
  char text[160];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

std::string ReductionText(const Score& score) {
  if (!score.error_reduction) return "unknown";
  std::string text = Formatted("%5.1f%%", 100 * *score.error_reduction);
  if (score.interval_95)
    text += Formatted(" [%.1f, %.1f]", 100 * score.interval_95->low, 100 * score.interval_95->high);
  return text;
}

std::string WindowRow(const WindowScore& score) {
  const std::string window = WindowText(score.window_m);
  const std::string counts =
      Formatted("%-8s %7lld %9lld  ", window.c_str(), static_cast<long long>(score.truths),
                static_cast<long long>(score.left_out));
  if (score.truths == 0) return counts + "no training sample is that near\n";
  return counts +
         Formatted("%8.3f %12.3f  %-21s %10.3f  %-21s %5.1f", score.prior_error_m,
                   score.soft.posterior_error_m, ReductionText(score.soft).c_str(),
                   score.sampled.posterior_error_m, ReductionText(score.sampled).c_str(),
                   100 * score.sampled_sd) +
         "\n";
}

std::string IntervalText(const std::vector<WindowScore>& scores) {
  const WindowScore& widest = scores.back();
  return "intervals  95%, by a bootstrap over " + std::to_string(widest.clusters) + " " +
         (widest.interval_over == "runs" ? "runs"
                                         : "blocks of consecutive samples: one run does not say how "
                                           "runs differ") +
         "\n";
}

}  // namespace

nlohmann::ordered_json WindowJson(double window_m) {
  return std::isinf(window_m) ? Json(nullptr) : Json(window_m);
}

nlohmann::ordered_json WindowScoresJson(const std::vector<WindowScore>& scores) {
  Json windows = Json::array();
  for (const WindowScore& score : scores) windows.push_back(WindowScoreJson(score));
  return windows;
}

std::string WindowText(double window_m) {
  return std::isinf(window_m) ? "global" : Formatted("+-%g m", window_m);
}

std::string HeadingText(double heading_window_deg) {
  return " that face alike; the robot " +
         (heading_window_deg < 180 ? Formatted("knows its heading to within %g degrees", heading_window_deg)
                                   : std::string("does not know its heading"));
}

std::string WindowScoresText(const std::vector<WindowScore>& scores) {
  std::string text = IntervalText(scores);
  text += "\n                                       of soft f                           of sampled f\n";
  text += Formatted("%-8s %7s %9s  %8s %12s  %-21s %10s  %-21s %5s", "window", "truths", "left out",
                    "prior m", "posterior m", "reduction [95%]", "post. m", "reduction [95%]", "sd %") +
          "\n";
  for (const WindowScore& score : scores) text += WindowRow(score);
  return text;
}

std::string Joined(const std::vector<std::string>& names) {
  std::string joined;
  for (const std::string& name : names) joined += (joined.empty() ? "" : ", ") + name;
  return joined;
}

}  // namespace cairn::datasets
