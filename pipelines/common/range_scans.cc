#include "pipelines/common/range_scans.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <span>

#include "pipelines/common/handed_over.h"
#include "pipelines/common/pose_track.h"
#include "schema/error.h"
#include "schema/kinds/grid_map.h"
#include "schema/kinds/log.h"
#include "schema/text.h"

namespace cairn {
namespace {

constexpr double kMarginM = 0.5;
constexpr std::size_t kAlignment = 64;  // of arrays, in bytes

std::string Numbered(const std::string& name, std::size_t scan, double time_s) {
  return name + ", scan " + std::to_string(scan) + " (" + std::to_string(time_s) + " s)";
}

[[noreturn]] void Refuse(const std::string& name, std::size_t scan, double time_s, const std::string& why) {
  throw InputError(Numbered(name, scan, time_s) + ": " + why);
}

// The groups that range scans may stand in, in their order.
const std::vector<std::string> kGroups(std::begin(kRangeSensors), std::end(kRangeSensors));

std::vector<std::string> Chosen(const GridOptions& options) {
  const std::vector<std::string> names = ByCommas(options.sensors);
  for (const std::string& name : names) {
    if (std::ranges::find(kGroups, name) == kGroups.end())
      throw InputError("option 'sensors': there are sonar, infrared, laser and laser2 to laser5, no '" +
                       name + "'");
  }
  return names.empty() ? kGroups : names;
}

// Which of the log's robots. A name may have a comma in it: alone it is understood.
std::vector<std::uint8_t> ChosenRobots(const GridOptions& options, const std::vector<std::string>& robots) {
  if (options.robots.empty()) return std::vector<std::uint8_t>(robots.size(), 1);
  const bool is_one = std::ranges::find(robots, options.robots) != robots.end();
  const std::vector<std::string> names =
      is_one ? std::vector<std::string>{options.robots} : ByCommas(options.robots);
  std::vector<std::uint8_t> chosen(robots.size());
  for (const std::string& name : names) {
    const auto robot = std::ranges::find(robots, name);
    if (robot == robots.end())
      throw InputError("option 'robots': the log has no robot '" + name + "', it has " + NameList(robots));
    chosen[static_cast<std::size_t>(robot - robots.begin())] = 1;
  }
  if (names.empty()) throw InputError("option 'robots': '" + options.robots + "' names none");
  return chosen;
}

void CheckRanges(const RangeScans& sensor) {
  const auto range = sensor.range_m.As<double>();
  const std::size_t beams = sensor.beams.size();
  const double most_m = sensor.max_range_m * (1 + kinds::kReachRounding);
  for (std::size_t r = 0; r < range.size(); ++r) {
    if (std::isnan(range[r]) || (range[r] >= 0 && range[r] <= most_m)) continue;
    const std::size_t s = r / beams;
    Refuse(sensor.name, sensor.row.empty() ? s : static_cast<std::size_t>(sensor.row[s]), sensor.time_s[s],
           "beam " + std::to_string(r % beams) + " measures " + std::to_string(range[r]) +
               " m, which is negative or beyond max_range_m (NaN says that nothing came back)");
  }
}

// A driver may write the reach where nothing came back: such readings become NaN. Copied only where there are
// some.
void TakeOutReach(RangeScans* sensor) {
  const auto range = sensor->range_m.As<double>();
  const auto is_reach = [&](double range_m) {
    return !std::isnan(range_m) && !kinds::IsEcho(range_m, sensor->max_range_m);
  };
  if (std::ranges::none_of(range, is_reach)) return;
  std::vector<double> echoes(range.begin(), range.end());
  std::ranges::replace_if(echoes, is_reach, std::numeric_limits<double>::quiet_NaN());
  sensor->range_m = Array::Of<double>(sensor->range_m.shape(), echoes);
}

constexpr double kCheckedShare = 0.1;  // where none are held out

// Of `count` scans, which lie in the last part of their tenth of the log. A tenth may be too short to have
// such a part: then of each n scans the last, for the n that comes nearest to the share.
std::vector<std::uint8_t> LastOfEachTenth(std::size_t count, double share) {
  constexpr std::size_t kPeriods = 10;
  std::vector<std::uint8_t> last(count);
  if (share <= 0 || count < 2) return last;
  const auto of = static_cast<double>(count);
  for (std::size_t s = 0; s < count; ++s)
    last[s] = static_cast<double>(kPeriods * s % count) >= (1 - share - 1e-9) * of ? 1 : 0;
  if (std::ranges::find(last, 1) != last.end()) return last;
  const auto some = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(share * of)));
  for (std::size_t s = 0; s < count; ++s) last[s] = (s + 1) * some / count > s * some / count ? 1 : 0;
  return last;
}

