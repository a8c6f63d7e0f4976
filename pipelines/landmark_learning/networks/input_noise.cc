#include "pipelines/landmark_learning/networks/input_noise.h"

#include <cstddef>

#include "schema/rng.h"

namespace cairn::landmark_learning {
namespace {

constexpr std::size_t kTable = 1 << 16;

// The table, and its beginning once more, so that a row is read without going round.
const std::vector<float>& Normals(std::size_t more) {
  static thread_local std::vector<float> table;
  if (table.size() < kTable + more) {
    table.clear();
    Rng rng(0x6e6f697365);
    for (std::size_t i = 0; i < kTable; ++i) table.push_back(static_cast<float>(rng.Normal()));
    for (std::size_t i = 0; i < more; ++i) table.push_back(table[i % kTable]);
  }
  return table;
}

std::size_t PositionOf(const InputNoise& noise, int sample) {
  const auto low = [](std::uint64_t value) { return static_cast<std::uint32_t>(value); };
  const auto step = static_cast<std::uint64_t>(noise.step);
  return Philox4x32({static_cast<std::uint32_t>(sample), low(step), low(step >> 32), 1},
                    {low(noise.seed), low(noise.seed >> 32)})[0] %
         kTable;
}

}  // namespace

InputRows::InputRows(const float* inputs, const IndexRange& samples, int width, const InputNoise& noise)
    : clean_(inputs + static_cast<std::ptrdiff_t>(samples.first) * width) {
  if (noise.deviation == 0.0) return;
  const auto n = static_cast<std::size_t>(width);
  const std::vector<float>& normals = Normals(n);
  const auto deviation = static_cast<float>(noise.deviation);
  noisy_.resize(n * static_cast<std::size_t>(samples.size()));
  const float* from = clean_;
  float* row = noisy_.data();
  for (int k = samples.first; k < samples.end; ++k, row += n, from += n) {
    const float* normal = &normals[PositionOf(noise, k)];
    for (std::size_t i = 0; i < n; ++i) row[i] = from[i] + deviation * normal[i];
  }
}

}  // namespace cairn::landmark_learning
