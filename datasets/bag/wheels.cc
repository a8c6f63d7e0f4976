#include "datasets/bag/wheels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "schema/error.h"
#include "schema/text.h"

namespace cairn::datasets::bag {
namespace {

class WheelReader : public TopicReader {
 public:
  WheelReader(const Wheels& wheels, OdometryRows* rows) : wheels_(wheels), rows_(*rows) {}
  std::vector<std::string> paths() const override { return {"name", "position", "velocity", "header.stamp"}; }
  std::size_t needed() const override { return 4; }

  void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) override {
    const std::vector<std::string_view>& names = found[0].texts;
    const auto left = static_cast<std::size_t>(std::ranges::find(names, wheels_.left) - names.begin());
    const auto right = static_cast<std::size_t>(std::ranges::find(names, wheels_.right) - names.begin());
    if (std::max(left, right) == names.size()) return Remember(names);
    const bool has_positions = found[1].numbers.size() == names.size();
    const std::vector<double>& numbers = found[has_positions ? 1 : 2].numbers;
    if (numbers.size() != names.size())
      throw LineError{"wheels without a position or a velocity", std::to_string(names.size()) + " joints"};
    if (!(std::isfinite(numbers[left]) && std::isfinite(numbers[right])))
      throw LineError{"no position of a wheel",
                      std::to_string(numbers[left]) + " and " + std::to_string(numbers[right])};
    const auto time_s = clock->At(found[3].numbers, message.receive_ns);
    if (!time_s || (!rows_.poses.empty() && *time_s < rows_.poses.back().time_s)) return;
    Pose pose;
    if (!rows_.poses.empty()) {
      const double seconds = *time_s - rows_.poses.back().time_s;
      const auto roll = [&](double before, double now) {
        if (has_positions != had_positions_) return 0.0;
        return wheels_.radius_m * (has_positions ? Turned(before, now) : before * seconds);
      };
      const double left_m = roll(left_, numbers[left]), right_m = roll(right_, numbers[right]);
      pose =
          Moved(rows_.poses.back().pose, (left_m + right_m) / 2, 0, (right_m - left_m) / wheels_.distance_m);
    }
    rows_.poses.push_back({*time_s, message.number, pose});
    left_ = numbers[left];
    right_ = numbers[right];
    had_positions_ = has_positions;
  }

 private:
  // Joints whose positions are kept within a turn jump by one.
  static double Turned(double before, double now) {
    constexpr double kTurn = 2 * std::numbers::pi, kRounding = 1e-3;
    const double turned = now - before;
    const double farthest = std::max(std::abs(now), std::abs(before));
    const bool is_within = farthest <= kTurn / 2 + kRounding;
    return is_within && std::abs(turned) > kTurn / 2 ? turned - std::copysign(kTurn, turned) : turned;
  }
  void Remember(const std::vector<std::string_view>& names) {
    constexpr std::size_t kMost = 20;
    for (const std::string_view name : names)
      if (rows_.other_joints.size() < kMost &&
          std::ranges::find(rows_.other_joints, name) == rows_.other_joints.end())
        rows_.other_joints.push_back(Printable(std::string(name), 100));
  }

  Wheels wheels_;
  OdometryRows& rows_;
  double left_ = 0, right_ = 0;  // of the message before: positions, or velocities
  bool had_positions_ = false;
};

}  // namespace

Wheels ParseWheels(const std::string& text) {
  const std::vector<std::string> parts = AtCommas(text);
  const char* reason = nullptr;
  if (parts.size() == 4 && !parts[0].empty() && !parts[1].empty() && parts[0] != parts[1]) {
    const auto radius = ParseNumber(parts[2], &reason), distance = ParseNumber(parts[3], &reason);
    constexpr double kMost_m = 100;
    if (radius && distance && *radius > 0 && *radius < kMost_m && *distance > 0 && *distance < kMost_m)
      return {parts[0], parts[1], *radius, *distance};
  }
  throw InputError("--wheels " + Printable(text, 200) +
                   ": what is meant is LEFT_JOINT,RIGHT_JOINT,RADIUS_M,DISTANCE_M, such as "
                   "wheel_left_joint,wheel_right_joint,0.033,0.16");
}

std::unique_ptr<TopicReader> ReadWheels(const Wheels& wheels, OdometryRows* rows) {
  return std::make_unique<WheelReader>(wheels, rows);
}

}  // namespace cairn::datasets::bag