// Rows that lie together: shared where they begin as arrays do, else copied.
Array SharedRows(const Array& from, std::int64_t first, std::int64_t count) {
  CAIRN_DEMAND(first >= 0 && first + count <= from.shape()[0], "rows out of range");
  const std::size_t row_bytes = from.bytes().size() / static_cast<std::size_t>(from.shape()[0]);
  if (static_cast<std::size_t>(first) * row_bytes % kAlignment != 0) return from.Rows(first, count);
  Shape shape = from.shape();
  shape[0] = count;
  return Array::Over(from.type(), from.item_bytes(), shape,
                     from.bytes().subspan(static_cast<std::size_t>(first) * row_bytes,
                                          static_cast<std::size_t>(count) * row_bytes),
                     std::make_shared<const Array>(from))
      .value();
}

// Rows of `from` that `keep` names, in rising order.
Array RowsOf(const Array& from, std::span<const std::int64_t> keep, std::size_t columns) {
  const auto count = static_cast<std::int64_t>(keep.size());
  if (count > 0 && keep.back() - keep.front() + 1 == count) return SharedRows(from, keep.front(), count);
  const auto values = from.As<double>();
  std::vector<double> kept;
  kept.reserve(keep.size() * columns);
  for (const std::int64_t s : keep) {
    const auto row = values.subspan(static_cast<std::size_t>(s) * columns, columns);
    kept.insert(kept.end(), row.begin(), row.end());
  }
  return Array::Of<double>({count, static_cast<std::int64_t>(columns)}, kept);
}

// Which scans the map is made without, and which it is checked with.
void HoldOut(const GridOptions& options, RangeScans* sensor) {
  sensor->held_out = LastOfEachTenth(sensor->scans(), options.heldout);
  sensor->checked = options.heldout > 0 ? sensor->held_out : LastOfEachTenth(sensor->scans(), kCheckedShare);
}

// Fills in the poses; scans without any are dropped or refused. Returns how many were dropped.
std::size_t PlaceScans(const PoseTrack& track, bool skip, RangeScans* sensor) {
  std::vector<double> times, turret;
  for (std::size_t s = 0; s < sensor->scans(); ++s) {
    const double time_s = sensor->time_s[s];
    const auto pose = track.At(time_s);
    if (!pose && !skip) {
      Refuse(sensor->name, s, time_s,
             "there is no pose for this time (skip_unposed=true leaves such scans out)");
    }
    if (!pose) continue;
    sensor->row.push_back(static_cast<std::int64_t>(s));
    times.push_back(time_s);
    if (!sensor->turret_rad.empty()) turret.push_back(sensor->turret_rad[s]);
    sensor->pose.push_back(*pose);
  }
  const std::size_t dropped = sensor->scans() - times.size();
  if (dropped > 0 && !sensor->range_m.is_form_alone())
    sensor->range_m = RowsOf(sensor->range_m, sensor->row, sensor->beams.size());
  sensor->time_s = std::move(times);
  sensor->turret_rad = std::move(turret);
  return dropped;
}

