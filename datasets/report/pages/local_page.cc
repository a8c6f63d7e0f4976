#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "datasets/common/trace_edges.h"
#include "datasets/evaluate/maps/truth.h"
#include "datasets/evaluate/relations.h"
#include "datasets/report/drawing/format.h"
#include "datasets/report/pages/facts.h"
#include "datasets/report/pages/local_pictures.h"
#include "datasets/report/pages/pages.h"
#include "datasets/report/pages/parts.h"
#include "datasets/report/pictures.h"
#include "schema/kinds/local_map.h"
#include "schema/kinds/log.h"

namespace cairn::datasets::report {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

std::string Lead(const Blob& result, const LocalResult& local) {
  std::size_t loops = 0, used = 0;
  for (const LocalConnection& link : local.connections) {
    loops += link.loop ? 1 : 0;
    used += link.loop && link.used ? 1 : 0;
  }
  return "<p class=\"lead\">" +
         Escape(Count(static_cast<std::int64_t>(result.Texts("robots").size()), "robot") + ", " +
                Count(static_cast<std::int64_t>(local.traces.size()), "edge trace") + " in cells of " +
                Short(local.cell_m, 3) + " m; " + Count(static_cast<std::int64_t>(loops), "loop") +
                " found by matching, " + std::to_string(used) + " of them followed by the path.") +
         "</p>\n";
}

std::string Tiles(const Blob& result, const LocalEvaluation* score) {
  std::string tiles;
  if (score != nullptr) {
    const double path_m = score->path.mean_m, odometry_m = score->odometry.mean_m;
    tiles +=
        TileHtml(Grouped(path_m, 3) + " m", "mean error of the path", path_m < odometry_m ? "good" : "bad");
    tiles += TileHtml(Grouped(odometry_m, 3) + " m", "mean error of odometry alone");
    if (score->traces) tiles += TileHtml(Grouped(score->traces->mean_m, 3) + " m", "in the traces' frames");
    if (score->walls) {
      tiles +=
          TileHtml(Grouped(score->walls->error_deg, 2) + " degrees", "mean error of the walls' direction");
      tiles += TileHtml(Grouped(100 * score->walls->within_2_deg, 1) + "%", "of the time under 2 degrees");
    }
    tiles += TileHtml(std::to_string(score->loops.wrong) + " of " + std::to_string(score->loops.found),
                      "loops wrong by more than half a metre", score->loops.wrong == 0 ? "good" : "bad");
  }
  return TilesHtml(tiles + WallTimeTile(result));
}

// Without the jumps of angles that are known modulo a quarter turn.
void AddUnwrapped(double time_s, double angle_rad, std::vector<ChartPoint>* points) {
  double degrees = angle_rad / kDegree;
  if (!points->empty()) degrees = points->back().y + std::remainder(degrees - points->back().y, 90);
  points->push_back({time_s, degrees});
}

// Of one robot: as it was found, and as truth has it.
std::string WallsHtml(const Blob& result, const Blob* log, std::size_t robot) {
  const std::string prefix = "robot/" + std::to_string(robot) + "/";
  const auto walls = FieldsIn<kinds::LocalMap::Walls>(prefix + "walls/", result);
  if (!walls.time_s) return "";
  const std::span<const double> time = walls.time_s, angle = walls.angle_rad;
  Curve found{.name = "found", .points = {}, .colour = 0}, truth{.name = "true", .points = {}, .colour = 1};
  for (std::size_t i = 0; i < time.size(); ++i)
    if (std::isfinite(angle[i])) AddUnwrapped(time[i], angle[i], &found.points);
  const auto of_truth = FieldsIn<kinds::Log::TrueRobot>("truth/" + prefix, log != nullptr ? *log : Blob());
  if (of_truth.walls_time_s) {
    const std::span<const double> true_s = of_truth.walls_time_s, true_rad = of_truth.walls_angle_rad;
    const Track poses = TrackOf(of_truth.poses), odometry = OdometryOf(*log).at(robot);
    for (std::size_t i = 0; i < true_s.size(); ++i) {
      const auto at = PoseAt(poses, true_s[i]), reckoned = PoseAt(odometry, true_s[i], HUGE_VAL);
      if (!at || !reckoned) continue;
      const double angle_rad = true_rad[i] + reckoned->heading_rad - at->heading_rad;
      if (truth.points.empty() && !found.points.empty()) truth.points.push_back(found.points.front());
      AddUnwrapped(true_s[i], angle_rad, &truth.points);
    }
    if (!truth.points.empty()) truth.points.erase(truth.points.begin());
  }
  constexpr std::size_t kMost = 800;
  const double first_s = time.empty() ? 0 : time.front();
  std::vector<Curve> curves{found};
  if (!truth.points.empty()) curves.push_back(truth);
  for (Curve& curve : curves) {
    for (ChartPoint& point : curve.points) point.x -= first_s;
    curve.points = Thinned(curve.points, kMost);
  }
  const LineChart chart{"Direction of the walls in the frame of dead reckoning: " +
                            RobotTitle(result.Texts("robots").at(robot)),
                        "time since the first scan [s]", "direction [degrees]", curves};
  return ChartHtml(
      chart,
      "Followed from scan to scan: walls are known modulo 90 degrees. Odometry that drifts turns them.");
}

std::string MapSection(const Scene& scene, const LocalEvaluation* evaluation) {
  std::string caption = "The path is put together from the traces";
  if (!scene.odometry_below.empty())
    caption += "; odometry alone goes on from the path's first pose, and may leave the picture";
  if (evaluation != nullptr) caption += "; truth was laid over the path by one rigid motion";
  caption += ". Where a run was cut, no line is drawn.";
  if (scene.paths.size() > 1)
    caption += " Each robot's path is in a frame of its own: how they lie to each other is not known.";
  return SectionHtml("Path",
                     LegendHtml(LegendOf(scene)) +
                         DrawingHtml([&](double width) { return MapPicture(scene, width); }, caption));
}

std::string GridSection(const LocalResult& local) {
  const LocalSnapshot* shot = RichestOf(local);
  if (shot == nullptr) return "";
  return SectionHtml(
      "Local grid",
      PictureHtml(
          LocalGridPicture(*shot),
          "At " + Short(shot->time_s, 1) +
              " s. Grey: how often a cell is hit. Blue: dominant orientation of its edges. Red: the edges "
              "of the last scan. Below: the histogram of wall orientations in degrees modulo 90; the dot "
              "is its peak."));
}

std::string TraceSection(const LocalResult& local) {
  const LocalTrace* trace = LongestOf(local);
  if (trace == nullptr) return "";
  return SectionHtml(
      "Longest trace",
      PictureHtml(TracePicture(*trace),
                  "The line is the robot's way. On both sides the interval of distances of edges, "
                  "bold where they are occupied; red: both ends of large intervals of orientation."));
}

std::string MatchSection(const LocalResult& local, const Blob* log) {
  if (log == nullptr) return "";
  const std::vector<Superposed> shown = Superpositions(local, OdometryOf(*log));
  if (shown.empty()) return "";
  return SectionHtml(
      "Immediate on recorded traces",
      PictureHtml(SuperposedPicture(shown),
                  "Grey: a trace that was recorded before. Black: what the local grids show now, "
                  "edges as lines, and where there are none occupied cells as dots; the cross is "
                  "where matching put the robot, the frame the limit of the grids."));
}

}  // namespace

