// How scores of windows are printed, for people and for programs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "datasets/evaluate/window_scores.h"

namespace cairn::datasets {

nlohmann::ordered_json WindowJson(double window_m);  // null: global
nlohmann::ordered_json WindowScoresJson(const std::vector<WindowScore>& scores);

std::string WindowText(double window_m);
// Behind the words on the map, where headings count.
std::string HeadingText(double heading_window_deg);  // "+-2 m", "global"
// What intervals are taken over; an empty line; a row for each window.
std::string WindowScoresText(const std::vector<WindowScore>& scores);
std::string Joined(const std::vector<std::string>& names);

}  // namespace cairn::datasets
