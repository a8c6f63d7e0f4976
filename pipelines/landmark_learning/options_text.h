// Options as a result keeps them.
#pragma once

#include <string>
#include <vector>

#include "pipelines/landmark_learning/options.h"

namespace cairn::landmark_learning {

// "name=value" of each, in the order of options.h.
std::vector<std::string> OptionTexts(const Options& options);

}  // namespace cairn::landmark_learning
