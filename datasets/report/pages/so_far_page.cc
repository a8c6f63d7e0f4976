#include <vector>

#include "datasets/evaluate/landmarks.h"
#include "datasets/report/draw_map.h"
#include "datasets/report/drawing/format.h"
#include "datasets/report/pages/facts.h"
#include "datasets/report/pages/pages.h"
#include "datasets/report/pages/parts.h"
#include "datasets/report/pictures.h"
#include "schema/kinds/map_so_far.h"

namespace cairn::datasets::report {
namespace {

// As a landmark_map, a grid_map or networks would have it.
Blob MapOf(const Blob& so_far) {
  Blob map = so_far.Sub("so_far/").Without("robot");
  if (!map.Has("map/grid/occupied")) return map;
  const auto occupied = map.Get<std::uint8_t>("map/grid/occupied");
  map.Put("map/grid/probability",
          Array::Of<double>(map.at("map/grid/occupied").shape(), {occupied.begin(), occupied.end()}));
  return map;
}

Scene SceneOfSoFar(const Blob& so_far) {
  const auto of = Read<kinds::MapSoFar>(so_far);
  Scene scene = MakeScene(MapOf(so_far), nullptr, nullptr);
  for (std::size_t r = 0; r < of.robot.size(); ++r) {
    const kinds::MapSoFar::Poses& poses = of.robot[r].poses;
    Path path{.robot = of.robots[r], .index = r, .points = PointsOf(poses.x_m, poses.y_m)};
    path.time_s.assign(poses.time_s.begin(), poses.time_s.end());
    if (!path.points.empty()) scene.paths.push_back(std::move(path));
  }
  scene.edges = PointsOf(of.edge_x_m.OrNone(), of.edge_y_m.OrNone());
  return scene;
}

std::string MapHtml(const Blob& map, const Scene& scene) {
  const char* const caption =
      map.Has("map/landmark_x_m")
          ? "The landmarks that the last iteration found, with the regions in which they lie with 95%, and "
            "where it has the robots on average; the slider shows the landmarks of earlier ones."
          : "The paths as they are by now, each in a frame of its own, and where walls were met.";
  return SectionHtml("Map", LegendHtml(LegendOf(scene)) +
                                DrawingHtml([&](double width) { return MapPicture(scene, width); }, caption));
}

}  // namespace

std::string SoFarPng(const Blob& so_far, int width_px) {
  const Blob map = MapOf(so_far);
  if (map.Has("map/output")) return NetworksPng(map);
  return map.Has("map/grid/occupied") ? DrawGridPng(map, nullptr, nullptr, width_px)
                                      : DrawScenePng(SceneOfSoFar(so_far), width_px);
}

std::string SoFarHtml(const Blob& so_far) {
  const Blob map = MapOf(so_far);
  const bool networks = map.Has("map/output");
  std::string html =
      "<p class=\"lead\">" +
      Escape((networks ? "Networks that are still being trained: " : "A map that is still being made: ") +
             map.Text("what") + ". It is no result.") +
      "</p>\n";
  if (networks) return html + SectionHtml("What the networks see", OutputsHtml(map));
  if (map.Has("map/grid/occupied")) return html + GridSoFarHtml(map);
  html += MapHtml(map, SceneOfSoFar(so_far));
  if (!map.Has("history/log_likelihood")) return html;
  const std::vector<Iteration> iterations = Iterations(map);
  return html + SectionHtml("Convergence",
                            DrawingHtml([&](double width) { return LikelihoodPicture(iterations, width); },
                                        "Of the data under the map with which the iteration began."));
}

}  // namespace cairn::datasets::report