RangeScans SensorOf(const kinds::Log::RangeSensor& of, const std::string& name) {
  RangeScans sensor;
  sensor.name = name;
  for (std::size_t b = 0; b < of.beam_x_m.size(); ++b)
    sensor.beams.push_back({of.beam_x_m[b], of.beam_y_m[b], of.beam_heading_rad[b]});
  sensor.opening_rad = of.opening_rad.Scalar();
  sensor.max_range_m = of.max_range_m.Scalar();
  if (!(sensor.opening_rad < std::numbers::pi)) throw InputError(name + ": an opening is from 0 to below pi");
  sensor.time_s = of.time_s.vector();
  if (of.turret_rad) sensor.turret_rad = of.turret_rad.vector();
  sensor.range_m = of.range_m.array();
  if (sensor.range_m.is_form_alone()) return sensor;
  CheckRanges(sensor);
  TakeOutReach(&sensor);
  return sensor;
}

void CheckHandedOver(const RangeScans& sensor, const Blob& scans) {
  RequireSize("pose", sensor.pose.size(), sensor.scans());
  RequirePoses("a scan's pose", sensor.pose);
  RequireSize("held_out", sensor.held_out.size(), sensor.scans());
  RequireSize("checked", sensor.checked.size(), sensor.scans());
  RequireSize("row", sensor.row.size(), sensor.scans());
  if (!scans.Has("turret_rad")) return;
  RequireSize("turret_rad", sensor.turret_rad.size(), sensor.scans());
  RequireAllWithin("turret_rad", sensor.turret_rad, -1e9, 1e9);
}

void CheckRows(const RangeScans& sensor, const Array& range_m, std::int64_t first_row) {
  RequireSize("the shape of range_m", range_m.shape().size(), 2);
  RequireSize("a row of range_m", static_cast<std::size_t>(range_m.shape()[1]), sensor.beams.size());
  RequireWithin("the first row", first_row, 0, std::int64_t{1} << 60);
  RequireAllWithin("row", sensor.row, first_row, first_row + range_m.shape()[0] - 1);
}

// Scans that are laid over each other all the same look like a map.
void CheckOneFrame(const PosedScans& scans) {
  if (scans.robots.size() < 2 || scans.own_frames.empty()) return;
  throw InputError(
      "the scans are of " + std::to_string(scans.robots.size()) +
      " robots, and nothing says how their paths lie beside each other: " + NameList(scans.own_frames) +
      (scans.own_frames.size() == 1 ? " has a frame of its own" : " have a frame each") +
      ", for the poses are dead reckoning's or a local_map's. Make a map of one robot (robots=NAME), "
      "or give poses of one frame: a landmark_map, or a file of poses, as the input 'poses'");
}

// All that the sensor's beams met.
void AddEnds(const RangeScans& sensor, Extent* extent) {
  std::vector<Pose> unit;  // each beam's direction, on the robot
  for (const Pose& beam : sensor.beams)
    unit.push_back({std::cos(beam.heading_rad), std::sin(beam.heading_rad), 0});
  const auto range = sensor.range_m.As<double>();
  for (std::size_t s = 0; s < sensor.scans(); ++s) {
    if (sensor.held_out[s]) continue;
    const Pose pose = sensor.MountPose(s);
    const double c = std::cos(pose.heading_rad), si = std::sin(pose.heading_rad);
    for (std::size_t b = 0; b < unit.size(); ++b) {
      const double range_m = range[s * unit.size() + b];
      if (std::isnan(range_m)) continue;
      const double x = sensor.beams[b].x_m + range_m * unit[b].x_m;
      const double y = sensor.beams[b].y_m + range_m * unit[b].y_m;
      extent->Add(pose.x_m + c * x - si * y, pose.y_m + si * x + c * y);
    }
  }
}

