#include "datasets/import/recorded/carmen_log.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "datasets/import/recorded/carmen_mount.h"

namespace cairn::datasets {
namespace {

constexpr double kSameAngle = 1e-4, kSamePlace_m = 2e-3;

void NeedAsMany(std::size_t beams, std::size_t first) {
  if (beams == first) return;
  throw LineError{"other beams than the sensor's first scan",
                  std::to_string(beams) + " instead of " + std::to_string(first)};
}

void NeedSameAngle(const std::optional<double>& a, const std::optional<double>& b) {
  if (a && b && std::abs(*a - *b) > kSameAngle)
    throw LineError{"other geometry than the sensor's first scan", "its start angle or resolution changed"};
}

class Reader {
 public:
  explicit Reader(ImportReport* report) : report_(report) {}

  void ReadLine(const Fields& line, std::size_t number) {
    const std::string message(line.Text(0));
    CarmenEvent event;
    event.event.line = number;
    if (const auto laser = LaserOf(message)) {
      ReadScan(line, message, *laser, &event);
    } else if (message == "SONAR") {
      ReadSonar(line, &event.event);
    } else if (message == "MARKER" || message == "LANDMARK") {
      ReadMarker(line, &event.event);
    } else if (message == "ODOM" || message == "TRUEPOS") {
      const CarmenPose pose = ParsePose(line);
      event.event.stamp_s = pose.stamp_s;
      if (message == "ODOM")
        event.event.odometry = pose.pose;
      else
        event.event.truth = pose.pose;
    } else if (message == "PARAM") {
      log_.params[std::string(line.Text(1))] = line.Text(2);
      ++report_->read[message];
      return;
    } else if (IsUnusedMessage(message)) {
      log_.mended |= message == "NEFF";
      ++report_->dropped[message + ", which is not used"];
      return;
    } else {
      throw UnknownMessage(message);
    }
    ++report_->read[message];
    log_.events.push_back(event);
  }

  CarmenLog Take() { return std::move(log_); }

 private:
  void ReadScan(const Fields& line, const std::string& message, CarmenLaser laser, CarmenEvent* event) {
    CarmenScan scan = ParseScan(line, laser.form);
    auto source = std::ranges::find(log_.sources, message, &CarmenSource::message);
    if (source == log_.sources.end()) {
      log_.sources.push_back({message,
                              laser.laser,
                              scan.range_m.size(),
                              0,
                              scan.start_rad,
                              scan.step_rad,
                              scan.max_range_m,
                              {}});
      source = log_.sources.end() - 1;
    }
    NeedAsMany(scan.range_m.size(), source->beams);
    NeedSameAngle(scan.start_rad, source->start_rad);
    NeedSameAngle(scan.step_rad, source->step_rad);
    ++source->scans;
    if (scan.laser) source->mounts.push_back(Relative(*scan.robot, *scan.laser));
    event->laser = scan.laser;
    event->event.stamp_s = scan.stamp_s;
    event->event.odometry = scan.robot;
    event->event.sensor = static_cast<std::uint32_t>(source - log_.sources.begin());
    event->event.scan = log_.things.Keep(Readings{std::move(scan.range_m), std::move(scan.remission)});
  }

  void ReadSonar(const Fields& line, RangeEvent* event) {
    CarmenSonar scan = ParseSonar(line);
    CarmenSonar& first = log_.sonar;
    if (first.offsets.empty()) first = scan;
    NeedAsMany(scan.offsets.size(), first.offsets.size());
    for (std::size_t s = 0; s < scan.offsets.size(); ++s) {
      const Pose moved = Relative(first.offsets[s], scan.offsets[s]);
      if (std::hypot(moved.x_m, moved.y_m) > kSamePlace_m || std::abs(moved.heading_rad) > kSameAngle)
        throw LineError{"other geometry than the sensor's first scan",
                        "sonar " + std::to_string(s) + " has moved"};
    }
    event->stamp_s = scan.stamp_s;
    event->sensor = kCarmenSonar;
    event->scan = log_.things.Keep(Readings{std::move(scan.range_m)});
  }

  // MARKER text time host time; the text may be of several words, or none.
  void ReadMarker(const Fields& line, RangeEvent* event) {
    constexpr std::size_t kBehind = 3;
    if (line.size() < 1 + kBehind) throw LineError{"line cut short", "no time of the marker"};
    event->stamp_s = line.Stamp(line.size() - kBehind);
    std::string text;
    for (std::size_t f = 1; f + kBehind < line.size(); ++f)
      text += (text.empty() ? "" : " ") + std::string(line.Text(f));
    event->mark = log_.things.Keep(std::move(text));
  }

  CarmenLog log_;
  ImportReport* report_;
};

}  // namespace

std::optional<double> CarmenLog::Param(const std::string& name) const {
  const auto found = params.find(name);
  const char* reason = "";
  return found == params.end() ? std::nullopt : ParseNumber(found->second, &reason);
}

std::optional<double> CarmenLog::PositiveParam(const std::string& name) const {
  const std::optional<double> number = Param(name);
  return number && *number > 0 ? number : std::nullopt;
}

CarmenLog ReadCarmenLog(const std::string& path, BadLines* bad, ImportReport* report) {
  Reader reader(report);
  ForEachLine(path, bad, [&](const Fields& line, std::size_t number) { reader.ReadLine(line, number); });
  return reader.Take();
}

}  // namespace cairn::datasets
