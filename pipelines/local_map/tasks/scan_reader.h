// What a task reads of a log: the scans of one robot, one after the other.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "pipelines/common/range_scans.h"
#include "pipelines/local_map/grids/ring.h"
#include "pipelines/local_map/path/scale_watch.h"
#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::local_map {

// A robot's sensors without their readings, for tasks.
Blob RingsBlob(const PosedScans& scans, const std::vector<std::size_t>& sensors);

// How many of them are lasers (IsLaser).
std::size_t LasersIn(const Blob& rings);

class ScanReader {
 public:
  // `rings` as RingsBlob made it; `rows` some rows of what RowsOf(runs) made; a laser's beams are thinned to
  // `ring_beams` sectors over the full circle.
  // Throws InputError where these do not fit each other, or name rows that the log lacks.
  ScanReader(const Blob& log, const Blob& rings, const Blob& rows, std::int64_t ring_beams);

  std::size_t size() const { return time_s_.size(); }
  const std::vector<SensorRing>& rings() const { return rings_; }
  const std::vector<ScaleWatch::Ring>& beams() const { return beams_; }
  // In the log, of its robot: "laser".
  const std::string& SensorName(std::size_t ring) const { return name_[ring]; }
  double time_s(std::size_t scan) const { return time_s_[scan]; }
  Pose pose(std::size_t scan) const { return pose_[scan]; }
  bool unsure(std::size_t scan) const { return unsure_[scan] != 0; }
  // One a ring, valid until the next call; without ranges where the ring was not read.
  std::span<const RingScan> Read(std::size_t scan);

 private:
  std::vector<SensorRing> rings_;
  std::vector<ScaleWatch::Ring> beams_;
  std::vector<std::string> name_;
  std::vector<Array> range_m_;                   // of each ring, keeps them alive
  std::vector<std::vector<double>> turret_rad_;  // of each ring's scans; empty: no turret
  std::vector<double> time_s_;
  std::vector<Pose> pose_;
  std::vector<std::uint8_t> unsure_;
  std::vector<std::int64_t> row_of_log_;
  std::vector<RingScan> scan_;
};

}  // namespace cairn::local_map
