// What the local grids know of walls, on logs with truth:
//   local_walls OFFICE.h5...       # as `cairn simulate office` makes them
// A line a log, and all together: in what share of the time after the first lock the walls' orientation is
// off by less than 2 degrees (where no direction is dominant, the last one counts); what share of the length
// of metallic walls, and of other walls and furniture, in the grids, in sight of the robot and beside or
// behind it, is covered by edges and by occupied cells, and of the metallic walls that no occupied cell
// covers by edges (holes); what share of the cells with an edge, and of the occupied ones, is nowhere near a
// wall. Covered: such a cell's point lies within 0.2 m, and an edge's direction within 15 degrees of the
// wall's.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "pipelines/common/odometry.h"
#include "pipelines/local_map/grids/local_grids.h"
#include "schema/store/blob_file.h"
#include "tests/bench/bench_main.h"

namespace cairn::local_map {
namespace {

struct TrueWall {
  Point a, b;
  bool metal;
  double from_s, until_s;
};

// A share that is counted up.
struct Share {
  double part = 0, all = 0;
  void Add(bool counts) {
    part += counts ? 1 : 0;
    ++all;
  }
  double Percent() const { return all > 0 ? 100 * part / all : 0; }
};

struct Found {
  Share oriented, metal_edges, metal_occupied, metal_holes, other_edges, other_occupied, false_edges,
      false_occupied;
};

std::vector<TrueWall> WallsOf(const Blob& log) {
  const auto x = log.Get<double>("truth/walls/x_m"), y = log.Get<double>("truth/walls/y_m");
  const auto smooth = log.Get<std::uint8_t>("truth/walls/smooth");
  const auto from = log.Get<double>("truth/walls/from_s"), until = log.Get<double>("truth/walls/until_s");
  std::vector<TrueWall> walls;
  for (std::size_t w = 0; w < smooth.size(); ++w)
    walls.push_back({{x[2 * w], y[2 * w]}, {x[2 * w + 1], y[2 * w + 1]}, smooth[w] != 0, from[w], until[w]});
  return walls;
}

double Side(Point a, Point b, Point p) {
  return (b.x_m - a.x_m) * (p.y_m - a.y_m) - (b.y_m - a.y_m) * (p.x_m - a.x_m);
}

bool Hides(const TrueWall& wall, Point from, Point to) {
  return Side(wall.a, wall.b, from) * Side(wall.a, wall.b, to) < 0 &&
         Side(from, to, wall.a) * Side(from, to, wall.b) < 0;
}

double ToWallM(const TrueWall& wall, Point p) {
  const double x = wall.b.x_m - wall.a.x_m, y = wall.b.y_m - wall.a.y_m;
  const double along = ((p.x_m - wall.a.x_m) * x + (p.y_m - wall.a.y_m) * y) / std::max(x * x + y * y, 1e-12);
  const double at = std::clamp(along, 0.0, 1.0);
  return FastDistanceM(p, {wall.a.x_m + at * x, wall.a.y_m + at * y});
}

// The walls as they lie in the grids' frame at one moment, and what the grids have there.
class Moment {
 public:
  Moment(const LocalGrids& grids, const std::vector<TrueWall>& walls, const Pose& truth, double time_s)
      : pose_(grids.pose()),
        robot_{grids.pose().x_m, grids.pose().y_m},
        reach_m_(grids.occupancy().half() * grids.occupancy().cell_m()) {
    for (TrueWall wall : walls) {
      if (time_s < wall.from_s || time_s > wall.until_s) continue;
      for (Point* p : {&wall.a, &wall.b}) {
        const Pose at = Compose(grids.pose(), Between(truth, {p->x_m, p->y_m, 0}));
        *p = {at.x_m, at.y_m};
      }
      walls_.push_back(wall);
    }
    const CellIndex c = grids.occupancy().centre();
    const int half = grids.occupancy().half();
    for (std::int32_t j = c.j - half; j <= c.j + half; ++j) {
      for (std::int32_t i = c.i - half; i <= c.i + half; ++i) {
        if (const auto edge = grids.edges().Dominant(i, j)) edges_.push_back(*edge);
        if (grids.occupancy().Occupied(i, j)) occupied_.push_back(*grids.occupancy().LastHit(i, j));
      }
    }
  }