std::vector<Track> OdometryOf(const Blob& log) {
  std::vector<Track> tracks;
  for (const kinds::Log::Robot& robot : Read<kinds::Log>(log).robot)
    tracks.push_back(DeadReckoned(robot.odometry));
  return tracks;
}

namespace {

// Odometry alone, from the first pose of each path.
std::vector<Path> OdometryFrom(const LocalResult& local, const std::vector<std::string>& robots,
                               const Blob& log) {
  const std::vector<Track> odometry = OdometryOf(log);
  if (odometry.size() != local.paths.size())
    throw InputError("the result's robots are not the log's: was it made from this log?");
  std::vector<Path> paths;
  for (std::size_t r = 0; r < odometry.size(); ++r) {
    const Track& track = local.paths[r];
    if (track.time_s.empty()) continue;
    const Pose from = PoseAt(odometry[r], track.time_s.front(), HUGE_VAL).value_or(Pose{}),
               to = track.poses.front();
    Similarity move;
    move.angle_rad = to.heading_rad - from.heading_rad;
    const Point turned = move(Point{from.x_m, from.y_m});
    move.x_m = to.x_m - turned.x_m;
    move.y_m = to.y_m - turned.y_m;
    Path path{.robot = robots[r], .index = r, .points = {}};
    for (const Pose& pose : odometry[r].poses) path.points.push_back(move(Point{pose.x_m, pose.y_m}));
    paths.push_back(std::move(path));
  }
  return paths;
}

// Where a run was cut: the pose after each of the stored times begins anew.
std::vector<std::size_t> CutsOf(const Blob& result, std::size_t robot, const Track& track) {
  const auto cuts = Column<double>::In(result, "robot/" + std::to_string(robot) + "/cuts/time_s");
  std::vector<std::size_t> breaks;
  for (const double time_s : cuts.OrNone()) {
    const auto next =
        static_cast<std::size_t>(std::ranges::upper_bound(track.time_s, time_s) - track.time_s.begin());
    if (next > 0 && next < track.time_s.size() && (breaks.empty() || next > breaks.back()))
      breaks.push_back(next);
  }
  return breaks;
}

Scene SceneOf(const Blob& result, const LocalResult& local, const Blob* log,
              const LocalEvaluation* evaluation) {
  Scene scene;
  const std::vector<std::string> robots = result.Texts("robots");
  for (std::size_t r = 0; r < local.paths.size(); ++r) {
    Path path{.robot = robots.at(r), .index = r, .points = {}, .time_s = local.paths[r].time_s};
    for (const Pose& pose : local.paths[r].poses) path.points.push_back({pose.x_m, pose.y_m});
    path.breaks = CutsOf(result, r, local.paths[r]);
    scene.paths.push_back(std::move(path));
  }
  for (const std::vector<Point>& edges : TraceEdges(result))
    scene.edges.insert(scene.edges.end(), edges.begin(), edges.end());
  for (const LocalConnection& link : local.connections) {
    if (!link.loop) continue;
    scene.loops.push_back({local.traces[link.from].ToWorld(link.from_z_m, link.from_u_m),
                           local.traces[link.to].ToWorld(link.to_z_m, link.to_u_m), link.used});
  }
  if (log == nullptr) return scene;
  scene.odometry_below = OdometryFrom(local, robots, *log);
  if (evaluation == nullptr) return scene;
  // Of one robot: paths of several lie over each other, each in a frame of its own, and no place of the walls
  // is right.
  if (log->Has("truth/walls/x_m") && local.paths.size() == 1) {
    for (const Wall& wall : ReadSegments(*log, "truth/walls/", Inverse(evaluation->alignment.front())))
      scene.truth_walls.emplace_back(wall.a, wall.b);
  }
  for (std::size_t r = 0; r < local.paths.size(); ++r) {
    const Similarity to_result = Inverse(evaluation->alignment.at(r));
    const Track truth = ReadTrack(*log, "truth/robot/" + std::to_string(r) + "/poses/");
    Path path{.robot = robots[r],
              .index = r,
              .points = {},
              .time_s = truth.time_s,
              .breaks = BreaksOf(truth.time_s)};
    for (const Pose& pose : truth.poses) path.points.push_back(to_result(Point{pose.x_m, pose.y_m}));
    if (!path.points.empty()) scene.truth_paths.push_back(std::move(path));
  }
  return scene;
}

}  // namespace

