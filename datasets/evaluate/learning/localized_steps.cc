#include "datasets/evaluate/learning/localized_steps.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace cairn::datasets {
namespace {

std::vector<Point> Points(const Blob& file, const std::string& x_name, const std::string& y_name) {
  const auto x = file.Get<double>(x_name), y = file.Get<double>(y_name);
  std::vector<Point> points;
  for (std::size_t k = 0; k < x.size(); ++k) points.push_back({x[k], y[k]});
  return points;
}

}  // namespace

LocalizedSteps::LocalizedSteps(const Blob& result) {
  for (const char* name : {"step/traverse", "belief/position", "samples_hash"}) {
    if (!result.Has(name)) throw InputError(std::string("not a localization: '") + name + "' is missing");
  }
  positions = Points(result, "position/x_m", "position/y_m");
  if (result.Has("position/heading_rad")) heading_rad = result.Get<double>("position/heading_rad");
  position = result.Get<std::int32_t>("belief/position");
  probability = result.Get<float>("belief/probability");
  const std::vector<Point> means = Points(result, "step/mean_x_m", "step/mean_y_m"),
                           modes = Points(result, "step/mode_x_m", "step/mode_y_m");
  const auto traverse = result.Get<std::int32_t>("step/traverse"), run = result.Get<std::int32_t>("step/run"),
             sample = result.Get<std::int32_t>("step/sample");
  const auto travelled = result.Get<double>("step/travelled_m"), spread = result.Get<double>("step/spread_m");
  const auto entries = result.Get<std::int64_t>("step/entries");
  if (traverse.empty()) throw InputError("there are no steps");
  CheckBelief(entries);
  std::size_t entry = 0;
  for (std::size_t k = 0; k < traverse.size(); ++k) {
    const bool begins = k == 0 || traverse[k] != traverse[k - 1];
    const auto count = static_cast<std::size_t>(entries[k]);
    steps.push_back({traverse[k], run[k], sample[k], begins ? 0 : steps.back().sensations + 1, travelled[k],
                     spread[k], means[k], modes[k], entry, entry + count});
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
