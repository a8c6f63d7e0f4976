#include <cstdio>
#include <nlohmann/json.hpp>

#include "datasets/evaluate/localization.h"

namespace cairn::datasets {
namespace {

using Json = nlohmann::ordered_json;

Json ErrorJson(const MeanError& error) {
  Json json = {{"mean_m", error.mean_m}, {"mean_m_95", nullptr}};
  if (error.interval_95) json["mean_m_95"] = {error.interval_95->low, error.interval_95->high};
  return json;
}

std::string ErrorText(const MeanError& error) {
  char text[64];
  if (error.interval_95)
    std::snprintf(text, sizeof text, "%7.2f +-%5.2f", error.mean_m, error.interval_95->high - error.mean_m);
  else
    std::snprintf(text, sizeof text, "%7.2f        ", error.mean_m);
  return text;
}

std::string JoinedRuns(const std::vector<std::string>& names) {
  std::string joined;
  for (const std::string& name : names) joined += (joined.empty() ? "" : ", ") + name;
  return joined;
}

std::string Way(double way_m) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f m", way_m);
  return text;
}

// For people not every row: the first ones, then fewer and fewer.
bool IsShown(const LocalizationScore& score, std::size_t row) {
  return row <= 4 || (row <= 20 && row % 2 == 0) || row == 19 || row % 10 == 0 ||
         row + 1 == score.rows.size();
}

}  // namespace

std::string LocalizationScoreJson(const LocalizationScore& score, int indent) {
  Json rows = Json::array();
  for (const LocalizationRow& row : score.rows) {
    rows.push_back({{"sensations", row.sensations},
                    {"way_m", row.way_m},
                    {"traverses", row.traverses},
                    {"error", ErrorJson(row.believed)},
                    {"error_of_mean", ErrorJson(row.mean)},
                    {"error_of_mode", ErrorJson(row.mode)},
                    {"within_1m", row.within_1m},
                    {"facing", score.heading.empty() ? Json(nullptr) : Json(row.facing)}});
  }
  const auto under = score.under_1m_after_m;
  const Json json = {{"traverses", score.traverses},
                     {"runs", score.runs},
                     {"features", score.features},
                     {"places", score.places},
                     {"window_m", score.window_m > 0 ? Json(score.window_m) : Json(nullptr)},
                     {"heading", score.heading.empty() ? Json(nullptr) : Json(score.heading)},
                     {"against", score.against_truth ? "truth" : "labels"},
                     {"under_1m_after_m", under ? Json(*under) : Json(nullptr)},
                     {"rows", rows}};
  return json.dump(indent);
}

std::string LocalizationScoreText(const LocalizationScore& score) {
  std::string text = "traverses  " + std::to_string(score.traverses) + " of " + JoinedRuns(score.runs) +
                     "; " +
                     (score.window_m > 0 ? "at the start known to within " + Way(score.window_m)
                                         : std::string("nothing known at the start")) +
                     (score.heading.empty() ? "" : "; its heading " + score.heading) + "\nfeatures   " +
                     JoinedRuns(score.features) + ", over " + std::to_string(score.places) +
                     " places\nscored     against the samples' " +
                     (score.against_truth ? "truth" : "labels, which have errors of their own") +
                     "; 95% intervals over traverses\nunder 1 m  ";
  text += score.under_1m_after_m ? "after " + Way(*score.under_1m_after_m) + "\n" : "not by the end\n";
  text += "\nsensed   way m  traverses   error m           of the mean m     of the mode m     within 1 m" +
          std::string(score.heading.empty() ? "\n" : "   facing right\n");
  for (std::size_t k = 0; k < score.rows.size(); ++k) {
    if (!IsShown(score, k)) continue;
    const LocalizationRow& row = score.rows[k];
    char line[200];
    std::snprintf(line, sizeof line, "%6lld %7.1f %10lld   %s   %s   %s   %8.0f%%\n",
                  static_cast<long long>(row.sensations), row.way_m, static_cast<long long>(row.traverses),
                  ErrorText(row.believed).c_str(), ErrorText(row.mean).c_str(), ErrorText(row.mode).c_str(),
                  100 * row.within_1m);
    text += line;
    if (score.heading.empty()) continue;
    std::snprintf(line, sizeof line, "   %11.0f%%\n", 100 * row.facing);
    text.back() = ' ';
    text += line;
  }
  return text;
}

}  // namespace cairn::datasets
