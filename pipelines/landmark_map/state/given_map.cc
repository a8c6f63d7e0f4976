#include "pipelines/landmark_map/state/given_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "schema/kinds/landmark_map.h"

namespace cairn::landmark_map {
namespace {

[[noreturn]] void Refuse(const std::string& why) { throw InputError("the input 'map': " + why); }

// The target cells of edge `to_m` under the source cell [low_m, low_m + from_m), and the share of it in each.
struct Cover {
  int first = 0;
  std::vector<double> share;
};

Cover CoverOf(double low_m, double from_m, double to_m) {
  constexpr double kSliver = 1e-9;  // rounding
  Cover cover;
  cover.first = static_cast<int>(std::floor(low_m / to_m + 0.5 + kSliver));
  const double high_m = low_m + from_m;
  for (int i = cover.first; (i - 0.5) * to_m < high_m - kSliver * from_m; ++i) {
    const double overlap_m = std::min(high_m, (i + 0.5) * to_m) - std::max(low_m, (i - 0.5) * to_m);
    cover.share.push_back(std::max(0.0, overlap_m) / from_m);
  }
  return cover;
}

struct Source {
  double x_m, y_m, cell_m;  // lower left corner, edge
  std::int64_t nx, ny;
};

// One type's cells, rows from the lowest y.
Layer Resample(std::span<const double> cells, const Source& source, double cell_m) {
  std::vector<Cover> columns, rows;
  for (std::int64_t i = 0; i < source.nx; ++i)
    columns.push_back(CoverOf(source.x_m + i * source.cell_m, source.cell_m, cell_m));
  for (std::int64_t j = 0; j < source.ny; ++j)
    rows.push_back(CoverOf(source.y_m + j * source.cell_m, source.cell_m, cell_m));
  const auto past = [](const Cover& last) { return last.first + static_cast<int>(last.share.size()); };
  Layer layer(Box{columns.front().first, rows.front().first, past(columns.back()) - columns.front().first,
                  past(rows.back()) - rows.front().first});
  for (std::size_t j = 0; j < rows.size(); ++j) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const double p = cells[j * columns.size() + i];
      if (!(p > 0.0)) continue;  // NaN: never looked at
      if (p > 1.0) Refuse("a cell holds " + std::to_string(p) + ", which is no probability");
      for (std::size_t b = 0; b < rows[j].share.size(); ++b) {
        const RowOf<double> row = layer.Row(rows[j].first + static_cast<int>(b));
        for (std::size_t a = 0; a < columns[i].share.size(); ++a)
          row[columns[i].first + static_cast<int>(a)] += p * rows[j].share[b] * columns[i].share[a];
      }
    }
  }
  for (double& value : layer.values) value = std::min(value, 1.0);
  constexpr double kNothing = 1e-12;
  layer.Prune(kNothing);
  return layer;
}

Source SourceOf(const kinds::LandmarkMap::Map& map, const Settings& settings) {
  if (map.probability.empty()) Refuse("its grid has no cells");
  const Shape& shape = map.probability.shape();
  const Source source{map.grid.origin_x_m.Scalar(), map.grid.origin_y_m.Scalar(), map.grid.cell_m.Scalar(),
                      shape[2], shape[1]};
  constexpr double kFarthest_m = 1e6;
  const double width = source.nx * source.cell_m, height = source.ny * source.cell_m;
  if (!(std::abs(source.x_m) + width <= kFarthest_m) || !(std::abs(source.y_m) + height <= kFarthest_m))
    Refuse("its grid's origin and cell size are no sensible figures");
  const double cell = settings.map.grid.cell_m;
  const double megabytes = (width / cell + 1.0) * (height / cell + 1.0) * sizeof(double) / 1e6;
  if (megabytes > settings.memory_mb)
    Refuse("at cells of " + std::to_string(cell) + " m it needs " + std::to_string(std::llround(megabytes)) +
           " MB, more than memory_mb: take a larger cell_m");
  return source;
}

// The log's type for each of the map's layers; -1: the log has no such landmark.
std::vector<int> TypesOf(const kinds::LandmarkMap& map, const kinds::Log& log, const MapRules& rules) {
  const std::vector<std::string>& known = log.landmarks;
  std::vector<int> types;
  for (const std::string& name : map.landmarks) {
    const auto it = std::ranges::find(known, name);
    types.push_back(it == known.end() ? -1 : static_cast<int>(it - known.begin()));
  }
  const auto &classes = map.types.OrNone(), &of_log = log.types.OrNone();
  if (rules.classes.count > 1 ? classes != of_log : classes.size() > 1)
    Refuse("its types of landmarks are not the log's");
  for (int landmark_class = 0; landmark_class < rules.classes.count; ++landmark_class)
    types.push_back(rules.types + landmark_class);  // no identity
  return types;
}

