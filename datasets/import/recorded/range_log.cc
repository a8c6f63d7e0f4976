#include "datasets/import/recorded/range_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <compare>
#include <functional>
#include <limits>
#include <numbers>
#include <set>
#include <span>
#include <utility>

#include "datasets/common/range_doubts.h"
#include "datasets/import/name_index.h"
#include "datasets/import/pose_controls.h"
#include "datasets/import/repeated_rows.h"
#include "schema/error.h"
#include "schema/hash.h"

namespace cairn::datasets {
namespace {

constexpr double kMostLate_s = 1, kTick_s = 1e-6;

using Events = SpooledRows<RangeEvent>;

bool SamePose(const auto& a, const auto& b) {
  if (!a || !b) return !a && !b;
  return a->x_m == b->x_m && a->y_m == b->y_m && a->heading_rad == b->heading_rad;
}

bool HasPose(const RangeEvent& event) { return event.odometry || event.corrected; }
bool IsPosedScan(const RangeEvent& event) { return event.sensor && HasPose(event); }
bool IsPoseAlone(const RangeEvent& event) { return !event.sensor && !event.mark && !event.landmark; }

// Of all that it says.
Hash HashOf(const RangeLog& log, const RangeEvent& event) {
  Hasher hash;
  const auto add = [&hash](auto... values) { (hash.Add(std::as_bytes(std::span(&values, 1))), ...); };
  for (const auto& pose : {event.odometry, event.corrected, event.truth}) {
    add(pose.has_value());
    if (pose) add(pose->x_m, pose->y_m, pose->heading_rad);
  }
  add(event.sensor.value_or(-1));
  if (event.row) hash.Add(log.sensors[*event.sensor].scans->HashOf(*event.row).Binary());
  if (event.scan != nullptr) {
    hash.Add(std::as_bytes(std::span(event.scan->range_m)));
    hash.Add(std::as_bytes(std::span(event.scan->intensity)));
  }
  if (event.mark != nullptr) hash.Add(std::string_view(*event.mark));
  if (event.landmark != nullptr) {
    hash.Add(std::string_view(event.landmark->name));
    add(event.landmark->range_m, event.landmark->bearing_rad);
  }
  return hash.Finish();
}

// The numbers of those that say the same as an earlier one of their stamp, wherever it stands.
std::vector<std::size_t> RepeatedEvents(const RangeLog& log) {
  struct Stamp {
    double stamp_s;
    std::size_t event;
  };
  SpooledRows<Stamp> stamps(log.events.folder());
  for (std::size_t i = 0; i < log.events.size(); ++i) stamps.push_back({log.events[i].stamp_s, i});
  SortRows(&stamps, [](const Stamp& stamp) { return stamp.stamp_s; });
  std::vector<std::size_t> repeated;
  for (std::size_t first = 0, end = 0; first < stamps.size(); first = end) {
    const double stamp_s = stamps[first].stamp_s;
    while (end < stamps.size() && stamps[end].stamp_s == stamp_s) ++end;
    std::set<Hash> known;
    for (std::size_t i = first; end - first > 1 && i < end; ++i)
      if (!known.insert(HashOf(log, log.events[stamps[i].event])).second) repeated.push_back(stamps[i].event);
  }
  std::ranges::sort(repeated);
  return repeated;
}

// More than half of a sensor's scans have a stamp of their own (without scans: of the poses of odometry, if
// there are any, else of all events).
bool StampsTellApart(const Events& events, const std::vector<std::size_t>& gone) {
  const bool scans = std::ranges::any_of(events, [](const RangeEvent& e) { return e.sensor.has_value(); });
  const bool odometry =
      std::ranges::any_of(events, [](const RangeEvent& e) { return e.odometry.has_value(); });
  struct Stamp {
    std::size_t sensor;
    double stamp_s;
    auto operator<=>(const Stamp&) const = default;
  };
  SpooledRows<Stamp> stamps(events.folder());
  auto next_gone = gone.begin();
  for (std::size_t i = 0; i < events.size(); ++i) {
    const RangeEvent& event = events[i];
    if (next_gone != gone.end() && *next_gone == i)
      ++next_gone;
    else if (scans ? event.sensor.has_value() : !odometry || event.odometry)
      stamps.push_back({event.sensor.value_or(0), event.stamp_s});
  }
  SortRows(&stamps, std::identity());
  std::size_t different = 0;
  for (std::size_t i = 0; i < stamps.size(); ++i) different += i == 0 || stamps[i] != stamps[i - 1] ? 1 : 0;
  return 2 * different > stamps.size();
}

void Number(Events* events) {
  for (std::size_t i = 0; i < events->size(); ++i) (*events)[i].stamp_s = static_cast<double>(i);
}

// Takes out what is out of place. Returns whether the others are in the order of time.
bool DropLate(const std::string& path, BadLines* bad, ImportReport* report, Events* events) {
  double latest_s = -std::numeric_limits<double>::infinity();
  bool in_order = true;
  events->EraseIf([&](const RangeEvent& event) {
    const bool late = event.stamp_s < latest_s - kMostLate_s;
    if (IsPoseAlone(event) && (late || event.stamp_s <= 0)) {
      ++report->dropped[late && event.stamp_s > 0 ? "pose whose time stamp is more than 1 s behind"
                                                  : "pose without a time stamp above 0"];
      return true;
    }
    if (late)
      bad->Add(path, event.line, "time runs backwards",
               std::to_string(event.stamp_s) + " after " + std::to_string(latest_s));
    in_order = in_order && (late || event.stamp_s >= latest_s);
    latest_s = std::max(latest_s, event.stamp_s);
    return late;
  });
  return in_order;
}

// Events of one stamp, from `first` to `end`: their times, of which the first is `time_s`. Returns the last.
double SpreadScans(std::size_t first, std::size_t end, double time_s, std::int64_t* repeats, Events* events) {
  const RangeEvent* before = nullptr;
  bool scans = false;
  for (std::size_t i = first; i < end; ++i) scans = scans || IsPosedScan((*events)[i]);
  double scan_s = time_s;
  for (std::size_t i = first; i < end; ++i) {
    RangeEvent& event = (*events)[i];
    if (event.stamp_s != time_s) event.stamp_s = time_s;  // most are not written to
    if (!IsPosedScan(event)) {
      if (!scans) continue;
      event.odometry = std::nullopt;
      event.corrected = std::nullopt;
      continue;
    }
    const bool same = before == nullptr || (SamePose(before->odometry, event.odometry) &&
                                            SamePose(before->corrected, event.corrected));
    if (!same) scan_s += kTick_s;
    *repeats += same ? 0 : 1;
    if (event.stamp_s != scan_s) event.stamp_s = scan_s;
    before = &event;
  }
  return scan_s;
}

// One pose at one time.
void TellTimesApart(ImportReport* report, Events* events) {
  std::int64_t repeats = 0;
  double last_s = -std::numeric_limits<double>::infinity();
  for (std::size_t first = 0; first < events->size();) {
    const double stamp_s = (*events)[first].stamp_s;
    std::size_t end = first + 1;
    while (end < events->size() && (*events)[end].stamp_s == stamp_s) ++end;
    last_s = SpreadScans(first, end, stamp_s > last_s ? stamp_s : last_s + kTick_s, &repeats, events);
    first = end;
  }
  if (repeats > 0)
    report->warnings.push_back(std::to_string(repeats) +
                               " scans repeat the time of the scan before: they count a microsecond later");
}

// All that there are; of those at one time the last.
struct PosesOfLog {
  Poses odometry, corrected, truth;
};
PosesOfLog PosesOf(const RangeLog& log) {
  Poses none(log.events.folder());
  none.from.file = log.path;
  none.from.before_line = log.before_line;
  PosesOfLog all{none, none, none};
  const auto add = [](const RangeEvent& event, const std::optional<Pose>& pose, Poses* poses) {
    if (!pose) return;
    if (!poses->time_s.empty() && poses->time_s.back() == event.stamp_s) poses->RemoveLast();
    poses->Add(event.stamp_s, pose->x_m, pose->y_m, pose->heading_rad, event.line);
  };
  for (const RangeEvent& event : log.events) {
    add(event, event.odometry, &all.odometry);
    add(event, event.corrected, &all.corrected);
    add(event, event.truth, &all.truth);
  }
  return all;
}

void AddScan(double time_s, const Readings& scan, RangeRows* sensor) {
  CAIRN_DEMAND(scan.range_m.size() == sensor->beam_x_m.size(), "a scan of other beams than its sensor's");
  sensor->time_s.push_back(time_s);
  sensor->range_m.insert(sensor->range_m.end(), scan.range_m.begin(), scan.range_m.end());
  // Of a sensor with some, each reading has one, or NaN.
  if (scan.intensity.empty() && sensor->intensity.empty()) return;
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  sensor->intensity.resize(sensor->range_m.size() - scan.range_m.size(), kNone);
  sensor->intensity.insert(sensor->intensity.end(), scan.intensity.begin(), scan.intensity.end());
  sensor->intensity.resize(sensor->range_m.size(), kNone);
}

// Drivers that know none write zeros.
void DropConstantIntensities(RangeRows* sensor) {
  const auto differs = [&](float one) { return !std::isnan(one) && one != sensor->intensity.front(); };
  if (std::ranges::none_of(sensor->intensity, differs)) sensor->intensity.clear();
}

// A reach that nobody states is the reading that fills up the log, if one does.
void FindReach(ImportReport* report, RangeRows* sensor) {
  if (!sensor->reach_is_assumed || sensor->taken) return;
  std::vector<double> answers(sensor->range_m.begin(), sensor->range_m.end());
  for (double& range : answers) range = Answer(range, 0, sensor->max_range_m);
  const auto found = FindConstantReading(answers, sensor->beam_x_m.size());
  if (!found) return;
  sensor->max_range_m = found->range_m;
  report->warnings.push_back(fmt::format(
      "{0}: {1:.2g}% of its readings are exactly {2:.6g} m, and hardly one is larger: that is "
      "taken for its reach, where nothing came back (--{3}-max-range-m={2:.6g} says so, and any "
      "other reach takes them for walls)",
      sensor->sensor, 100 * found->share, found->range_m, sensor->sensor == "sonar" ? "sonar" : "laser"));
}

void MarkUnanswered(ImportReport* report, RangeRows* sensor) {
  std::int64_t unanswered = sensor->taken ? sensor->taken->unanswered : 0;
  for (double& range : sensor->range_m) {
    if (range > 0 && range < sensor->max_range_m) continue;
    range = std::numeric_limits<double>::quiet_NaN();
    ++unanswered;
  }
  if (unanswered > 0)
    report->read["readings of " + sensor->sensor + " without an answer within its reach"] += unanswered;
}

// Puts the events in order, at times that tell them apart.
void Order(RangeLog* log, BadLines* bad, ImportReport* report) {
  const std::vector<std::size_t> repeated = log->numbered ? std::vector<std::size_t>() : RepeatedEvents(*log);
  if (log->numbered || !StampsTellApart(log->events, repeated)) {
    if (!log->numbered)
      report->warnings.emplace_back("the time stamps do not tell the scans apart: time is the line's number");
    Number(&log->events);
  } else {
    RemoveRows(repeated, &log->events);
    if (!repeated.empty())
      report->dropped[SameAsEarlier("line or message")] += static_cast<std::int64_t>(repeated.size());
    if (!DropLate(log->path, bad, report, &log->events)) SortByTime(&log->events);
  }
  TellTimesApart(report, &log->events);
}

// Scans and marks, those aside of the odometry's time left out.
void AddSensed(RangeLog* log, double first_s, double last_s, NameIndex* known, ImportReport* report,
               RobotRows* to) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  RobotRows& robot = *to;
  NameIndex& names = *known;
  const SpooledRows<std::size_t> none(log->events.folder());
  const SpooledRows<double> no_times(log->events.folder());
  std::vector<SpooledRows<std::size_t>> rows(log->sensors.size(), none);  // of each sensor's own
  for (RangeRows& sensor : log->sensors) sensor.time_s = no_times;
  for (const RangeEvent& event : log->events) {
    if (IsPoseAlone(event)) continue;  // most of them
    if (event.stamp_s < first_s || event.stamp_s > last_s) {
      const char* what = event.sensor ? "scan" : event.mark ? "mark" : "landmark";
      ++report->dropped[std::string(what) + " outside the odometry's time"];
      continue;
    }
    if (event.row) {
      rows[*event.sensor].push_back(*event.row);
      log->sensors[*event.sensor].time_s.push_back(event.stamp_s);
    } else if (event.sensor) {
      AddScan(event.stamp_s, *event.scan, &log->sensors[*event.sensor]);
      *event.scan = {};  // the log has it now
    }
    if (event.landmark)
      robot.observations.Add(event.stamp_s,
                             event.landmark->name.empty() ? -1 : names.FindOrAdd(event.landmark->name),
                             event.landmark->range_m, event.landmark->bearing_rad);
    const bool named =
        event.mark && log->marks_are_names && !event.mark->empty() && !MeansUnknown(*event.mark);
    const std::int32_t landmark = named ? names.FindOrAdd(*event.mark) : -1;
    if (event.mark) robot.observations.Add(event.stamp_s, landmark, kNan, kNan);
  }
  for (std::size_t i = 0; i < log->sensors.size(); ++i) {
    RangeRows& sensor = log->sensors[i];
    if (sensor.time_s.empty()) continue;
    if (sensor.scans) sensor.taken = std::move(*sensor.scans).Take(rows[i], sensor.beams_kept);
    DropConstantIntensities(&sensor);
    FindReach(report, &sensor);
    MarkUnanswered(report, &sensor);
    robot.ranges.push_back(std::move(sensor));
  }
}

void AddRobot(RangeLog* ranges, BadLines* bad, NameIndex* names, ImportReport* report, RobotRows* robot) {
  Order(ranges, bad, report);
  PosesOfLog poses = PosesOf(*ranges);
  Poses& odometry = poses.odometry;
  if (odometry.time_s.empty()) odometry = poses.corrected;
  if (odometry.time_s.empty())
    throw InputError(ranges->path + ": there is neither odometry nor a pose in it");
  const double first_s = odometry.time_s.front(), last_s = odometry.time_s.back();
  robot->truth = std::move(poses.truth);
  robot->name = ranges->robot;
  robot->odometry = ControlsOf(odometry);
  robot->odometry_poses = std::move(odometry);
  robot->poses = std::move(poses.corrected);
  AddSensed(ranges, first_s, last_s, names, report, robot);
  ranges->events.clear();
  ranges->things = {};
}

}  // namespace

