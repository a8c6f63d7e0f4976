#include "pipelines/local_map/tasks/scan_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "pipelines/common/handed_over.h"
#include "pipelines/local_map/path/motion_watch.h"
#include "schema/error.h"
#include "schema/kinds/fields.h"

namespace cairn::local_map {
namespace {

std::string Numbered(std::size_t k) { return std::to_string(k) + "/"; }

// Of `ring_beams` around the full circle, those that lie in the sensor's own field of view.
int SectorsOf(const std::vector<Pose>& beams, double opening_rad, std::int64_t ring_beams) {
  if (opening_rad > 0 || beams.size() < 2) return 0;
  double view_rad = 0;
  for (std::size_t b = 1; b < beams.size(); ++b)
    view_rad += std::abs(WrapAngle(beams[b].heading_rad - beams[b - 1].heading_rad));
  const auto sectors =
      static_cast<int>(std::lround(static_cast<double>(ring_beams) * view_rad / (2 * std::numbers::pi)));
  return sectors < static_cast<int>(beams.size()) ? std::max(sectors, 1) : 0;
}

// Of "robot/0/laser/".
std::string SensorOf(const std::string& name) {
  const std::size_t end = name.find_last_not_of('/') + 1;
  const std::size_t before = name.find_last_of('/', end - 1);
  const std::size_t first = before == std::string::npos ? 0 : before + 1;
  return name.substr(first, end - first);
}

std::vector<double> TurretOf(const Blob& log, const std::string& sensor) {
  const auto turret = Column<double>::In(log, sensor + "turret_rad");
  return turret ? turret.vector() : std::vector<double>();
}

}  // namespace

Blob RingsBlob(const PosedScans& scans, const std::vector<std::size_t>& sensors) {
  Blob rings;
  rings.PutScalar("count", static_cast<std::int64_t>(sensors.size()));
  for (std::size_t k = 0; k < sensors.size(); ++k)
    rings.PutAll(Numbered(k), SensorBlob(scans.sensors[sensors[k]]));
  return rings;
}

std::size_t LasersIn(const Blob& rings) {
  std::size_t lasers = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(rings.Scalar<std::int64_t>("count")); ++k)
    lasers += IsLaser({.beams = RowsIn<Pose>(rings, Numbered(k) + "beam/"),
                       .opening_rad = rings.Scalar<double>(Numbered(k) + "opening_rad")});
  return lasers;
}

ScanReader::ScanReader(const Blob& log, const Blob& rings, const Blob& rows, std::int64_t ring_beams) {
  for (std::size_t k = 0; k < static_cast<std::size_t>(rings.Scalar<std::int64_t>("count")); ++k) {
    const std::string name = rings.Text(Numbered(k) + "name");
    const auto beams = RowsIn<Pose>(rings, Numbered(k) + "beam/");
    const double opening_rad = rings.Scalar<double>(Numbered(k) + "opening_rad");
    const double max_range_m = rings.Scalar<double>(Numbered(k) + "max_range_m");
    RequirePoses("a beam's pose", beams);
    RequireWithin("opening_rad", opening_rad, 0.0, std::numbers::pi);
    RequireWithin("max_range_m", max_range_m, 0.0, kFar_m);
    rings_.emplace_back(beams, opening_rad, max_range_m, SectorsOf(beams, opening_rad, ring_beams));
    beams_.push_back({beams, opening_rad, max_range_m});
    name_.push_back(SensorOf(name));
    range_m_.push_back(log.at(name + "range_m"));
    turret_rad_.push_back(TurretOf(log, name));
    const Shape& shape = range_m_.back().shape();
    RequireSize("the shape of range_m", shape.size(), 2);
    RequireSize("a row of range_m", beams.size(), static_cast<std::size_t>(shape[1]));
    if (!turret_rad_.back().empty())
      RequireSize("turret_rad", turret_rad_.back().size(), static_cast<std::size_t>(shape[0]));
  }
  time_s_ = Column<double>::In(rows, "time_s").vector();
  pose_ = RowsIn<Pose>(rows, "pose/");
  unsure_ = Column<std::uint8_t>::In(rows, "unsure").vector();
  row_of_log_ = Column<std::int64_t>::In(rows, "row_of_log").vector();
  scan_.resize(rings_.size());
  RequireWithin("the number of scans", static_cast<std::int64_t>(size()), 1,
                std::numeric_limits<std::int32_t>::max());
  RequireAllWithin("time_s", time_s_, -1e18, 1e18);
  RequireSize("pose", pose_.size(), size());
  RequirePoses("a scan's pose", pose_);
  RequireSize("unsure", unsure_.size(), size());
  RequireSize("row_of_log", row_of_log_.size(), size() * rings_.size());
  for (std::size_t k = 0; k < row_of_log_.size(); ++k)
    RequireWithin("row_of_log", row_of_log_[k], -1, range_m_[k % rings_.size()].shape()[0] - 1);
}

std::span<const RingScan> ScanReader::Read(std::size_t scan) {
  for (std::size_t k = 0; k < rings_.size(); ++k) {
    const std::int64_t row = row_of_log_[scan * rings_.size() + k];
    scan_[k] = {.time_s = time_s_[scan], .turret_rad = 0, .range_m = {}};
    if (row < 0) continue;
    const auto row_of_log = static_cast<std::size_t>(row);
    if (!turret_rad_[k].empty()) scan_[k].turret_rad = turret_rad_[k][row_of_log];
    scan_[k].range_m = range_m_[k].As<double>().subspan(row_of_log * rings_[k].beams(), rings_[k].beams());
  }
  return scan_;
}

}  // namespace cairn::local_map
