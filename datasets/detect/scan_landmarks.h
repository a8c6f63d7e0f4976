// `cairn landmarks`: a log of scans as a log of landmarks too, which its lasers saw.
#pragma once

#include <optional>

#include "datasets/import/log_rows.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct ScanLandmarkOptions {
  struct Widths {
    double least_m = 0, most_m = 0;
  };
  std::optional<Widths> poles, reflectors;  // what to look for
  bool replace = false;                     // the observations that the log has
  // What is seen elsewhere in the next scans moves, or is none.
  int least_scans = 3;
  double least_s = 1;
  // From where the robot stands it sees the same again: the next observation of a landmark is one that is so
  // far on, or turned by as much as it takes to see it by other beams.
  double every_m = 0.1;
};

// Puts observations without identity (schema/FORMAT.md) of all lasers' posts and reflectors into the log, by
// scan, and standard deviations of ranges and bearings, where it states none: those of what was taken, by the
// noise of the ranges as round posts show it, but no less than sightings differ from one to the next. True
// associations are left out: there are none of these. Throws InputError: the log has no scans of a laser
// within its odometry's time, or has observations already; a laser without intensities where reflectors are
// wanted; beams that are no fan.
ImportReport FindLandmarksInScans(const ScanLandmarkOptions& options, Blob* log);

}  // namespace cairn::datasets
