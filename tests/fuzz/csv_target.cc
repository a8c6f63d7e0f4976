#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "datasets/import_csv.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

// A file in memory that has a path.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view text) : fd_(::memfd_create("fuzz", MFD_CLOEXEC)) {
    CAIRN_DEMAND(fd_ >= 0 && ::write(fd_, text.data(), text.size()) == static_cast<ssize_t>(text.size()),
                 "no memory file");
  }
  ~MemoryFile() { ::close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

constexpr std::array<std::string_view, 5> kGood{
    "time_s,robot,turn_rad,forward_m\n1,a,0,1\n2,a,0.5,1\n2,b,0,1\n",
    "time_s,robot,landmark,range_m,bearing_rad\n1,a,door,2,0.1\n2,a,,,\n2,b,,1,0\n",
    "time_s,robot,x_m,y_m,heading_rad\n1,a,0,0,0\n",
    "landmark,x_m,y_m\ndoor,1,2\narch,3,4\n",
    "time_s,robot,landmark\n1,a,door\n2,a,arch\n",
};

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

}  // namespace

Outcome FuzzCsv(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return Outcome::kRefused;
  std::array<std::string_view, 5> texts = kGood;
  texts[bytes[0] % texts.size()] = {reinterpret_cast<const char*>(bytes.data()) + 1, bytes.size() - 1};
  const MemoryFile odometry(texts[0]), observations(texts[1]), poses(texts[2]), landmarks(texts[3]),
      associations(texts[4]);
  datasets::CsvImportOptions options{odometry.path(),
                                     observations.path(),
                                     poses.path(),
                                     landmarks.path(),
                                     associations.path(),
                                     bytes[0] >= 128,
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

}  // namespace cairn::fuzz
