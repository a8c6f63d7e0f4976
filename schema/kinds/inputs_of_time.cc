#include "schema/kinds/inputs_of_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <span>

#include "schema/kinds/learning.h"

namespace cairn {
namespace {

constexpr std::size_t kFewSamples = 20;

// Which way an input goes along a run: 1 where it only grows, -1 where it only falls, 0 where it does
// neither, or hardly changes. `values`: the run's samples, each with all inputs.
int WayOf(std::span<const float> values, std::size_t inputs, std::size_t input) {
  std::size_t up = 0, down = 0;
  const std::size_t steps = values.size() / inputs - 1;
  for (std::size_t k = 0; k < steps && (up == 0 || down == 0); ++k) {
    const float before = values[k * inputs + input], after = values[(k + 1) * inputs + input];
    up += after > before ? 1 : 0;
    down += after < before ? 1 : 0;
  }
  if (down == 0 && 2 * up > steps) return 1;
  return up == 0 && 2 * down > steps ? -1 : 0;
}

}  // namespace

std::vector<std::string> InputsOfTimeOf(const Blob& blob) {
  const auto samples = Read<kinds::Samples>(blob);
  const std::size_t inputs = samples.input_name.OrNone().size();
  const bool few = std::ranges::any_of(samples.run, [&](const kinds::Samples::Run& run) {
    return run.input.OrNone().size() < kFewSamples * inputs;
  });
  std::vector<std::string> doubts;
  if (samples.run.empty() || few) return doubts;
  for (std::size_t i = 0; i < inputs; ++i) {
    const int way = WayOf(samples.run[0].input.OrNone(), inputs, i);
    const bool same = way != 0 && std::ranges::all_of(samples.run, [&](const kinds::Samples::Run& run) {
                        return WayOf(run.input.OrNone(), inputs, i) == way;
                      });
    if (same)
      doubts.push_back(
          fmt::format("input '{}' only {} along every run: is it a clock, a counter or a row's number? Such "
                      "a one tells when, not where, and what is learned from it serves no robot that "
                      "starts elsewhere; leave it out",
                      samples.input_name[i], way > 0 ? "grows" : "falls"));
  }
  return doubts;
}

}  // namespace cairn
