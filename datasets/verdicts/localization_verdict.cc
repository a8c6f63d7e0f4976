#include "datasets/verdicts/localization_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "datasets/verdicts/networks_verdict.h"
#include "schema/kinds/learning.h"

namespace cairn::datasets {
namespace {

constexpr double kSureShare = 0.25;  // of the spread of all positions

using Cell = std::pair<std::int64_t, std::int64_t>;

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// How far the positions lie from the middle of most of them: what a few far away do not change.
double SizeOf(const std::vector<double>& x_m, const std::vector<double>& y_m) {
  const double middle_x_m = Median(x_m), middle_y_m = Median(y_m);
  std::vector<double> away_m;
  for (std::size_t k = 0; k < x_m.size(); ++k)
    away_m.push_back(std::hypot(x_m[k] - middle_x_m, y_m[k] - middle_y_m));
  return Median(away_m);
}

// Positions of one place: those between which no gap is as wide as a third of what most of them take.
struct Place {
  std::vector<double> x_m, y_m;
};

// The largest place first, those of less than one position in twenty left out; of few positions one.
std::vector<Place> PlacesOf(const std::vector<double>& x_m, const std::vector<double>& y_m) {
  constexpr std::size_t kFew = 100;
  constexpr double kLeast_m = 0.1;
  const double cell_m = SizeOf(x_m, y_m) / 3;
  if (x_m.size() < kFew || !(cell_m >= kLeast_m)) return {{x_m, y_m}};
  std::map<Cell, std::vector<std::size_t>> cells;
  for (std::size_t k = 0; k < x_m.size(); ++k)
    cells[{std::llround(x_m[k] / cell_m), std::llround(y_m[k] / cell_m)}].push_back(k);
  std::vector<Place> places;
  while (!cells.empty()) {
    std::vector<Cell> open = {cells.begin()->first};
    Place& place = places.emplace_back();
    while (!open.empty()) {
      const Cell at = open.back();
      open.pop_back();
      const auto found = cells.find(at);
      if (found == cells.end()) continue;
      for (const std::size_t k : found->second) {
        place.x_m.push_back(x_m[k]);
        place.y_m.push_back(y_m[k]);
      }
      cells.erase(found);
      for (const std::int64_t right : {-1, 0, 1})
        for (const std::int64_t up : {-1, 0, 1}) open.emplace_back(at.first + right, at.second + up);
    }
  }
  std::erase_if(places, [&](const Place& place) { return 20 * place.x_m.size() < x_m.size(); });
  if (places.empty()) return {{x_m, y_m}};  // scattered
  std::ranges::stable_sort(places, std::greater(), [](const Place& place) { return place.x_m.size(); });
  return places;
}

double Sum(std::span<const double> values) { return std::accumulate(values.begin(), values.end(), 0.0); }

// Root of the mean squared distance of the positions from their mean.
double SpreadOf(std::span<const double> x_m, std::span<const double> y_m) {
  const auto n = static_cast<double>(x_m.size());
  const double mean_x_m = Sum(x_m) / n, mean_y_m = Sum(y_m) / n;
  double squares = 0.0;
  for (std::size_t k = 0; k < x_m.size(); ++k)
    squares += std::pow(x_m[k] - mean_x_m, 2) + std::pow(y_m[k] - mean_y_m, 2);
  return std::sqrt(squares / n);
}

// Of the robots at their last step.
struct Ends {
  std::size_t robots = 0, sure = 0, there = 0;  // in all; sure of their place; of these, where it is
  bool are_checked = true;
};

Ends EndsOf(const kinds::Localization::Steps& step, double sure_m) {
  Ends ends;
  ends.are_checked = static_cast<bool>(step.off_label_m);
  for (std::size_t k = 0; k < step.traverse.size(); ++k) {
    if (k + 1 < step.traverse.size() && step.traverse[k + 1] == step.traverse[k]) continue;
    ++ends.robots;
    if (step.spread_m[k] > sure_m) continue;
    ++ends.sure;
    // As near as its own belief allows: of those that are right one in fifty is further off than twice that.
    const double near_m = std::max(sure_m, 2 * step.spread_m[k]);
    ends.there += ends.are_checked && step.off_label_m[k] <= near_m ? 1 : 0;
  }
  return ends;
}

// No result is worth more than what it was made with.
void AddNetworks(const kinds::Localization& localization, Verdict* verdict) {
  for (const kinds::NetworksWorth& worth : localization.extractor) {
    const Verdict networks = NetworksVerdict(worth);
    if (networks.trust == Confidence::kLow)
      verdict->Add({Confidence::kLow, "what it senses is by networks of low trust: " + networks.why});
  }
}

// What robots believe to be their place, beside where they were.
void AddElsewhere(const Ends& ends, Verdict* verdict) {
  verdict->AddCount("right_robots", ends.there);
  if (ends.there == ends.sure) return;
  const bool most_are_there = 3 * ends.there >= 2 * ends.sure && 2 * ends.there >= ends.robots;
  verdict->Add({most_are_there ? Confidence::kFair : Confidence::kLow,
                fmt::format("only {} of those {} are as near to where the samples say that they were taken{}",
                            ends.there, ends.sure,
                            most_are_there ? ""
                                           : ": do other places look the same, do the features drift, or are "
                                             "the runs not in one frame?")});
}

}  // namespace

Verdict LocalizationVerdict(const Blob& result) {
  const auto localization = Read<kinds::Localization>(result);
  const kinds::Localization::Steps& step = localization.step;
  Verdict verdict;
  if (!step.lead_nats || !step.expected_lead_nats) {
    verdict.why = "the file does not tell how well its robots foretold what they sensed";
    return verdict;
  }
  const std::vector<Place> places =
      PlacesOf(localization.position_x_m.vector(), localization.position_y_m.vector());
  const double sure_m = kSureShare * SpreadOf(places[0].x_m, places[0].y_m);
  const Ends ends = EndsOf(step, sure_m);
  const double expected = Sum(step.expected_lead_nats);
  const double foretold = expected > 0.0 ? Sum(step.lead_nats) / expected : 0.0;
  verdict.AddCount("robots", ends.robots);
  verdict.AddCount("sure_robots", ends.sure);
  verdict.numbers.emplace_back("sure_m", sure_m);
  verdict.numbers.emplace_back("foretold_ratio", foretold);
  verdict.trust = 2 * ends.sure >= ends.robots && foretold >= 1.0 ? Confidence::kFair : Confidence::kLow;
  verdict.why = fmt::format("{} of {} robots end sure of their place to within {:.1f} m", ends.sure,
                            ends.robots, sure_m);
  if (foretold < 1.0)
    verdict.why +=
        ", but what they sensed they foretold less well than where they believe to be says: is the map "
        "that of another place, or from before things changed?";
  else if (verdict.trust == Confidence::kFair)
    verdict.why += ends.are_checked
                       ? ", and they foretold what they sensed"
                       : ", and they foretold what they sensed; one at a place that looks the same is not "
                         "found out";
  if (ends.are_checked) AddElsewhere(ends, &verdict);
  if (places.size() > 1)
    verdict.Add(
        {Confidence::kLow,
         fmt::format("the map's positions lie in {} places with nothing between them, {} in the largest "
                     "and {} in the next: are all runs in one frame?",
                     places.size(), places[0].x_m.size(), places[1].x_m.size())});
  AddNetworks(localization, &verdict);
  return verdict;
}

}  // namespace cairn::datasets