void SortByTime(SpooledRows<RangeEvent>* events) {
  SortRows(events, [](const RangeEvent& event) { return event.stamp_s; });
}

double Answer(double range_m, double least_m, double reach_m) {
  return range_m > least_m && range_m < reach_m ? range_m : std::numeric_limits<double>::quiet_NaN();
}

RangeRows LaserFan(const std::string& sensor, std::size_t beams, double step_deg, double ahead_m,
                   double max_range_m) {
  RangeRows rows;
  rows.sensor = sensor;
  rows.max_range_m = max_range_m;
  constexpr double kRight_deg = -90;
  for (std::size_t beam = 0; beam < beams; ++beam) {
    const double at_deg = kRight_deg + static_cast<double>(beam) * step_deg;
    rows.beam_x_m.push_back(ahead_m);
    rows.beam_y_m.push_back(0);
    rows.beam_heading_rad.push_back(at_deg * std::numbers::pi / 180);
  }
  return rows;
}

ImportReport MakeRangeLog(RangeLog ranges, const NoiseParameters& noise, BadLines* bad, ImportReport report,
                          Blob* log) {
  std::vector<RangeLog> robots;
  robots.push_back(std::move(ranges));
  return MakeRangeLog(std::move(robots), noise, bad, std::move(report), log);
}

ImportReport MakeRangeLog(std::vector<RangeLog> robots, const NoiseParameters& noise, BadLines* bad,
                          ImportReport report, Blob* log) {
  LogRows rows;
  rows.noise = noise;
  NameIndex names;
  for (RangeLog& ranges : robots) AddRobot(&ranges, bad, &names, &report, &rows.robots.emplace_back());
  rows.landmarks = names.names();
  report.skipped = bad->counts();
  *log = MakeLog(std::move(rows), robots.front().path, &report);
  return report;
}

}  // namespace cairn::datasets
