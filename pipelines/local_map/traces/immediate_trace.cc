#include "pipelines/local_map/traces/immediate_trace.h"

#include <algorithm>
#include <cmath>

namespace cairn::local_map {
namespace {

// Edges that make at most this angle with the way give distances from it; steeper ones run across.
constexpr double kAlongRad = 0.3 * std::numbers::pi;

// Neighbouring edges of one column, weighed by how often they were found.
class Group {
 public:
  bool known() const { return weight_ > 0; }

  // Only neighbours of the nearest one: what lies behind it is another thing.
  void Add(int u, double angle_rad, double distance_m, double weight, bool occupied) {
    if (known() && u > last_ + 1) return;
    if (!known()) first_rad_ = angle_rad;
    last_ = u;
    occupied_ = occupied_ || occupied;
    weight_ += weight;
    angle_.Add(first_rad_ + ModuloAngle(angle_rad - first_rad_, std::numbers::pi), weight);
    distance_.Add(distance_m, weight);
  }

  Side ToSide() const {
    Side side;
    if (!known()) return side;
    side.angle_rad = angle_.ToInterval(weight_);
    side.distance_m = distance_.ToInterval(weight_);
    side.occupied = occupied_ ? 1 : 0;
    return side;
  }

 private:
  struct Moments {
    double sum = 0, squares = 0;
    void Add(double value, double weight) {
      sum += weight * value;
      squares += weight * value * value;
    }
    // The interval over which a uniform distribution has this mean and this variance.
    Interval ToInterval(double weight) const {
      const double mean = sum / weight, half = std::sqrt(3 * std::max(0.0, squares / weight - mean * mean));
      return {static_cast<float>(mean - half), static_cast<float>(mean + half)};
    }
  };
  double weight_ = 0, first_rad_ = 0;
  Moments angle_, distance_;
  int last_ = 0;
  bool occupied_ = false;
};

// Reads one side of a column, cell by cell outwards.
class SideReader {
 public:
  SideReader(const LocalGrids& grids, const TraceFrame& frame, int z, int sign)
      : grids_(grids), frame_(frame), z_(z), sign_(sign), cell_m_(grids.edges().cell_m()) {}

  Side Read(int last) {
    for (int u = 1; u <= last; ++u) Look(u);
    Side side = (along_.known() ? along_ : across_).ToSide();
    if (cross_weight_ > 0) side.cross_m = static_cast<float>(cross_sum_m_ / cross_weight_);
    side.cross_cells = static_cast<float>(cross_cells_);
    side.nearest_m = nearest_m_;
    return side;
  }

 private:
  void Look(int u) {
    const CellIndex cell = frame_.CellAt(z_, sign_ * u);
    const bool occupied = grids_.occupancy().Occupied(cell.i, cell.j);
    if (occupied && nearest_m_ != nearest_m_) {
      const Position hit = frame_.At(*grids_.occupancy().LastHit(cell.i, cell.j), cell_m_);
      // [DM98] section 4.1: the closest occupied cell
      nearest_m_ = static_cast<float>(sign_ * hit.u_m);
    }
    const auto edge = grids_.edges().Dominant(cell.i, cell.j);
    if (!edge) return;
    const double angle = frame_.Direction(edge->angle_rad);
    const Position at = frame_.At(edge->at, cell_m_);
    const double off_m = at.z_m - z_ * cell_m_;
    if (std::abs(angle) > kAlongRad) {
      across_.Add(u, angle, sign_ * at.u_m, edge->weight, occupied);
      cross_sum_m_ += edge->weight * off_m;
      cross_weight_ += edge->weight;
      ++cross_cells_;
    } else {  // where it passes the column's middle
      // [DM98] section 4.1: orientations and distances of edges, whether they are occupied
      along_.Add(u, angle, sign_ * (at.u_m - std::tan(angle) * off_m), edge->weight, occupied);
    }
  }

  const LocalGrids& grids_;
  const TraceFrame& frame_;
  int z_, sign_;
  double cell_m_;
  Group along_, across_;
  double cross_sum_m_ = 0, cross_weight_ = 0;
  int cross_cells_ = 0;
  float nearest_m_ = kUnseen;
};

}  // namespace

Feature ColumnOf(const LocalGrids& grids, const TraceFrame& frame, int z) {
  const CellIndex centre = grids.edges().centre();
  const double cell_m = grids.edges().cell_m();
  const Position robot = frame.At({centre.i * cell_m, centre.j * cell_m}, cell_m);
  const auto u = static_cast<int>(std::lround(robot.u_m / cell_m));
  const int half = grids.edges().half();
  return {SideReader(grids, frame, z, 1).Read(half + u), SideReader(grids, frame, z, -1).Read(half - u)};
}

void MakeImmediate(const LocalGrids& grids, int quarter, ImmediateTrace& trace) {
  const TraceFrame frame{quarter, grids.edges().centre()};
  const double cell_m = grids.edges().cell_m();
  const int half = grids.edges().half();
  trace.trace.Restart(cell_m, -half);
  trace.robot = frame.At({grids.pose().x_m, grids.pose().y_m}, cell_m);
  // [DM98] section 4.1: an immediate trace
  for (int z = -half; z <= half; ++z) *trace.trace.Touch(z) = ColumnOf(grids, frame, z);
}

ImmediateTrace ImmediateRoom(const LocalGrids& grids) {
  const int half = grids.edges().half();
  return {EdgeTrace(grids.edges().cell_m(), -half, static_cast<std::size_t>(2 * half + 1)), {}};
}

}  // namespace cairn::local_map
