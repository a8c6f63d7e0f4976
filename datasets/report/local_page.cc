#include "datasets/report/local_page.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "datasets/evaluate/map_truth.h"
#include "datasets/evaluate/relations.h"
#include "datasets/report/facts.h"
#include "datasets/report/format.h"
#include "datasets/report/line_chart.h"
#include "datasets/report/parts.h"
#include "datasets/report/svg.h"

namespace cairn::datasets::report {
namespace {

constexpr double kWidth = 1040, kDegree = std::numbers::pi / 180;

// Big-endian, of a PNG's header.
double PngSide(const std::string& png, std::size_t at) {
  double side = 0;
  for (std::size_t i = at; i < at + 4; ++i) side = 256 * side + static_cast<unsigned char>(png.at(i));
  return side;
}

std::string ImageHtml(const std::string& png, const std::string& label, const std::string& caption) {
  const double width = PngSide(png, 16), height = PngSide(png, 20), scale = std::min(1.0, kWidth / width);
  Svg svg(width * scale, height * scale, label);
  svg.Image(0, 0, width * scale, height * scale, png);
  return FigureHtml(svg.Finish(), caption);
}

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
        TileHtml(Short(path_m, 3) + " m", "mean error of the path", path_m < odometry_m ? "good" : "bad");
    tiles += TileHtml(Short(odometry_m, 3) + " m", "mean error of odometry alone");
    if (score->traces) tiles += TileHtml(Short(score->traces->mean_m, 3) + " m", "in the traces' frames");
    if (score->walls) {
      tiles += TileHtml(Short(score->walls->error_deg) + " degrees", "mean error of the walls' direction");
      tiles += TileHtml(Short(100 * score->walls->within_2_deg, 1) + "%", "of the time under 2 degrees");
    }
    tiles += TileHtml(std::to_string(score->loops.wrong) + " of " + std::to_string(score->loops.found),
                      "loops wrong by more than half a metre", score->loops.wrong == 0 ? "good" : "bad");
  }
  if (result.Has("provenance/seconds_s"))
    tiles += TileHtml(Duration(result.Scalar<double>("provenance/seconds_s")), "wall time");
  return tiles.empty() ? "" : "<div class=\"tiles\">\n" + tiles + "</div>\n";
}

// Without the jumps of angles that are known modulo a quarter turn.
void AddUnwrapped(double time_s, double angle_rad, std::vector<ChartPoint>* points) {
  double degrees = angle_rad / kDegree;
  if (!points->empty()) degrees = points->back().y + std::remainder(degrees - points->back().y, 90);
  points->push_back({time_s, degrees});
}

// Of one robot: as it was found, and as truth has it.
std::string WallsFigure(const Blob& result, const Blob* log, std::size_t robot) {
  const std::string walls = "robot/" + std::to_string(robot) + "/walls/";
  if (!result.Has(walls + "time_s")) return "";
  const auto time = result.Get<double>(walls + "time_s"), angle = result.Get<double>(walls + "angle_rad");
  if (time.size() != angle.size()) throw InputError("'" + walls + "': columns of different length");
  Curve found{.name = "found", .points = {}, .colour = 0}, truth{.name = "true", .points = {}, .colour = 1};
  for (std::size_t i = 0; i < time.size(); ++i)
    if (std::isfinite(angle[i])) AddUnwrapped(time[i], angle[i], &found.points);
  if (log != nullptr && log->Has("truth/" + walls + "time_s")) {
    const auto true_s = log->Get<double>("truth/" + walls + "time_s"),
               true_rad = log->Get<double>("truth/" + walls + "angle_rad");
    const std::string prefix = "robot/" + std::to_string(robot) + "/";
    const Track poses = ReadTrack(*log, "truth/" + prefix + "poses/"),
                odometry = DeadReckoned(*log, prefix + "odometry/");
    for (std::size_t i = 0; i < std::min(true_s.size(), true_rad.size()); ++i) {
      const auto at = PoseAt(poses, true_s[i]), reckoned = PoseAt(odometry, true_s[i], HUGE_VAL);
      if (!at || !reckoned) continue;
      const double angle_rad = true_rad[i] + reckoned->heading_rad - at->heading_rad;
      if (truth.points.empty() && !found.points.empty()) truth.points.push_back(found.points.front());
      AddUnwrapped(true_s[i], angle_rad, &truth.points);
    }
    if (!truth.points.empty()) truth.points.erase(truth.points.begin());
  }
  constexpr std::size_t kMost = 800;
  std::vector<Curve> curves{found};
  if (!truth.points.empty()) curves.push_back(truth);
  for (Curve& curve : curves) curve.points = Thinned(curve.points, kMost);
  Svg svg(kWidth, 270, "Direction of the walls");
  const LineChart chart{"Direction of the walls in the frame of dead reckoning", "s", "degrees", curves};
  return Draw(chart, {86, 24, kWidth - 96, 200}, &svg) ? svg.Finish() : "";
}

