// The local grids at one moment, kept for pictures.
#pragma once

#include <vector>

#include "pipelines/local_map/grids/local_grids.h"
#include "schema/blob.h"

namespace cairn::local_map {

class Snapshots {
 public:
  void Add(const LocalGrids& grids, double time_s);
  // FORMAT.md's snapshots/, but for robot and frame.
  void Put(Blob* blob) const;

 private:
  std::int64_t edge_cells_ = 0;
  std::vector<double> time_s_, histogram_, x0_m_, y0_m_, x1_m_, y1_m_;
  std::vector<float> occupancy_, edge_rad_;
  std::vector<std::int64_t> edges_;
};

// Those of tasks, one after the other. `parts` as Put made them; robot and frame_rad are put beside.
Blob JoinSnapshots(const std::vector<Blob>& parts, const std::vector<std::int32_t>& robots,
                   const std::vector<double>& frames_rad);

}  // namespace cairn::local_map
