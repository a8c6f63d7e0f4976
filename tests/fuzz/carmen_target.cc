#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "datasets/import/recorded/carmen.h"
#include "tests/fuzz/gzip.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

constexpr std::uint8_t kSkipBad = 128, kGzip = 64, kNumbered = 32, kPoses = 3;

void CheckTimes(const Blob& log, const std::string& prefix, bool strictly) {
  const auto times = log.Get<double>(prefix + "time_s");
  CAIRN_DEMAND(std::ranges::is_sorted(times), prefix + " runs backwards");
  CAIRN_DEMAND(!strictly || std::ranges::adjacent_find(times) == times.end(), prefix + " repeats a time");
  CAIRN_DEMAND(std::ranges::all_of(times, [](double t) { return std::isfinite(t); }), "no time");
}

void CheckScans(const Blob& log, const std::string& prefix) {
  CheckTimes(log, prefix, false);
  const double reach = log.Scalar<double>(prefix + "max_range_m");
  CAIRN_DEMAND(reach > 0, "a sensor without reach");
  const auto range = log.Get<double>(prefix + "range_m");
  CAIRN_DEMAND(range.size() == log.Get<double>(prefix + "time_s").size() *
                                   log.Get<double>(prefix + "beam_heading_rad").size(),
               "scans of unequal length");
  CAIRN_DEMAND(std::ranges::all_of(range, [&](double r) { return std::isnan(r) || (r > 0 && r < reach); }),
               "a range that no sensor gives");
}

void CheckLog(const Blob& log) {
  CheckTimes(log, "robot/0/odometry/", false);
  CheckTimes(log, "robot/0/observations/", false);
  if (log.Has("robot/0/poses/time_s")) CheckTimes(log, "robot/0/poses/", true);
  for (const char* sensor : {"laser", "laser2", "laser3", "laser4", "laser5", "sonar"}) {
    const std::string prefix = "robot/0/" + std::string(sensor) + "/";
    if (log.Has(prefix + "time_s")) CheckScans(log, prefix);
  }
  for (const char* column : {"turn_rad", "forward_m"}) {
    const auto values = log.Get<double>("robot/0/odometry/" + std::string(column));
    CAIRN_DEMAND(std::ranges::all_of(values, [](double v) { return std::isfinite(v); }), "no control");
  }
}

Outcome Run(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return Outcome::kRefused;
  using Poses = datasets::CarmenImportOptions::Poses;
  constexpr std::array kWhich{Poses::kDetect, Poses::kCorrected, Poses::kRaw, Poses::kDetect};
  const std::string_view text = AsText(bytes.subspan(1));
  const MemoryFile file((bytes[0] & kGzip) != 0 ? Gzip(text) : std::string(text));
  datasets::CarmenImportOptions options;
  options.path = file.path();
  options.skip_bad = (bytes[0] & kSkipBad) != 0;
  options.numbered = (bytes[0] & kNumbered) != 0;
  options.poses = kWhich[bytes[0] & kPoses];
  Blob log;
  try {
    datasets::ImportCarmen(options, &log);
  } catch (const InputError&) {
    return Outcome::kRefused;
  }
  CheckLog(log);
  return Outcome::kAccepted;
}

std::vector<Bytes> Seeds() {
  constexpr std::array<std::string_view, 3> kLogs{
      "# old\nPARAM robot_front_laser_max 20 0 h 0\nODOM 0 0 0 0 0 0 1 h 1\n"
      "FLASER 3 1 2 81.9 0.1 0 0 0 0 0 1.5 h 1.5\nRLASER 2 1 2 0 0 3.1 0 0 0 1.6 h 1.6\n"
      "ODOM 1 0 0.2 0 0 0 2 h 2\nFLASER 3 1 2 3 1.1 0 0.2 1 0 0.2 2 h 2\nMARKER door 2 h 2\n",
      "NEFF 9\nFLASER 2 1 2 0 0 0 0 0 0 5 h 5\nODOM 0 0 0 0 0 0 0 h 0\n"
      "FLASER 2 1 2 1 0 0 1 0 0 7 h 7\nFLASER 2 1 2 2 0 0 2 0 0 6.5 h 6.5\nTRUEPOS 1 0 0 1 0 0 8 h 8\n",
      "ODOM 0 0 0 0 0 0 1 h 1\nROBOTLASER1 0 -1 2 1 8 0.1 0 3 1 2 9 0 0 0 0 0 0 0 0 0 0 0 0 1 h 1\n"
      "RAWLASER2 0 -1 2 1 8 0.1 0 3 1 2 9 1 5 1 h 1\nSONAR 0.3 2 1 2 0 0 0.5 0 0 -0.5 1 h 1\n"
      "ODOM 1 0 0 0 0 0 2 h 2\n"};
  std::vector<Bytes> seeds;
  for (const std::string_view log : kLogs) {
    for (const std::uint8_t flags : {0, 0 + kSkipBad, 0 + kGzip, 0 + kNumbered, 1, 2}) {
      seeds.emplace_back(log.begin(), log.end());
      seeds.back().insert(seeds.back().begin(), flags);
    }
  }
  return seeds;
}

}  // namespace

Target CarmenTarget() { return {"carmen", Run, Seeds, 4000}; }

}  // namespace cairn::fuzz