  void Judge(Found* found) const {
    for (const TrueWall& wall : walls_) JudgeWall(wall, found);
    for (const CellEdge& edge : edges_) found->false_edges.Add(!NearAnyWall(edge.at));
    for (const Point& hit : occupied_) found->false_occupied.Add(!NearAnyWall(hit));
  }

 private:
  static constexpr double kNearM = 0.2, kStepM = 0.1;

  void JudgeWall(const TrueWall& wall, Found* found) const {
    const double length = FastDistanceM(wall.a, wall.b);
    const double angle = std::atan2(wall.b.y_m - wall.a.y_m, wall.b.x_m - wall.a.x_m);
    for (double at = kStepM / 2; at < length; at += kStepM) {
      const double share = at / length;
      const Point p{wall.a.x_m + share * (wall.b.x_m - wall.a.x_m),
                    wall.a.y_m + share * (wall.b.y_m - wall.a.y_m)};
      if (std::abs(p.x_m - robot_.x_m) > reach_m_ || std::abs(p.y_m - robot_.y_m) > reach_m_ || Ahead(p) ||
          Hidden(p))
        continue;
      const bool edge = OnEdge(p, angle), occupied = OnOccupied(p);
      (wall.metal ? found->metal_edges : found->other_edges).Add(edge);
      (wall.metal ? found->metal_occupied : found->other_occupied).Add(occupied);
      if (wall.metal && !occupied) found->metal_holes.Add(edge);
    }
  }
  bool Ahead(Point p) const { return Between(pose_, {p.x_m, p.y_m, 0}).x_m > kNearM; }
  bool Hidden(Point p) const {
    const Point before{p.x_m + 0.01 * (robot_.x_m - p.x_m), p.y_m + 0.01 * (robot_.y_m - p.y_m)};
    return std::any_of(walls_.begin(), walls_.end(),
                       [&](const TrueWall& wall) { return Hides(wall, robot_, before); });
  }
  bool OnEdge(Point p, double angle_rad) const {
    return std::any_of(edges_.begin(), edges_.end(), [&](const CellEdge& edge) {
      return FastDistanceM(edge.at, p) <= kNearM &&
             std::abs(DegOf(ModuloAngle(edge.angle_rad - angle_rad, std::numbers::pi))) <= 15;
    });
  }
  bool OnOccupied(Point p) const {
    return std::any_of(occupied_.begin(), occupied_.end(),
                       [&](Point hit) { return FastDistanceM(hit, p) <= kNearM; });
  }
  bool NearAnyWall(Point p) const {
    return std::any_of(walls_.begin(), walls_.end(),
                       [&](const TrueWall& wall) { return ToWallM(wall, p) <= kNearM; });
  }

  Pose pose_;
  Point robot_;
  double reach_m_;
  std::vector<TrueWall> walls_;
  std::vector<CellEdge> edges_;
  std::vector<Point> occupied_;
};

SensorRing RingOf(const Blob& log, const std::string& sensor) {
  const auto x = log.Get<double>(sensor + "beam_x_m"), y = log.Get<double>(sensor + "beam_y_m");
  const auto heading = log.Get<double>(sensor + "beam_heading_rad");
  std::vector<Pose> beams;
  for (std::size_t b = 0; b < x.size(); ++b) beams.push_back({x[b], y[b], heading[b]});
  return {beams, log.Scalar<double>(sensor + "opening_rad"), log.Scalar<double>(sensor + "max_range_m")};
}

RingScan ScanOf(const Blob& log, const std::string& sensor, std::size_t k) {
  const auto ranges = log.Get<double>(sensor + "range_m");
  const std::size_t beams = ranges.size() / log.Get<double>(sensor + "time_s").size();
  return {log.Get<double>(sensor + "time_s")[k], log.Get<double>(sensor + "turret_rad")[k],
          ranges.subspan(k * beams, beams)};
}

// The true pose at the time of a scan, which is among the times of the poses.
Pose TrueAt(const Blob& log, double time_s) {
  const std::string prefix = "truth/robot/0/poses/";
  const auto time = log.Get<double>(prefix + "time_s");
  const auto k =
      static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), time_s - 1e-6) - time.begin());
  if (k == time.size()) throw InputError("a scan after the last true pose");
  return {log.Get<double>(prefix + "x_m")[k], log.Get<double>(prefix + "y_m")[k],
          log.Get<double>(prefix + "heading_rad")[k]};
}