// A result tells where the robot of its own log was; the times of another log's scans mean nothing to it. A
// table of poses does not say of which log it is.
void CheckPosesAreOf(const Hash& source, const Blob& poses) {
  const std::string made_from = poses.Text("log_hash"), given = source.Hex();
  if (made_from == given) return;
  throw InputError(
      "the input 'poses' was made from another log: the content of that one, truth and provenance aside, "
      "is " +
      made_from + ", that of the log given here is " + given +
      ". Where its poses are this log's all the same (it was imported anew, say), `cairn export "
      "tum` and `cairn import tum` make a table of them, which is taken");
}

// Those of a robot's sensors that stand in `groups`.
void AddScansOf(const Blob& log, const Blob* poses, std::size_t robot, const std::vector<std::string>& groups,
                const GridOptions& options, PosedScans* scans) {
  const std::size_t before = scans->sensors.size();
  bool has_own_frame = false;
  for (const std::string& group : kGroups) {
    const std::string name = "robot/" + std::to_string(robot) + "/" + group + "/";
    if (std::ranges::find(groups, group) == groups.end() || !log.Has(name + "range_m")) continue;
    RangeScans sensor = SensorOf(FieldsIn<kinds::Log::RangeSensor>(name, log), name);
    const PoseTrack track = PoseTrack::Of(log, poses, robot, options.pose_gap_s);
    has_own_frame = track.has_own_frame();
    scans->unposed += PlaceScans(track, options.skip_unposed, &sensor);
    HoldOut(options, &sensor);
    if (sensor.scans() > 0) scans->sensors.push_back(std::move(sensor));
  }
  if (scans->sensors.size() == before) return;
  scans->robots.push_back(log.Texts("robots")[robot]);
  if (has_own_frame) scans->own_frames.push_back(scans->robots.back());
}

}  // namespace

PosedScans ReadRangeScans(const Blob& log, const Blob* poses, const GridOptions& options) {
  const bool says = poses != nullptr && poses->Has("log_hash");
  return ReadScanHeads(log, says ? log.SourceHash() : Hash{}, poses, options);
}

PosedScans ReadScanHeads(const Blob& log, const Hash& source, const Blob* poses, const GridOptions& options) {
  if (poses != nullptr && poses->Has("log_hash")) CheckPosesAreOf(source, *poses);
  const std::vector<std::string> groups = Chosen(options);
  const std::vector<std::uint8_t> robots = ChosenRobots(options, log.Texts("robots"));
  PosedScans scans;
  for (std::size_t r = 0; r < robots.size(); ++r)
    if (robots[r] != 0) AddScansOf(log, poses, r, groups, options, &scans);
  if (scans.sensors.empty()) {
    throw InputError(scans.unposed > 0
                         ? "none of the log's range scans has a pose"
                         : "the log has no range scans" +
                               (options.sensors.empty() ? "" : " of '" + options.sensors + "'") +
                               (options.robots.empty() ? "" : " by robot '" + options.robots + "'") +
                               ": an occupancy map is made of sonar or laser");
  }
  return scans;
}

double MostCells(const GridOptions& options, double bytes_per_cell) {
  return static_cast<double>(options.memory_mb) * 1048576 / bytes_per_cell;
}

Extent FrameOf(const PosedScans& scans, const GridOptions& options) {
  CheckOneFrame(scans);
  Extent frame;
  if (!options.box_m.empty()) frame = ParseExtent("box_m", options.box_m);
  for (const RangeScans& sensor : scans.sensors) {
    for (std::size_t s = 0; s < sensor.scans(); ++s) {
      const Pose& pose = sensor.pose[s];
      if (options.box_m.empty()) {
        frame.Add(pose.x_m, pose.y_m);
      } else if (!frame.Holds(pose.x_m, pose.y_m)) {
        Refuse(sensor.name, s, sensor.time_s[s],
               "the robot is at (" + std::to_string(pose.x_m) + ", " + std::to_string(pose.y_m) +
                   ") m, outside of box_m: the box is too small for the trajectory");
      }
    }
  }
  return frame;
}

Extent EndsOf(const RangeScans& scans) {
  Extent ends;
  AddEnds(scans, &ends);
  return ends;
}

