#include "datasets/evaluate/localized_steps.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace cairn::datasets {
namespace {

std::vector<Point> Points(const Blob& file, const std::string& x_name, const std::string& y_name) {
  const auto x = file.Get<double>(x_name), y = file.Get<double>(y_name);
  if (x.size() != y.size()) throw InputError("'" + x_name + "' and '" + y_name + "' are not of one length");
  std::vector<Point> points;
  for (std::size_t k = 0; k < x.size(); ++k) points.push_back({x[k], y[k]});
  return points;
}

}  // namespace

LocalizedSteps::LocalizedSteps(const Blob& result) {
  for (const char* name : {"step/traverse", "belief/place", "samples_hash"}) {
    if (!result.Has(name)) throw InputError(std::string("not a localization: '") + name + "' is missing");
  }
  places = Points(result, "place/x_m", "place/y_m");
  if (result.Has("place/heading_rad")) {
    heading_rad = result.Get<double>("place/heading_rad");
    if (heading_rad.size() != places.size())
      throw InputError("'place/heading_rad' and 'place/x_m' are not of one length");
  }
  place = result.Get<std::int32_t>("belief/place");
  probability = result.Get<float>("belief/probability");
  const std::vector<Point> means = Points(result, "step/mean_x_m", "step/mean_y_m"),
                           modes = Points(result, "step/mode_x_m", "step/mode_y_m");
  const auto traverse = result.Get<std::int32_t>("step/traverse"), run = result.Get<std::int32_t>("step/run"),
             sample = result.Get<std::int32_t>("step/sample");
  const auto way = result.Get<double>("step/way_m"), spread = result.Get<double>("step/spread_m");
  const auto entries = result.Get<std::int64_t>("step/entries");
  for (const std::size_t size :
       {means.size(), modes.size(), run.size(), sample.size(), way.size(), spread.size(), entries.size()}) {
    if (size != traverse.size()) throw InputError("the arrays of 'step/' are not of one length");
  }
  if (traverse.empty()) throw InputError("there are no steps");
  CheckBelief(entries);
  std::size_t entry = 0;
  for (std::size_t k = 0; k < traverse.size(); ++k) {
    const bool begins = k == 0 || traverse[k] != traverse[k - 1];
    const auto count = static_cast<std::size_t>(entries[k]);
    steps.push_back({traverse[k], run[k], sample[k], begins ? 0 : steps.back().sensations + 1, way[k],
                     spread[k], means[k], modes[k], entry, entry + count});
    entry += count;
  }
}

// Each step believes in something, and in all with probability 1.
void LocalizedSteps::CheckBelief(std::span<const std::int64_t> entries) const {
  if (std::ranges::any_of(
          place, [&](std::int32_t p) { return p < 0 || static_cast<std::size_t>(p) >= places.size(); }))
    throw InputError("'belief/place' names a place that is not there");
  if (std::ranges::any_of(places, [](Point p) { return !std::isfinite(p.x_m + p.y_m); }))
    throw InputError("'place/x_m' or 'place/y_m' holds what is no number");
  std::size_t entry = 0;
  for (const std::int64_t count : entries) {
    if (count < 1 || place.size() != probability.size() ||
        static_cast<std::size_t>(count) > place.size() - entry)
      throw InputError("'belief/place', 'belief/probability' and 'step/entries' do not fit");
    double sum = 0;
    for (const float p : probability.subspan(entry, static_cast<std::size_t>(count)))
      sum += p >= 0 ? static_cast<double>(p) : std::nan("");
    constexpr double kOff = 1e-3;  // of single precision
    if (!(std::abs(sum - 1) < kOff)) throw InputError("'belief/probability' of a step does not sum to 1");
    entry += static_cast<std::size_t>(count);
  }
}

}  // namespace cairn::datasets
