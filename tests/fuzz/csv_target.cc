#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "datasets/import/csv.h"
#include "tests/fuzz/gzip.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

constexpr std::array<std::string_view, 5> kGood{
    "time_s,robot,turn_rad,forward_m\n1,a,0,1\n2,a,0.5,1\n2,b,0,1\n",
    "time_s,robot,landmark,range_m,bearing_rad\n1,a,door,2,0.1\n2,a,,,\n2,b,,1,0\n",
    "time_s,robot,x_m,y_m,heading_rad\n1,a,0,0,0\n",
    "landmark,x_m,y_m\ndoor,1,2\narch,3,4\n",
    "time_s,robot,landmark\n1,a,door\n2,a,arch\n",
};

constexpr std::uint8_t kSkipBad = 128, kGzip = 64;

void CheckOrdered(const Blob& log, const std::string& name) {
  const auto times = log.Get<double>(name);
  CAIRN_DEMAND(std::ranges::is_sorted(times), name + " runs backwards");
}

void CheckLog(const Blob& log) {
  const std::size_t robots = log.Texts("robots").size();
  for (std::size_t n = 0; n < robots; ++n) {
    const std::string prefix = "robot/" + std::to_string(n) + "/";
    CheckOrdered(log, prefix + "odometry/time_s");
    CheckOrdered(log, prefix + "observations/time_s");
    for (const char* column : {"turn_rad", "forward_m"}) {
      const auto values = log.Get<double>(prefix + "odometry/" + column);
      CAIRN_DEMAND(values.size() == log.Get<double>(prefix + "odometry/time_s").size(),
                   "columns of unequal length");
      CAIRN_DEMAND(std::ranges::all_of(values, [](double v) { return std::isfinite(v); }),
                   "a control is not finite");
    }
    const auto landmark = log.Get<std::int32_t>(prefix + "observations/landmark");
    const auto range = log.Get<double>(prefix + "observations/range_m");
    const auto known = static_cast<std::int32_t>(log.Texts("landmarks").size());
    CAIRN_DEMAND(landmark.size() == range.size(), "columns of unequal length");
    CAIRN_DEMAND(std::ranges::all_of(landmark, [&](std::int32_t l) { return l >= -1 && l < known; }),
                 "no such landmark");
    CAIRN_DEMAND(std::ranges::none_of(range, [](double r) { return r < 0 || std::isinf(r); }),
                 "an impossible range");
  }
}

Outcome Run(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return Outcome::kRefused;
  std::array<std::string_view, 5> texts = kGood;
  const std::uint8_t choice = bytes[0];
  const std::string text =
      (choice & kGzip) != 0 ? Gzip(AsText(bytes.subspan(1))) : std::string(AsText(bytes.subspan(1)));
  texts[(choice & 63) % texts.size()] = text;
  const MemoryFile odometry(texts[0]), observations(texts[1]), poses(texts[2]), landmarks(texts[3]),
      associations(texts[4]);
  datasets::CsvImportOptions options{odometry.path(),
                                     observations.path(),
                                     poses.path(),
                                     landmarks.path(),
                                     associations.path(),
                                     (choice & kSkipBad) != 0,
                                     {},
                                     {{"", {0.5, -0.1, 2}}},
                                     {}};
  Blob log;
  try {
    datasets::ImportCsv(options, &log);
  } catch (const InputError&) {
    return Outcome::kRefused;
  }
  CheckLog(log);
  return Outcome::kAccepted;
}

std::vector<Bytes> Seeds() {
  constexpr std::array<std::string_view, 6> kFiles{
      "time_s,robot,turn_rad,forward_m\n1,a,0,1\n2,a,0.5,1\n2,b,0,1\n3,a,0,0\n",
      "time_s,robot,landmark,range_m,bearing_rad\n1,a,door,2,0.1\n2,a,,,\n2,b,\"arch\",1,0\n",
      "time_s,robot,x_m,y_m,heading_rad\n1,a,0,0,0\n2,a,1,1,-4\n2,b,1,1,1\n",
      "landmark,x_m,y_m\ndoor,1,2\narch,3,4\n",
      "time_s,robot,landmark\n1,a,door\n2,a,arch\n2,b,\n",
      "time_s,robot,v_mps,omega_radps\n1,a,1,0.5\n2,a,0.5,1\n2,b,0,1\n5,b,2,2\n",
  };
  std::vector<Bytes> seeds;
  for (std::size_t i = 0; i < kFiles.size(); ++i) {
    for (const std::uint8_t flags : {0, 0 + kSkipBad, 0 + kGzip}) {
      seeds.emplace_back(kFiles[i].begin(), kFiles[i].end());
      seeds.back().insert(seeds.back().begin(), static_cast<std::uint8_t>(i % 5 + flags));
    }
    const std::string zipped = Gzip(kFiles[i]);
    seeds.emplace_back(zipped.begin(), zipped.end());
    seeds.back().insert(seeds.back().begin(), static_cast<std::uint8_t>(i % 5));
  }
  return seeds;
}

}  // namespace

Target CsvTarget() { return {"csv", Run, Seeds, 4000}; }

}  // namespace cairn::fuzz