GridBox GridOf(Extent frame, const Extent& ends, const GridOptions& options, double bytes_per_cell) {
  if (options.box_m.empty()) {
    frame.Add(ends);
    frame.Grow(kMarginM);
  }
  return frame.ToGrid(options.cell_m, MostCells(options, bytes_per_cell));
}

GridBox GridOf(const PosedScans& scans, const GridOptions& options, double bytes_per_cell) {
  const Extent frame = FrameOf(scans, options);
  Extent ends;
  for (const RangeScans& sensor : scans.sensors)
    if (options.box_m.empty()) AddEnds(sensor, &ends);
  return GridOf(frame, ends, options, bytes_per_cell);
}

void PutScanPoses(const PosedScans& scans, const Blob& log, const Hash& source, Blob* result) {
  result->Put("robots", log.at("robots"));
  result->Put("log_hash", Array::Text(source.Hex()));
  for (const RangeScans& sensor : scans.sensors) {
    kinds::GridMap::Sensor of;
    of.Set(sensor.time_s, sensor.pose);
    of.heading_rad = ColumnOf(sensor.pose, [](const Pose& pose) { return WrapAngle(pose.heading_rad); });
    of.held_out = sensor.held_out;
    PutFields(sensor.name, of, result);
  }
}

Blob SensorBlob(const RangeScans& sensor) {
  Blob blob;
  blob.Put("name", Array::Text(sensor.name));
  PutRows("beam/", sensor.beams, &blob);
  blob.PutScalar("opening_rad", sensor.opening_rad);
  blob.PutScalar("max_range_m", sensor.max_range_m);
  return blob;
}

Blob ScansBlob(const RangeScans& sensor) {
  Blob blob;
  blob.PutVector("time_s", sensor.time_s);
  PutRows("pose/", sensor.pose, &blob);
  if (!sensor.turret_rad.empty()) blob.PutVector("turret_rad", sensor.turret_rad);
  blob.PutVector("held_out", sensor.held_out);
  blob.PutVector("checked", sensor.checked);
  blob.PutVector("row", sensor.row);
  return blob;
}

RangeScans SensorIn(const Blob& sensor) {
  RangeScans result;
  result.name = sensor.Text("name");
  result.beams = RowsIn<Pose>(sensor, "beam/");
  result.opening_rad = sensor.Scalar<double>("opening_rad");
  result.max_range_m = sensor.Scalar<double>("max_range_m");
  RequireWithin("the number of beams", static_cast<std::int64_t>(result.beams.size()), 1,
                std::numeric_limits<std::int32_t>::max());
  RequirePoses("a beam's pose", result.beams);
  RequireWithin("opening_rad", result.opening_rad, 0.0, std::nextafter(std::numbers::pi, 0.0));
  RequireWithin("max_range_m", result.max_range_m, 0.0, kFar_m);
  return result;
}

RangeScans ScansOf(const Blob& sensor, const Blob& scans, const Blob& log, std::int64_t first_row) {
  RangeScans result = SensorIn(sensor);
  result.pose = RowsIn<Pose>(scans, "pose/");
  result.time_s = Column<double>::In(scans, "time_s").vector();
  result.held_out = Column<std::uint8_t>::In(scans, "held_out").vector();
  result.checked = Column<std::uint8_t>::In(scans, "checked").vector();
  if (const auto turret = Column<double>::In(scans, "turret_rad")) result.turret_rad = turret.vector();
  result.row = Column<std::int64_t>::In(scans, "row").vector();
  CheckHandedOver(result, scans);
  const Array& range_m = log.at(result.name + kRanges);
  CheckRows(result, range_m, first_row);
  std::vector<std::int64_t> rows = result.row;
  for (std::int64_t& row : rows) row -= first_row;
  result.range_m = RowsOf(range_m, rows, result.beams.size());
  CheckRanges(result);
  TakeOutReach(&result);
  return result;
}

}  // namespace cairn
