#include "pipelines/local_map/traces/arrays.h"

#include <cmath>
#include <limits>

#include "pipelines/common/handed_over.h"

namespace cairn::local_map {
namespace {

void Append(const Side& side, std::vector<float>* numbers) {
  numbers->insert(numbers->end(),
                  {side.angle_rad.low, side.angle_rad.high, side.distance_m.low, side.distance_m.high,
                   side.cross_m, side.cross_cells, side.nearest_m, side.occupied ? 1.0F : 0.0F});
}

Side SideOf(std::span<const float> n) {
  return {.angle_rad = {n[0], n[1]},
          .distance_m = {n[2], n[3]},
          .cross_m = n[4],
          .cross_cells = n[5],
          .nearest_m = n[6],
          .occupied = n[7] > 0 ? std::uint8_t{1} : std::uint8_t{0}};
}

}  // namespace

void AppendFeatures(const EdgeTrace& trace, std::vector<float>* numbers) {
  for (const Feature& feature : trace.features()) {
    Append(feature.left, numbers);
    Append(feature.right, numbers);
  }
}

void RequireFeatures(std::span<const float> numbers) {
  for (const float number : numbers)
    if (!std::isnan(number)) RequireWithin("a feature's number", double{number}, -1e6, 1e6);
}

EdgeTrace TraceOf(double cell_m, int first_z, std::span<const float> numbers) {
  const std::size_t count = numbers.size() / kFeatureNumbers;
  EdgeTrace trace(cell_m, first_z, count);
  for (std::size_t f = 0; f < count; ++f) {
    const auto of_feature = numbers.subspan(f * kFeatureNumbers, kFeatureNumbers);
    *trace.Touch(first_z + static_cast<int>(f)) = {SideOf(of_feature.first(kSideNumbers)),
                                                   SideOf(of_feature.subspan(kSideNumbers))};
  }
  return trace;
}

Blob TracesBlob(const std::vector<RecordedTrace>& traces) {
  std::vector<std::int64_t> rows;
  std::vector<float> numbers;
  for (const RecordedTrace& t : traces) {
    rows.insert(rows.end(),
                {static_cast<std::int64_t>(t.robot), static_cast<std::int64_t>(t.first),
                 static_cast<std::int64_t>(t.end), t.frame.quarter, t.frame.origin.i, t.frame.origin.j,
                 t.trace.first_z(), static_cast<std::int64_t>(t.trace.features().size())});
    AppendFeatures(t.trace, &numbers);
  }
  Blob blob;
  blob.PutVector("trace", rows);
  blob.PutVector("features", numbers);
  return blob;
}

std::vector<RecordedTrace> ReadTraces(const Blob& blob, double cell_m) {
  constexpr std::size_t kNumbers = 8;
  constexpr std::int64_t kMostScans = std::numeric_limits<std::int32_t>::max(), kMostCells = 4'000'000;
  const auto rows = blob.Get<std::int64_t>("trace");
  const auto numbers = blob.Get<float>("features");
  RequireFeatures(numbers);
  std::vector<RecordedTrace> traces;
  std::size_t begin = 0;
  for (std::size_t k = 0; k + kNumbers <= rows.size(); k += kNumbers) {
    const auto row = rows.subspan(k, kNumbers);
    RequireAllWithin("a trace's robot and scans", row.first(3), std::int64_t{0}, kMostScans);
    RequireWithin("a trace's quarter", row[3], 0, 3);
    RequireAllWithin("a trace's cells", row.subspan(4, 3), -kMostCells, kMostCells);
    RequireWithin("a trace's features", row[7], 0,
                  static_cast<std::int64_t>((numbers.size() - begin) / kFeatureNumbers));
    const std::size_t count = static_cast<std::size_t>(row[7]) * kFeatureNumbers;
    traces.push_back({.robot = static_cast<std::size_t>(row[0]),
                      .first = static_cast<std::size_t>(row[1]),
                      .end = static_cast<std::size_t>(row[2]),
                      .frame = {static_cast<int>(row[3]),
                                {static_cast<std::int32_t>(row[4]), static_cast<std::int32_t>(row[5])}},
                      .trace = TraceOf(cell_m, static_cast<int>(row[6]), numbers.subspan(begin, count))});
    begin += count;
  }
  return traces;
}

}  // namespace cairn::local_map
