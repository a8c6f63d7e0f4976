#include "datasets/bag/cloud.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "schema/error.h"
#include "schema/text.h"

namespace cairn::datasets::bag {
namespace {

constexpr std::size_t kSectors = 720;
constexpr double kSector_rad = 2 * std::numbers::pi / kSectors;

// Where in a point a number of four or eight bytes is.
struct Axis {
  std::size_t offset = 0;
  bool is_double = false;
  std::size_t end() const { return offset + (is_double ? sizeof(double) : sizeof(float)); }
  double In(const std::byte* point) const {
    double wide = 0;
    float narrow = 0;
    if (!is_double) std::memcpy(&narrow, point + offset, sizeof narrow);
    if (is_double) std::memcpy(&wide, point + offset, sizeof wide);
    return is_double ? wide : static_cast<double>(narrow);
  }
};

class CloudReader : public TopicReader {
 public:
  CloudReader(const CloudCut& cut, FindMount find_mount, ScanTopic* topic)
      : cut_(cut), find_mount_(std::move(find_mount)), topic_(*topic) {}
  std::vector<std::string> paths() const override {
    return {"header.stamp", "height",   "width", "fields.name",  "fields.offset",  "fields.datatype",
            "point_step",   "row_step", "data",  "is_bigendian", "header.frame_id"};
  }
  std::size_t needed() const override { return 9; }

  void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) override {
    const std::size_t rows = FirstCount(found[1]), columns = FirstCount(found[2]);
    const std::size_t point_bytes = FirstCount(found[6]), row_bytes = FirstCount(found[7]);
    const ByteSpan data = found[8].bytes;
    if (FirstNumber(found[9]) != 0) throw LineError{"a cloud of big-endian points", ""};
    const std::array<Axis, 3> axes = {AxisOf("x", found), AxisOf("y", found), AxisOf("z", found)};
    const std::size_t needed = std::ranges::max(axes, {}, &Axis::end).end();
    const bool fits = point_bytes >= needed && columns <= row_bytes / point_bytes &&
                      (rows == 0 || rows <= data.size() / std::max<std::size_t>(row_bytes, 1));
    if (columns > 0 && !fits)
      throw LineError{
          "a cloud that is smaller than it says",
          fmt::format("{} rows of {} points of {} bytes in {}", rows, columns, point_bytes, data.size())};
    const auto time_s = clock->At(found[0].numbers, message.receive_ns);
    if (!time_s) return;
    if (topic_.beams == 0) Begin(found[10]);
    scan_.assign(kSectors, std::numeric_limits<double>::quiet_NaN());
    seen_.assign(kSectors, 0);
    for (std::size_t row = 0; columns > 0 && row < rows; ++row)
      for (std::size_t column = 0; column < columns; ++column)
        AddPoint(axes, data.data() + row * row_bytes + column * point_bytes, scan_);
    topic_.scans.Add(scan_, 0, {});
    for (std::size_t i = 0; i < kSectors; ++i) topic_.scans_with_points[i] += seen_[i];
    topic_.times.push_back({*time_s, message.number});
  }

 private:
  static Axis AxisOf(std::string_view name, const std::vector<Found>& found) {
    constexpr double kFloat = 7, kDouble = 8;  // sensor_msgs/PointField
    const std::vector<std::string_view>& names = found[3].texts;
    const auto i = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    if (i < names.size() && i < found[4].numbers.size() && i < found[5].numbers.size() &&
        (found[5].numbers[i] == kFloat || found[5].numbers[i] == kDouble))
      return {CountOf(found[4].numbers[i]), found[5].numbers[i] == kDouble};
    throw LineError{"a cloud without x, y and z", "as float32 or float64"};
  }

  void Begin(const Found& frame) {
    topic_.frame = FrameName(FirstText(frame));
    mount_ = find_mount_(topic_.topic, topic_.frame);
    topic_.level_at = Pose{mount_.x, mount_.y, 0};
    topic_.first_rad = -std::numbers::pi + kSector_rad / 2;
    topic_.step_rad = kSector_rad;
    topic_.max_range_m = cut_.reach_m;
    topic_.beams = kSectors;
    topic_.scans = ScanRows(topic_.folder, kSectors, cut_.reach_m);
    topic_.scans_with_points.assign(kSectors, 0);
  }

  void AddPoint(const std::array<Axis, 3>& axes, const std::byte* bytes, std::span<double> range_m) {
    const PointInSpace at = Apply(mount_, {axes[0].In(bytes), axes[1].In(bytes), axes[2].In(bytes)});
    const double x = at.x - mount_.x, y = at.y - mount_.y;
    if ((x == 0 && y == 0) || !std::isfinite(x + y + at.z)) return;
    const double turns = (std::atan2(y, x) + std::numbers::pi) / kSector_rad;
    const auto sector = std::min(static_cast<std::size_t>(std::max(turns, 0.0)), kSectors - 1);
    seen_[sector] = 1;
    if (!(at.z >= cut_.low_m && at.z <= cut_.high_m)) return;
    const double range = std::hypot(x, y);  // of few
    double& nearest = range_m[sector];
    if (!(nearest <= range)) nearest = range;
  }

  CloudCut cut_;
  FindMount find_mount_;
  ScanTopic& topic_;
  Transform mount_;
  std::vector<double> scan_;
  std::vector<std::uint8_t> seen_;  // of this cloud, at any height
};

}  // namespace

CloudCut ParseCloudCut(const std::string& text) {
  std::vector<double> numbers;
  const char* reason = nullptr;
  for (const std::string& part : AtCommas(text))
    if (const auto number = ParseNumber(part, &reason)) numbers.push_back(*number);
  constexpr double kMost_m = 1000;
  if (AtCommas(text).size() == 3 && numbers.size() == 3 && std::abs(numbers[0]) < kMost_m &&
      numbers[0] < numbers[1] && numbers[1] < kMost_m && numbers[2] > 0 && numbers[2] <= kMost_m)
    return {numbers[0], numbers[1], numbers[2]};
  throw InputError(
      "--cloud " + Printable(text, 200) +
      ": what is meant is LOW_M,HIGH_M,REACH_M: the heights above the robot's frame between which "
      "points count, and how far the sensor sees them, such as 0.2,0.5,20");
}

std::unique_ptr<TopicReader> ReadCloud(const CloudCut& cut, FindMount find_mount, ScanTopic* topic) {
  return std::make_unique<CloudReader>(cut, std::move(find_mount), topic);
}

}  // namespace cairn::datasets::bag
