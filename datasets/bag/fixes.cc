#include "datasets/bag/fixes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "datasets/bag/antenna.h"

namespace cairn::datasets::bag {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180;

class FixReader : public TopicReader {
 public:
  explicit FixReader(FixRows* rows) : rows_(*rows) {}
  std::vector<std::string> paths() const override {
    return {"latitude",
            "longitude",
            "status.status",
            "header.stamp",
            "altitude",
            "position_covariance",
            "position_covariance_type",
            "header.frame_id"};
  }
  std::size_t needed() const override { return 4; }
  void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) override {
    const double latitude = FirstNumber(found[0]), longitude = FirstNumber(found[1]);
    if (FirstNumber(found[2]) < 0 || std::isnan(latitude) || std::isnan(longitude)) {
      ++rows_.without;
      return;
    }
    if (!(std::abs(latitude) <= 90 && std::abs(longitude) <= 360))
      throw LineError{"no place on Earth", fmt::format("latitude {}, longitude {}", latitude, longitude)};
    const auto time_s = clock->At(found[3].numbers, message.receive_ns);
    if (!time_s) return;
    if (rows_.fixes.empty()) rows_.frame = FrameName(FirstText(found[7]));
    const double altitude = FirstNumber(found[4]);
    const std::vector<double>& covariance = found[5].numbers;
    constexpr std::size_t kNorth = 4;
    const bool is_known = FirstNumber(found[6]) > 0 && covariance.size() > kNorth;
    rows_.fixes.push_back({*time_s, message.number, latitude, longitude,
                           std::isfinite(altitude) ? altitude : 0,
                           is_known ? (covariance[0] + covariance[kNorth]) / 2 : 0});
  }

 private:
  FixRows& rows_;
};

// From the middle of the Earth: x to where latitude and longitude are 0, z to the north pole.
std::array<double, 3> Geocentric(const Fix& fix) {
  constexpr double kEquator_m = 6378137, kFlattening = 1 / 298.257223563;
  constexpr double kEccentricity2 = kFlattening * (2 - kFlattening);
  const double phi = fix.latitude_deg * kDegree_rad, lambda = fix.longitude_deg * kDegree_rad;
  const double across_m = kEquator_m / std::sqrt(1 - kEccentricity2 * std::sin(phi) * std::sin(phi));
  const double out_m = (across_m + fix.altitude_m) * std::cos(phi);
  return {out_m * std::cos(lambda), out_m * std::sin(lambda),
          (across_m * (1 - kEccentricity2) + fix.altitude_m) * std::sin(phi)};
}

// East and north of `first`.
Point OnPlane(const Fix& first, const Fix& fix) {
  const auto from = Geocentric(first), to = Geocentric(fix);
  const double x = to[0] - from[0], y = to[1] - from[1], z = to[2] - from[2];
  const double phi = first.latitude_deg * kDegree_rad, lambda = first.longitude_deg * kDegree_rad;
  const double out = x * std::cos(lambda) + y * std::sin(lambda);
  return {y * std::cos(lambda) - x * std::sin(lambda), z * std::cos(phi) - out * std::sin(phi)};
}

// Headings along rows whose positions are known: between stations that are a metre apart.
void AddCourse(std::vector<PoseRow>* rows) {
  constexpr double kApart_m = 1;
  const auto point = [&](std::size_t i) { return Point{(*rows)[i].pose.x_m, (*rows)[i].pose.y_m}; };
  std::vector<std::size_t> stations = {0};
  for (std::size_t i = 1; i < rows->size(); ++i)
    if (DistanceM(point(stations.back()), point(i)) >= kApart_m) stations.push_back(i);
  std::vector<double> heading(stations.size(), 0);
  for (std::size_t m = 0; stations.size() > 1 && m < stations.size(); ++m) {
    const Point from = point(stations[m == 0 ? 0 : m - 1]);
    const Point to = point(stations[std::min(m + 1, stations.size() - 1)]);
    heading[m] = std::atan2(to.y_m - from.y_m, to.x_m - from.x_m);
  }
  for (std::size_t i = 0, m = 0; i < rows->size(); ++i) {
    if (m + 1 < stations.size() && i >= stations[m + 1]) ++m;
    const std::size_t next = std::min(m + 1, stations.size() - 1);
    const double length = static_cast<double>(std::max<std::size_t>(stations[next] - stations[m], 1));
    const double share = next == m ? 0 : static_cast<double>(i - stations[m]) / length;
    (*rows)[i].pose.heading_rad = Interpolate({0, 0, heading[m]}, {0, 0, heading[next]}, share).heading_rad;
  }
}

