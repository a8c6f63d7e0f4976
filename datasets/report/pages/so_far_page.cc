#include <vector>

#include "datasets/report/drawing/format.h"
#include "datasets/report/pages/facts.h"
#include "datasets/report/pages/pages.h"
#include "datasets/report/pages/parts.h"
#include "datasets/report/pictures.h"

namespace cairn::datasets::report {

Blob MapOfSoFar(const Blob& so_far) {
  Blob map = so_far.Sub("so_far/");
  if (!map.Has("map/grid/occupied")) return map;
  const auto occupied = map.Get<std::uint8_t>("map/grid/occupied");
  map.Put("map/grid/probability",
          Array::Of<double>(map.at("map/grid/occupied").shape(), {occupied.begin(), occupied.end()}));
  return map;
}

std::string SoFarHtml(const Blob& so_far) {
  const Blob map = MapOfSoFar(so_far);
  std::string html = "<p class=\"lead\">" +
                     Escape("A map that is still being made: " + map.Text("what") + ". It is no result.") +
                     "</p>\n";
  if (map.Has("map/grid/occupied")) return html + GridSoFarHtml(map);
  const Scene scene = MakeScene(map, nullptr, nullptr);
  html +=
      SectionHtml("Map", LegendHtml(LegendOf(scene)) +
                             DrawingHtml([&](double width) { return MapPicture(scene, width); },
                                         "The landmarks that the last iteration found, with the regions in "
                                         "which they lie with 95%; the slider shows those of earlier ones. "
                                         "The paths come with the result."));
  const std::vector<Iteration> iterations = Iterations(map);
  return html + SectionHtml("Convergence",
                            DrawingHtml([&](double width) { return LikelihoodPicture(iterations, width); },
                                        "Of the data under the map with which the iteration began."));
}

}  // namespace cairn::datasets::report