Found Judge(const Blob& log) {
  const std::string sonar = "robot/0/sonar/", infrared = "robot/0/infrared/";
  const std::vector<TrueWall> walls = WallsOf(log);
  const Odometry odometry = Integrate(FieldsIn<kinds::Log::Odometry>("robot/0/odometry/", log), "robot 0");
  const auto times = log.Get<double>(sonar + "time_s"),
             angles = log.Get<double>("truth/robot/0/walls/angle_rad");
  GridOptions options;
  LocalGrids grids(options, {RingOf(log, sonar), RingOf(log, infrared)});
  Found found;
  double told_rad = 0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const OdometricPose at = PoseAt(odometry, times[k]);
    const RingScan scans[] = {ScanOf(log, sonar, k), ScanOf(log, infrared, k)};
    grids.Update({at.x_m, at.y_m, at.heading_rad}, scans);
    if (!grids.locked()) continue;
    if (grids.walls_rad()) told_rad = grids.walls_rad()->angle_rad;
    const Pose truth = TrueAt(log, times[k]);
    const double right_rad = angles[k] + at.heading_rad - truth.heading_rad;
    found.oriented.Add(std::abs(DegOf(ModuloAngle(told_rad - right_rad, WallOrientation::kPeriodRad))) < 2);
    if (k % 10 == 0) Moment(grids, walls, truth, times[k]).Judge(&found);
  }
  return found;
}

void Print(const std::string& name, const Found& f) {
  std::printf("%-12s %6.1f %10.1f %9.1f %6.1f %10.1f %9.1f %10.1f %9.1f\n", name.c_str(),
              f.oriented.Percent(), f.metal_edges.Percent(), f.metal_occupied.Percent(),
              f.metal_holes.Percent(), f.other_edges.Percent(), f.other_occupied.Percent(),
              f.false_edges.Percent(), f.false_occupied.Percent());
}

int Main(const std::vector<std::string>& args) {
  if (args.empty()) throw InputError("what is measured are OFFICE.h5...");
  std::printf("%-12s %6s %27s %20s %20s\n", "", "within", "metallic walls, %", "other walls, %",
              "false cells, %");
  std::printf("%-12s %6s %10s %9s %6s %10s %9s %10s %9s\n", "", "2 deg", "edges", "occupied", "holes",
              "edges", "occupied", "edges", "occupied");
  Found all;
  for (const std::string& path : args) {
    const auto file = ReadBlobFile(path);
    if (!file.ok()) throw InputError(file.status().message());
    const Found found = Judge(file.value().blob);
    Print(path, found);
    for (const auto share :
         {&Found::oriented, &Found::metal_edges, &Found::metal_occupied, &Found::metal_holes,
          &Found::other_edges, &Found::other_occupied, &Found::false_edges, &Found::false_occupied}) {
      (all.*share).part += (found.*share).part;
      (all.*share).all += (found.*share).all;
    }
  }
  Print("all", all);
  return 0;
}

}  // namespace
}  // namespace cairn::local_map

int main(int argc, char** argv) {
  return cairn::BenchMain("local_walls", cairn::local_map::Main, argc, argv);
}