std::vector<Landmark> LandmarksOf(const kinds::LandmarkMap& of, const std::vector<int>& types) {
  const kinds::LandmarkMap::Map& map = of.map;
  const std::span<const double> v = map.landmark_covariance_m2;
  std::vector<Landmark> landmarks;
  for (std::size_t k = 0; k < map.landmark_x_m.size(); ++k) {
    const std::int32_t identity = map.landmark_identity[k];
    const int type = types[identity < 0 ? of.landmarks.size() : static_cast<std::size_t>(identity)];
    if (type < 0) continue;
    landmarks.push_back({map.landmark_x_m[k],
                         map.landmark_y_m[k],
                         {v[4 * k], v[4 * k + 1], v[4 * k + 2], v[4 * k + 3]},
                         type,
                         map.landmark_count[k]});
  }
  return landmarks;
}

// A landmark that the map names is one, too, of which an observation without a name may be.
void AddNamed(const MapRules& rules, LayeredGrid* map) {
  const Layer named = WeightedSum(*map, 0, std::vector<double>(static_cast<std::size_t>(rules.types), 1.0));
  for (int k = rules.types; k < rules.layers(); ++k) {
    Layer& layer = map->layers[static_cast<std::size_t>(k)];
    layer.Cover(named.box);
    for (int y = named.box.y0; y < named.box.y0 + named.box.ny; ++y) {
      for (int x = named.box.x0; x < named.box.x0 + named.box.nx; ++x) {
        const double here = std::min(1.0, named.Row(y)[x]) / rules.classes.count;
        layer.Row(y)[x] = std::max(std::as_const(layer).Row(y)[x], here);
      }
    }
  }
}

}  // namespace

GivenMap ReadGivenMap(const Blob& blob, const Blob& log, const Settings& settings) {
  for (const char* name : {"landmarks", "map/grid/probability", "map/landmark_x_m"}) {
    if (!blob.Has(name)) Refuse(std::string("no landmark_map: '") + name + "' is missing");
  }
  const auto map = Read<kinds::LandmarkMap>(blob);
  const Source source = SourceOf(map.map, settings);
  const std::vector<int> types = TypesOf(map, Read<kinds::Log>(log), settings.map);
  const std::span<const double> cells = map.map.probability;
  const auto layers = static_cast<std::size_t>(map.map.probability.shape()[0]);
  if (layers > types.size()) Refuse("its grid has more layers than it names landmarks");
  GivenMap given;
  given.map.layers.resize(static_cast<std::size_t>(settings.map.layers()));
  const auto area = static_cast<std::size_t>(source.nx * source.ny);
  for (std::size_t k = 0; k < layers; ++k) {
    if (types[k] < 0) continue;
    given.map.layers[static_cast<std::size_t>(types[k])] =
        Resample(cells.subspan(k * area, area), source, settings.map.grid.cell_m);
  }
  if (settings.map.partly_named) AddNamed(settings.map, &given.map);
  given.landmarks = LandmarksOf(map, types);
  Box box;
  for (const Layer& layer : given.map.layers) box = Union(box, layer.box);
  if (box.empty()) Refuse("it holds none of the landmarks that the log can name");
  const Box limit = settings.Model(nullptr).limit;
  if (!limit.empty() && Intersection(box, limit).empty()) Refuse("it lies outside box_m");
  return given;
}

void CheckReach(const LayeredGrid& map, const RobotSteps& steps, const Settings& settings) {
  const double cell = settings.map.grid.cell_m;
  double range_m = 0.0, nearest_m = HUGE_VAL;
  for (const Observation& seen : steps.observations)
    range_m = std::max(range_m, std::hypot(seen.x_m, seen.y_m));
  for (const Layer& layer : map.layers) {
    for (int y = layer.box.y0; y < layer.box.y0 + layer.box.ny; ++y) {
      for (int x = layer.box.x0; x < layer.box.x0 + layer.box.nx; ++x) {
        if (layer.Row(y)[x] > 0.0) nearest_m = std::min(nearest_m, cell * std::hypot(x, y));
      }
    }
  }
  constexpr double kErrs = 1.2;  // odometry's distance may be short by so much
  const double reach_m = kErrs * steps.DistanceTravelled().back() + range_m + 2.0 * settings.map.radius_m;
  if (nearest_m <= reach_m) return;
  Refuse(fmt::format(
      "it is nowhere nearer than {:.0f} m to the origin, where the first robot starts, and that sees no "
      "farther than {:.0f} m: another place, or another frame (start=anywhere looks for the place)",
      nearest_m, reach_m));
}

void CheckLikelihood(double log_likelihood, const Perception& perception,
                     const std::vector<RobotSteps>& robots) {
  double all_false = 0.0;
  for (const RobotSteps& steps : robots) {
    for (const Observation& seen : steps.observations) {
      if (!perception.Of(seen.type).box.empty()) all_false += std::log(perception.OutsideOf(seen.type));
    }
  }
  if (log_likelihood > all_false) return;
  Refuse(fmt::format(
      "under it the data are no more likely ({:.1f} nats) than if every observation were false ({:.1f}): is "
      "it a map of this place, in the frame of the first robot's start? start=anywhere looks for the place",
      log_likelihood, all_false));
}

}  // namespace cairn::landmark_map