std::string MapSection(const LocalResult& local, const Blob* log, const LocalEvaluation* evaluation) {
  const LocalMapPicture around = log != nullptr ? AroundOf(local, *log, evaluation) : LocalMapPicture{};
  std::string caption =
      "Blue: the path put together from the traces. Black: where traces have occupied edges. Dots on the "
      "way: "
      "blue where one trace led to the next, green loops that the path follows, red ones that others "
      "contradict.";
  if (log != nullptr) caption += " Yellow: odometry alone, from the path's first pose.";
  if (!around.walls.empty()) caption += " Grey: true walls, green: the true path, laid over it.";
  return SectionHtml("Path", ImageHtml(LocalMapPng(local, around), "Assembled path and traces", caption));
}

std::string GridSection(const LocalResult& local) {
  const LocalSnapshot* shot = RichestOf(local);
  if (shot == nullptr) return "";
  return SectionHtml(
      "Local grid",
      ImageHtml(
          LocalGridPng(*shot), "Local grids",
          "At " + Short(shot->time_s, 1) +
              " s. Grey: how often a cell is hit. Blue: dominant orientation of its edges. Red: the edges "
              "of the last sweep. Below: the histogram of wall orientations in degrees modulo 90; the dot "
              "is its peak."));
}

std::string TraceSection(const LocalResult& local) {
  const LocalTrace* trace = LongestOf(local);
  if (trace == nullptr) return "";
  return SectionHtml(
      "Longest trace",
      ImageHtml(TracePng(*trace), "An edge trace",
                "The line is the robot's way. On both sides the interval of distances of edges, "
                "bold where they are occupied; red: both ends of large intervals of orientation."));
}

std::string MatchSection(const LocalResult& local, const Blob* log) {
  if (log == nullptr) return "";
  const std::vector<Superposed> shown = Superpositions(local, OdometryOf(*log));
  if (shown.empty()) return "";
  return SectionHtml(
      "Immediate on recorded traces",
      ImageHtml(SuperposedPng(shown), "Immediate traces on recorded ones",
                "Grey: a trace that was recorded before. Black: what the local grids show now, "
                "edges as lines, and where there are none occupied cells as dots; the cross is "
                "where matching put the robot, the frame the limit of the grids."));
}

}  // namespace

std::vector<Track> OdometryOf(const Blob& log) {
  std::vector<Track> tracks;
  for (std::size_t r = 0; r < log.Texts("robots").size(); ++r)
    tracks.push_back(DeadReckoned(log, "robot/" + std::to_string(r) + "/odometry/"));
  return tracks;
}

LocalMapPicture AroundOf(const LocalResult& result, const Blob& log, const LocalEvaluation* evaluation) {
  LocalMapPicture picture;
  const std::vector<Track> odometry = OdometryOf(log);
  if (odometry.size() != result.paths.size())
    throw InputError("the result's robots are not the log's: was it made from this log?");
  for (std::size_t r = 0; r < odometry.size(); ++r) {
    const Track& path = result.paths[r];
    if (path.time_s.empty()) continue;
    const PoseM from = PoseAt(odometry[r], path.time_s.front(), HUGE_VAL).value_or(PoseM{}),
                to = path.poses.front();
    Similarity move;
    move.angle_rad = to.heading_rad - from.heading_rad;
    const PointM turned = move(PointM{from.x_m, from.y_m});
    move.x_m = to.x_m - turned.x_m;
    move.y_m = to.y_m - turned.y_m;
    picture.odometry.emplace_back();
    for (const PoseM& pose : odometry[r].poses)
      picture.odometry.back().push_back(move(PointM{pose.x_m, pose.y_m}));
  }
  if (evaluation == nullptr) return picture;
  const Similarity to_result = Inverse(evaluation->alignment);
  if (log.Has("truth/walls/x_m")) picture.walls = ReadSegments(log, "truth/walls/", to_result);
  for (std::size_t r = 0; r < result.paths.size(); ++r) {
    picture.truth.emplace_back();
    for (const PoseM& pose : ReadTrack(log, "truth/robot/" + std::to_string(r) + "/poses/").poses)
      picture.truth.back().push_back(to_result(PointM{pose.x_m, pose.y_m}));
  }
  return picture;
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
  std::string html = Lead(result, local) + Tiles(result, evaluation) + MapSection(local, log, evaluation);
  std::string walls;
  for (std::size_t r = 0; r < local.paths.size(); ++r)
    walls += FigureHtml(WallsFigure(result, log, r), "Odometry that drifts turns them; modulo 90 degrees.");
  html += SectionHtml("Direction of the walls", walls);
  html += GridSection(local) + TraceSection(local) + MatchSection(local, log);
  html += SectionHtml("Time", TimeHtml(RoundTimes(result)));
  html += SectionHtml("Job", ProvenanceHtml(result));
  return html;
}

}  // namespace cairn::datasets::report