Scene LocalSceneOf(const Blob& result, const Blob* log, const LocalEvaluation* evaluation) {
  return SceneOf(result, ReadLocalResult(result), log, evaluation);
}

const LocalSnapshot* RichestOf(const LocalResult& result) {
  const auto rank = [](const LocalSnapshot& shot) {
    return std::tuple(shot.edges.size(),
                      std::ranges::count_if(shot.edge_rad, [](float e) { return e == e; }));
  };
  const auto best = std::ranges::max_element(result.snapshots, {}, rank);
  return best == result.snapshots.end() ? nullptr : &*best;
}

const LocalTrace* LongestOf(const LocalResult& result) {
  const auto best =
      std::ranges::max_element(result.traces, {}, [](const LocalTrace& t) { return t.features.size(); });
  return best == result.traces.end() ? nullptr : &*best;
}

std::string LocalHtml(const Blob& result, const Blob* log, const LocalEvaluation* evaluation) {
  const LocalResult local = ReadLocalResult(result);
  const Scene scene = SceneOf(result, local, log, evaluation);
  std::string html = Lead(result, local) + Tiles(result, evaluation) + MapSection(scene, evaluation);
  std::string walls;
  for (std::size_t r = 0; r < local.paths.size(); ++r) walls += WallsHtml(result, log, r);
  html += SectionHtml("Direction of the walls", walls);
  html += GridSection(local) + TraceSection(local) + MatchSection(local, log);
  return html + SectionHtml("Time", TimeHtml(RoundTimes(result)));
}

}  // namespace cairn::datasets::report
