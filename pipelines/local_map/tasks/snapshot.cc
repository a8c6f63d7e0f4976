#include "pipelines/local_map/tasks/snapshot.h"

#include <limits>
#include <numbers>
#include <string>

namespace cairn::local_map {
namespace {

template <class T>
Array Joined(const std::vector<Blob>& parts, const std::string& name) {
  std::vector<T> all;
  Shape shape{0};
  for (const Blob& part : parts) {
    const Array& array = part.at(name);
    const auto values = array.As<T>();
    all.insert(all.end(), values.begin(), values.end());
    const std::int64_t rows = shape[0] + array.shape()[0];
    shape = array.shape();
    shape[0] = rows;
  }
  return Array::Of<T>(shape, all);
}

}  // namespace

void Snapshots::Add(const LocalGrids& grids, double time_s) {
  const CellIndex centre = grids.occupancy().centre();
  const int half = grids.occupancy().half();
  edge_cells_ = 2 * half + 1;
  time_s_.push_back(time_s);
  for (std::int32_t j = centre.j - half; j <= centre.j + half; ++j) {
    for (std::int32_t i = centre.i - half; i <= centre.i + half; ++i) {
      occupancy_.push_back(static_cast<float>(grids.occupancy().Frequency(i, j)));
      const auto edge = grids.edges().Dominant(i, j);
      const double angle = !edge                 ? std::numeric_limits<double>::quiet_NaN()
                           : edge->angle_rad < 0 ? edge->angle_rad + std::numbers::pi
                                                 : edge->angle_rad;
      edge_rad_.push_back(static_cast<float>(angle));
    }
  }
  for (const float bin : grids.wall_histogram().bin) histogram_.push_back(static_cast<double>(bin));
  edges_.push_back(static_cast<std::int64_t>(grids.current_edges().size()));
  for (const Edge& edge : grids.current_edges()) {
    x0_m_.push_back(edge.a.x_m - grids.pose().x_m);
    y0_m_.push_back(edge.a.y_m - grids.pose().y_m);
    x1_m_.push_back(edge.b.x_m - grids.pose().x_m);
    y1_m_.push_back(edge.b.y_m - grids.pose().y_m);
  }
}

void Snapshots::Put(Blob* blob) const {
  const auto count = static_cast<std::int64_t>(time_s_.size());
  blob->PutVector("time_s", time_s_);
  blob->Put("occupancy", Array::Of<float>({count, edge_cells_, edge_cells_}, occupancy_));
  blob->Put("edge_rad", Array::Of<float>({count, edge_cells_, edge_cells_}, edge_rad_));
  blob->Put("histogram", Array::Of<double>({count, kAngleBins}, histogram_));
  blob->PutVector("edges", edges_);
  blob->PutVector("edge/x0_m", x0_m_);
  blob->PutVector("edge/y0_m", y0_m_);
  blob->PutVector("edge/x1_m", x1_m_);
  blob->PutVector("edge/y1_m", y1_m_);
}

Blob JoinSnapshots(const std::vector<Blob>& parts, const std::vector<std::int32_t>& robots,
                   const std::vector<double>& frames_rad) {
  Blob all;
  all.PutVector("robot", robots);
  all.PutVector("frame_rad", frames_rad);
  for (const char* name : {"time_s", "histogram", "edge/x0_m", "edge/y0_m", "edge/x1_m", "edge/y1_m"})
    all.Put(name, Joined<double>(parts, name));
  for (const char* name : {"occupancy", "edge_rad"}) all.Put(name, Joined<float>(parts, name));
  all.Put("edges", Joined<std::int64_t>(parts, "edges"));
  return all;
}

}  // namespace cairn::local_map
