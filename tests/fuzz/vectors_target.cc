#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "datasets/import/vectors.h"
#include "tests/fuzz/gzip.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

constexpr std::string_view kGood = "time_s,x_m,y_m,red\n1,0,0,5\n2,1,0,6\n";
constexpr std::uint8_t kSkipBad = 128, kGzip = 64, kSecond = 1;

void CheckSamples(const Blob& samples) {
  const std::size_t runs = samples.Texts("runs").size(), inputs = samples.Texts("input_name").size();
  CAIRN_DEMAND(runs > 0 && inputs > 0, "samples of nothing");
  for (std::size_t n = 0; n < runs; ++n) {
    const std::string prefix = "run/" + std::to_string(n) + "/";
    const auto times = samples.Get<double>(prefix + "time_s");
    CAIRN_DEMAND(times.size() >= 2 && std::ranges::is_sorted(times), "no run");
    for (const char* column : {"x_m", "y_m"}) {
      const auto values = samples.Get<double>(prefix + column);
      CAIRN_DEMAND(values.size() == times.size(), "columns of unequal length");
      CAIRN_DEMAND(std::ranges::all_of(values, [](double v) { return std::isfinite(v); }), "no pose");
    }
    const auto input = samples.Get<float>(prefix + "input");
    CAIRN_DEMAND(input.size() == times.size() * inputs, "vectors of unequal length");
    CAIRN_DEMAND(std::ranges::all_of(input, [](float v) { return std::isfinite(v); }),
                 "an input is not finite");
  }
}

Outcome Run(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return Outcome::kRefused;
  const std::uint8_t choice = bytes[0];
  const std::string text =
      (choice & kGzip) != 0 ? Gzip(AsText(bytes.subspan(1))) : std::string(AsText(bytes.subspan(1)));
  const MemoryFile good(kGood), other(text);
  const datasets::VectorsImportOptions options{(choice & kSecond) != 0
                                                   ? std::vector<std::string>{good.path(), other.path()}
                                                   : std::vector<std::string>{other.path()},
                                               (choice & kSkipBad) != 0};
  Blob samples;
  try {
    datasets::ImportVectors(options, &samples);
  } catch (const InputError&) {
    return Outcome::kRefused;
  }
  CheckSamples(samples);
  return Outcome::kAccepted;
}

std::vector<Bytes> Seeds() {
  constexpr std::array<std::string_view, 3> kFiles{
      "time_s,x_m,y_m,red\n1,0,0,5\n2,1,0,6\n3,1,0,6\n",
      "red,y_m,time_s,x_m\n1,0,0,5\n2,1,7,6\n3,1,8,6\n",
      "time_s,x_m,y_m,heading_rad,\"a,b\",red\n1,0,0,0,5,1\n2,1,0,4,1e30,1\n",
  };
  std::vector<Bytes> seeds;
  for (const std::string_view file : kFiles) {
    for (const std::uint8_t flags : {0, 0 + kSkipBad, 0 + kGzip, 0 + kSecond}) {
      if (flags == kSecond && file == kFiles.back()) continue;  // other columns than the good run's
      seeds.emplace_back(file.begin(), file.end());
      seeds.back().insert(seeds.back().begin(), flags);
    }
  }
  return seeds;
}

}  // namespace

Target VectorsTarget() { return {"vectors", Run, Seeds, 4000}; }

}  // namespace cairn::fuzz
