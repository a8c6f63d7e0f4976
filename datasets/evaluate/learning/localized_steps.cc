#include "datasets/evaluate/learning/localized_steps.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "datasets/evaluate/landmarks.h"
#include "schema/kinds/learning.h"

namespace cairn::datasets {
LocalizedSteps::LocalizedSteps(const Blob& result) {
  for (const char* name : {"step/traverse", "belief/position", "samples_hash"}) {
    if (!result.Has(name)) throw InputError(std::string("not a localization: '") + name + "' is missing");
  }
  const auto of = Read<kinds::Localization>(result);
  const kinds::Localization::Steps& step = of.step;
  positions = PointsOf(of.position_x_m, of.position_y_m);
  heading_rad = of.position_heading_rad.OrNone();
  position = of.belief_position;
  probability = of.belief_probability;
  const std::span<const std::int32_t> traverse = step.traverse;
  const std::span<const std::int64_t> entries = step.entries;
  if (traverse.empty()) throw InputError("there are no steps");
  CheckBelief(entries);
  std::size_t entry = 0;
  for (std::size_t k = 0; k < traverse.size(); ++k) {
    const bool begins = k == 0 || traverse[k] != traverse[k - 1];
    const auto count = static_cast<std::size_t>(entries[k]);
    steps.push_back({traverse[k],
                     step.run[k],
                     step.sample[k],
                     begins ? 0 : steps.back().sensations + 1,
                     step.travelled_m[k],
                     step.spread_m[k],
                     {step.mean_x_m[k], step.mean_y_m[k]},
                     {step.mode_x_m[k], step.mode_y_m[k]},
                     entry,
                     entry + count});
    entry += count;
  }
}

// Each step believes in something, and in all with probability 1.
void LocalizedSteps::CheckBelief(std::span<const std::int64_t> entries) const {
  std::size_t entry = 0;
  for (const std::int64_t count : entries) {
    double sum = 0;
    for (const float p : probability.subspan(entry, static_cast<std::size_t>(count))) sum += p;
    constexpr double kOff = 1e-3;  // of single precision
    if (!(std::abs(sum - 1) < kOff)) throw InputError("'belief/probability' of a step does not sum to 1");
    entry += static_cast<std::size_t>(count);
  }
}

}  // namespace cairn::datasets
