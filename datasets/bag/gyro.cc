#include "datasets/bag/gyro.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace cairn::datasets::bag {
namespace {

class GyroReader : public TopicReader {
 public:
  explicit GyroReader(GyroRows* rows) : rows_(*rows) {}
  std::vector<std::string> paths() const override {
    return {"angular_velocity.x", "angular_velocity.y", "angular_velocity.z",
            "header.stamp",       "header.frame_id",    "angular_velocity_covariance"};
  }
  std::size_t needed() const override { return 4; }
  void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) override {
    constexpr double kMost_radps = 1000;
    const PointInSpace rate{rows_.factor * FirstNumber(found[0]), rows_.factor * FirstNumber(found[1]),
                            rows_.factor * FirstNumber(found[2])};
    if (FirstNumber(found[5]) == -1) throw LineError{"no rates of a gyro", "its covariance begins with -1"};
    if (!(std::hypot(rate.x, rate.y, rate.z) < kMost_radps))
      throw LineError{"no rates of a gyro", fmt::format("{} {} {} rad/s", rate.x, rate.y, rate.z)};
    const auto time_s = clock->At(found[3].numbers, message.receive_ns);
    if (!time_s) return;
    if (rows_.rows.empty()) rows_.frame = FrameName(FirstText(found[4]));
    rows_.rows.push_back({*time_s, rate});
  }

 private:
  GyroRows& rows_;
};

// How far it has turned, by the trapezoid rule.
class YawTrack {
 public:
  YawTrack(SpooledRows<GyroRow> rows, const Transform& mount) : rows_(rows.folder()) {
    SortRows(&rows, [](const GyroRow& row) { return row.time_s; });
    const Transform turned{0, 0, 0, mount.qx, mount.qy, mount.qz, mount.qw};
    YawRow last;
    for (const GyroRow& row : rows) {
      const double rate = Apply(turned, row.rate_radps).z;
      const double turn = rows_.empty() ? 0 : (row.time_s - last.time_s) * (rate + last.rate) / 2;
      last = {row.time_s, rate, last.yaw + turn};
      rows_.push_back(last);
    }
  }
  // Nothing where it has a gap between the two times, or does not reach that far. From one call to the next
  // times rise, but for a little.
  std::optional<double> Between(double from_s, double to_s) {
    const auto from = SegmentOf(from_s), to = SegmentOf(to_s);
    if (!from || !to) return std::nullopt;
    for (std::size_t i = *from; i <= *to; ++i)
      if (rows_[i + 1].time_s - rows_[i].time_s > kMostGap_s) return std::nullopt;
    return YawAt(*to, to_s) - YawAt(*from, from_s);
  }

 private:
  static constexpr double kMostGap_s = 0.5;
  struct YawRow {
    double time_s = 0, rate = 0, yaw = 0;
  };
  // That between rows i and i + 1.
  std::optional<std::size_t> SegmentOf(double at_s) {
    if (rows_.size() < 2) return std::nullopt;
    while (next_ < rows_.size() && rows_[next_].time_s <= at_s) ++next_;
    while (next_ > 0 && rows_[next_ - 1].time_s > at_s) --next_;
    if (next_ == 0 || at_s > rows_.back().time_s) return std::nullopt;
    return std::min(next_, rows_.size() - 1) - 1;
  }
  double YawAt(std::size_t i, double at_s) const {
    const YawRow &from = rows_[i], &to = rows_[i + 1];
    const double length_s = to.time_s - from.time_s, since_s = at_s - from.time_s;
    if (length_s <= 0) return from.yaw;
    const double rate = from.rate + (to.rate - from.rate) * since_s / length_s;
    return from.yaw + since_s * (from.rate + rate) / 2;
  }
  SpooledRows<YawRow> rows_;
  std::size_t next_ = 0;  // the first row after the time that was asked for last
};

struct Halt {
  double middle_s = 0, length_s = 0, rate_radps = 0;
};

// Where the odometry stands, and how fast the gyro turns meanwhile.
std::vector<Halt> HaltsOf(const SpooledRows<PoseRow>& poses, YawTrack* track) {
  constexpr double kStill_mps = 0.005, kStill_radps = 0.01, kLeast_s = 1, kMargin_s = 0.1;
  std::vector<Halt> halts;
  for (std::size_t first = 0, i = 1; i <= poses.size(); ++i) {
    if (i < poses.size()) {
      const double seconds = poses[i].time_s - poses[i - 1].time_s;
      const Pose step = Relative(poses[i - 1].pose, poses[i].pose);
      if (std::hypot(step.x_m, step.y_m) <= kStill_mps * seconds &&
          std::abs(step.heading_rad) <= kStill_radps * seconds)
        continue;
    }
    const double from_s = poses[first].time_s + kMargin_s, to_s = poses[i - 1].time_s - kMargin_s;
    first = i;
    if (to_s - from_s < kLeast_s) continue;
    if (const auto turn = track->Between(from_s, to_s))
      halts.push_back({(from_s + to_s) / 2, to_s - from_s, *turn / (to_s - from_s)});
  }
  return halts;
}

