// The pictures of the report, of a width in pixels.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "datasets/report/drawing/picture.h"
#include "datasets/report/scene.h"

namespace cairn::datasets::report {

// Cells beneath a map, north up.
struct MapCells {
  Raster raster;
  Box box;
  std::vector<Raster> rounds = {};  // what stood there before, round by round
};

struct MapView {
  std::optional<MapCells> below = {};
  std::vector<std::pair<std::string, MapCells>> instead = {};  // by their names, over those, for who asks
  bool round_cells = false;                                    // the map ends where they do
  std::string label = "Map with the robots' paths";
  double highest = 0.88;  // the panel's height as a share of its width, at most
};

// The map: cells, paths, landmarks with their 95% regions, walls, and truth where the scene has it. Names are
// where they cover neither each other nor a landmark.
Picture MapPicture(const Scene& scene, double width, const MapView& view = {});
// What its colours and marks mean.
std::vector<LegendEntry> LegendOf(const Scene& scene);

// Dead reckoning and the most likely poses side by side (on a narrow page one above the other) at one scale;
// empty where the scene has no odometry.
Picture BeforeAfterPicture(const Scene& scene, double width);

// P(landmark) of each cell; empty where the scene has no grid.
Picture GridPicture(const Scene& scene, double width);

// The strength of a colour is the root of probability / highest, by its opacity, so that it lies well on
// light and dark paper; a cell a pixel. Grids of more than 1,500 cells along an axis are thinned, each pixel
// the largest of its cells.
enum class GridColours {
  kBelief,   // from light blue to crimson
  kTint,     // light blue, beneath other things
  kDensity,  // dark blue
  kGreys,    // of occupancy: no opacity, unknown cells in a colour of their own
};
Raster GridRaster(const Grid& grid, GridColours colours = GridColours::kBelief);
double HighestProbability(const Grid& grid);
Box BoxOf(const Grid& grid);

// One iteration of the expectation maximisation.
struct Iteration {
  double log_likelihood = 0;
  double prefix = 1;        // fraction of the data that it used
  std::int64_t robots = 1;  // that took part
};
// Log-likelihood by iteration, from the second on: the first had no map, its figure is of nothing. A line
// joins those of the same data; what is not of all data is hollow. Empty without a finite value.
Picture LikelihoodPicture(const std::vector<Iteration>& iterations, double width);

struct RoundTime {
  std::string note;
  double seconds = 0;          // wall time
  double compute_seconds = 0;  // of all its tasks, added up
  std::int64_t tasks = 0;
  std::int64_t rounds = 1;  // one after the other, that this is of
};
// A bar for each, as high as a round took, as wide as there are rounds; empty without any.
Picture RoundsPicture(const std::vector<RoundTime>& rounds, double width);

}  // namespace cairn::datasets::report
