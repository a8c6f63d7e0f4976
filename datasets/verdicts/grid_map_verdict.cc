#include "datasets/verdicts/grid_map_verdict.h"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>

#include "schema/kinds/grid_map.h"

namespace cairn::datasets {
namespace {

// By how much a map predicts readings better that it was not made of than one that knows nothing.
void AddCheck(const kinds::GridMap::Fit& fit, Verdict* verdict) {
  constexpr double kTellsNats = 0.1;
  if (fit.checked_readings.Or(0) == 0) return;
  const double gain = fit.checked_nats.Scalar() - fit.ignorant_nats.Scalar();
  verdict->AddCount("checked_readings", static_cast<std::size_t>(fit.checked_readings.Scalar()));
  verdict->numbers.emplace_back("checked_gain_nats", gain);
  if (gain < kTellsNats) {
    verdict->trust = Confidence::kLow;
    verdict->why = fmt::format(
        "{} readings that were left out are hardly likelier in the map of the others than in one that knows "
        "nothing of any place: its poses, its readings or what is believed of its sensors are wrong",
        fit.checked_readings.Scalar());
    return;
  }
  verdict->why = fmt::format(
      "{} readings that were left out are each {:.2f} nats likelier in the map of the others than in one "
      "that knows "
      "nothing of any place; ",
      fit.checked_readings.Scalar(), gain);
}

}  // namespace

Verdict GridMapVerdict(const Blob& result) {
  constexpr std::int32_t kNothingDetected = -1, kRandom = -2, kLost = -4;
  const auto map = Read<kinds::GridMap>(result);
  std::size_t readings = 0, explained = 0;
  for (const auto& robot : map.robot) {
    for (const auto& sensor : robot.sensors) {
      for (const std::int32_t cause : sensor.cause.OrNone()) {
        if (cause < kLost || cause == kRandom - 1) continue;  // not used, or beyond the map
        ++readings;
        explained += cause >= kNothingDetected;
      }
    }
  }
  Verdict verdict;
  AddCheck(map.fit, &verdict);
  if (verdict.trust == Confidence::kNone)
    verdict.why += "the map is as good as the poses it is made with, and cannot tell how good they are";
  if (map.cut_short.Or(0) != 0)
    verdict.why += "; its search ended because 'rounds' allows no more, not because nothing was left to find";
  if (readings == 0) return verdict;
  verdict.AddCount("readings", readings);
  verdict.AddCount("readings_explained", explained);
  verdict.why +=
      fmt::format("; it explains {:.1f}% of {} readings",
                  100.0 * static_cast<double>(explained) / static_cast<double>(readings), readings);
  return verdict;
}

}  // namespace cairn::datasets