// Those in which somebody turned the robot, or its wheels slipped, are none.
void LeaveOutTurns(std::vector<Halt>* halts) {
  if (halts->empty()) return;
  constexpr double kMostApart_radps = 0.02;
  std::vector<double> rates;
  for (const Halt& halt : *halts) rates.push_back(halt.rate_radps);
  std::ranges::nth_element(rates, rates.begin() + static_cast<std::ptrdiff_t>(rates.size() / 2));
  const double usual = rates[rates.size() / 2];
  std::erase_if(*halts, [&](const Halt& h) { return std::abs(h.rate_radps - usual) > kMostApart_radps; });
}

double BiasAt(const std::vector<Halt>& halts, double time_s) {
  if (halts.empty()) return 0;
  const auto next = std::ranges::upper_bound(halts, time_s, {}, &Halt::middle_s);
  if (next == halts.begin()) return next->rate_radps;
  const Halt& before = *(next - 1);
  if (next == halts.end()) return before.rate_radps;
  const double share = (time_s - before.middle_s) / (next->middle_s - before.middle_s);
  return before.rate_radps + share * (next->rate_radps - before.rate_radps);
}

std::string BiasText(const std::vector<Halt>& halts) {
  if (halts.empty())
    return "the robot never stands still for a second, so its bias is not known and taken for 0";
  double low = halts.front().rate_radps, high = low, together_s = 0;
  for (const Halt& halt : halts) {
    low = std::min(low, halt.rate_radps);
    high = std::max(high, halt.rate_radps);
    together_s += halt.length_s;
  }
  return fmt::format("its bias, measured in {} halts of {:.1f} s together, is {:.5f} to {:.5f} rad/s",
                     halts.size(), together_s, low, high);
}

// Products of what both say, step by step.
struct Agreement {
  double both = 0, odometry = 0, turned_rad = 0;
  void Add(double odometry_rad, double gyro_rad) {
    both += odometry_rad * gyro_rad;
    odometry += odometry_rad * odometry_rad;
    turned_rad += std::abs(odometry_rad);
  }
};

void WarnWhereTheyContradict(const std::string& topic, const Agreement& agreement, ImportReport* report) {
  constexpr double kLeastTurn_rad = 1, kMostFactor = 2, kLeastDegrees = 30, kMostDegrees = 120;
  if (agreement.turned_rad < kLeastTurn_rad) return;
  const double factor = agreement.both / agreement.odometry;
  if (factor > 1 / kMostFactor && factor < kMostFactor) return;
  const std::string hint =
      factor < 0 ? "; does it hang upside down, and tf does not say so? --gyro " + topic + "*-1 turns it over"
      : factor > kLeastDegrees && factor < kMostDegrees
          ? "; are its rates in degrees? --gyro " + topic + "*deg reads them so"
          : std::string();
  report->warnings.push_back(fmt::format(
      "{}: where the odometry turns by a radian the gyro turns by {:.2f}: one of the two is wrong{}", topic,
      factor, hint));
}

}  // namespace

std::unique_ptr<TopicReader> ReadGyro(GyroRows* rows) { return std::make_unique<GyroReader>(rows); }

void TurnByGyro(const GyroRows& gyro, const Transform& mount, SpooledRows<PoseRow>* poses,
                ImportReport* report) {
  YawTrack track(gyro.rows, mount);
  SortRows(poses, [](const PoseRow& row) { return row.time_s; });
  std::vector<Halt> halts = HaltsOf(*poses, &track);
  LeaveOutTurns(&halts);
  std::int64_t without = 0;
  Agreement agreement;
  Pose before;  // as the odometry has it
  for (std::size_t i = 0; i < poses->size(); ++i) {
    PoseRow& row = (*poses)[i];
    const Pose now = row.pose;
    if (i > 0) {
      const PoseRow& last = (*poses)[i - 1];
      double turn = WrapAngle(now.heading_rad - before.heading_rad);
      const Pose way = Between({before.x_m, before.y_m, before.heading_rad + turn / 2}, now);
      if (const auto turned = track.Between(last.time_s, row.time_s)) {
        const double seconds = row.time_s - last.time_s;
        const double by_gyro = *turned - seconds * BiasAt(halts, last.time_s + seconds / 2);
        agreement.Add(turn, by_gyro);
        turn = by_gyro;
      } else {
        ++without;
      }
      row.pose = Moved(last.pose, way.x_m, way.y_m, turn);
    }
    before = now;
  }
  report->warnings.push_back(gyro.topic + ": the odometry turns as this gyro does; " + BiasText(halts));
  if (without > 0)
    report->warnings.push_back(
        gyro.topic + ": " + std::to_string(without) +
        " steps of the odometry lie in gaps of the gyro: they turn as the odometry says");
  WarnWhereTheyContradict(gyro.topic, agreement, report);
}

}  // namespace cairn::datasets::bag
