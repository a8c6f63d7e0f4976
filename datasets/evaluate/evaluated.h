// What evaluating a result of any kind gives.
#pragma once

#include <variant>

#include "datasets/evaluate/evaluate.h"
#include "datasets/evaluate/grid.h"
#include "datasets/evaluate/local.h"
#include "datasets/evaluate/localization.h"
#include "datasets/evaluate/networks.h"

namespace cairn::datasets {

using Evaluated =
    std::variant<Evaluation, GridEvaluation, LocalEvaluation, LocalizationScore, NetworkEvaluation>;

inline Scores ScoresOf(const Evaluated& evaluated) {
  return std::visit([](const auto& evaluation) { return ScoresOf(evaluation); }, evaluated);
}

}  // namespace cairn::datasets