// In the middle of all, an axis; nothing where covariances do not say.
std::optional<double> SigmaOf(std::vector<Fix> fixes) {
  std::erase_if(fixes, [](const Fix& fix) { return !(fix.variance_m2 > 0); });
  if (fixes.empty()) return std::nullopt;
  const auto middle = fixes.begin() + static_cast<std::ptrdiff_t>(fixes.size() / 2);
  std::ranges::nth_element(fixes, middle, {}, &Fix::variance_m2);
  return std::sqrt(middle->variance_m2);
}

// Says in the log's words what was done about it.
std::string PlaceOnRobot(const std::optional<Pose>& antenna, const SpooledRows<PoseRow>& odometry,
                         std::optional<double> sigma_m, std::vector<PoseRow>* rows) {
  const std::string of_course = "; its headings are the course over a metre";
  constexpr double kLeast_m = 0.02;
  if (!antenna) return "they are of the antenna, and no tf says where on the robot that is" + of_course;
  const double aside_m = std::hypot(antenna->x_m, antenna->y_m);
  if (aside_m < kLeast_m) return "the antenna sits in the robot's middle" + of_course;
  const std::string where =
      fmt::format("the antenna, {:.2f} m ahead of the robot's middle and {:.2f} m to its left", antenna->x_m,
                  antenna->y_m);
  if (sigma_m.value_or(0) > aside_m)
    return "they are of " + where + ", which is less than they tell apart" + of_course;
  if (odometry.empty()) return "they are of " + where + ", and no odometry tells its headings" + of_course;
  const std::size_t all = rows->size(), left_out = TakeOffAntenna(*antenna, odometry, rows);
  std::string text =
      "they are of " + where +
      ", which is taken off by odometry's headings, turned to the fixes over some metres; so are the "
      "truth's";
  if (left_out > 0)
    text += fmt::format(
        "; {} of {} are left out: there odometry has gaps, hardly moves, or does not fit the fixes", left_out,
        all);
  return text;
}

}  // namespace

std::unique_ptr<TopicReader> ReadFixes(FixRows* rows) { return std::make_unique<FixReader>(rows); }

std::vector<PoseRow> PosesOfFixes(const FixRows& rows, const std::optional<Pose>& antenna,
                                  const SpooledRows<PoseRow>& odometry, std::optional<Fix>* origin,
                                  ImportReport* report) {
  std::vector<Fix> fixes = rows.fixes;
  std::ranges::stable_sort(fixes, {}, &Fix::time_s);
  std::vector<PoseRow> poses;
  for (const Fix& fix : fixes) {
    if (!*origin) *origin = fix;
    const Point at = OnPlane(**origin, fix);
    poses.push_back({fix.time_s, fix.number, {at.x_m, at.y_m, 0}});
  }
  if (rows.without > 0) report->dropped["messages of " + rows.topic + " without a fix"] += rows.without;
  if (poses.empty()) {
    report->warnings.push_back(rows.topic + ": none of its messages has a fix: there is no truth");
    return poses;
  }
  AddCourse(&poses);
  const std::optional<double> sigma_m = SigmaOf(fixes);
  const std::string place = PlaceOnRobot(antenna, odometry, sigma_m, &poses);
  report->warnings.push_back(
      fmt::format("{}: the truth is its fixes as metres east and north of {:.6f}, {:.6f}; {}; {}", rows.topic,
                  (*origin)->latitude_deg, (*origin)->longitude_deg,
                  sigma_m ? fmt::format("their covariances say {:.2g} m, an axis", *sigma_m)
                          : "how exact they are their covariances do not say",
                  place));
  return poses;
}

}  // namespace cairn::datasets::bag
