// What the figures of the papers are put together from: panels of raw data and of maps, and words on scores.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "datasets/evaluate/evaluate.h"
#include "datasets/reproduce/panels.h"
#include "schema/blob.h"

namespace cairn::datasets {

// As printf writes it, up to 600 characters.
__attribute__((format(printf, 1, 2))) std::string Say(const char* format, ...);

// Odometry alone from the origin on, up to a time, with marks at the observations.
report::PanelPicture RawPanel(const std::string& title, const Blob& log, std::size_t robot = 0,
                              double until_s = HUGE_VAL);

// Landmarks, most likely paths and the true landmarks, laid over them by the score's alignment.
report::PanelPicture MapPanel(const std::string& title, const Blob& result, const Blob& log,
                              const Evaluation& score);

// All panels over the box that holds what is drawn in any.
std::string DrawFigure(const std::vector<report::PanelPicture>& panels, int columns);

const char* RightOrWrong(const Evaluation& score);
// "topology right, 14 of 14 landmarks found, …"; of a log whose truth has landmarks.
std::string ScoreText(const Evaluation& score);

}  // namespace cairn::datasets
