// Where a robot was at any time, of a track: rows of time and pose, in runs.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/common/text_file.h"

namespace cairn::datasets {

struct TrackedPose {
  double x_m = 0, y_m = 0, heading_rad = 0;
};

class PoseTracks {
 public:
  // `time_s,x_m,y_m[,heading_rad][,run]`, plain or gzipped, other columns left alone; without `run` one track
  // serves all runs. Each row becomes the mean of those within `smooth_s` / 2 of it (0: of itself). Bad
  // lines: a number that is none, a time that does not run forward within its run.
  // Throws InputError "FILE: REASON" for a track of less than two rows.
  PoseTracks(const std::string& path, double smooth_s, BadLines* bad);

  bool has_heading() const { return has_heading_; }
  const std::vector<std::string>& unit_doubts() const { return unit_doubts_; }  // what no robot does
  // Between the rows before and after `time_s`, linearly; nothing before the first, after the last, or where
  // they are more than `most_gap_s` apart.
  std::optional<TrackedPose> At(const std::string& run, double time_s, double most_gap_s) const;

 private:
  struct Track {
    std::vector<double> time_s, x_m, y_m, heading_rad, cos, sin;  // the heading: as it was read
    void Smooth(double smooth_s);
  };
  std::map<std::string, Track> tracks_;  // by run; "" where one serves all
  std::vector<std::string> unit_doubts_;
  bool has_heading_ = false, has_runs_ = false;
};

}  // namespace cairn::datasets
