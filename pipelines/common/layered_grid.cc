#include "pipelines/common/layered_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipelines/common/handed_over.h"
#include "pipelines/common/taps.h"

namespace cairn {
namespace {

constexpr std::int32_t kFarthest = 1 << 28;  // cells

}  // namespace

Box Union(const Box& a, const Box& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  const int x0 = std::min(a.x0, b.x0), y0 = std::min(a.y0, b.y0);
  return {x0, y0, std::max(a.x0 + a.nx, b.x0 + b.nx) - x0, std::max(a.y0 + a.ny, b.y0 + b.ny) - y0};
}

Box Intersection(const Box& a, const Box& b) {
  const int x0 = std::max(a.x0, b.x0), y0 = std::max(a.y0, b.y0);
  const int x1 = std::min(a.x0 + a.nx, b.x0 + b.nx), y1 = std::min(a.y0 + a.ny, b.y0 + b.ny);
  if (x1 <= x0 || y1 <= y0) return {};
  return {x0, y0, x1 - x0, y1 - y0};
}

Layer::Layer(const Box& b) : box(b) {
  for (const std::int32_t corner : {b.x0, b.y0, b.nx, b.ny})
    RequireWithin("a box", std::int64_t{corner}, -kFarthest, kFarthest);
  values.assign(static_cast<std::size_t>(b.cells()), 0.0);
}

void Layer::Cover(const Box& wanted) {
  const Box wide = Union(box, wanted);
  if (wide == box) return;
  Layer layer(wide);
  if (!box.empty()) layer.AddShifted(*this, 0, 0, 1.0);
  *this = std::move(layer);
}

void Layer::AddShifted(const Layer& other, int dx, int dy, double weight) {
  const int begin = other.box.x0, end = other.box.x0 + other.box.nx;
  for (int y = other.box.y0; y < other.box.y0 + other.box.ny; ++y) {
    const RowOf<const double> from = other.Row(y);
    const RowOf<double> to = Row(y + dy) + dx;
    for (int x = begin; x < end; ++x) to[x] = std::fma(weight, from[x], to[x]);
  }
}

void Layer::Prune(double least) {
  int x0 = box.x0 + box.nx, x1 = box.x0, y0 = box.y0 + box.ny, y1 = box.y0;
  for (int y = box.y0; y < box.y0 + box.ny; ++y) {
    const RowOf<double> row = Row(y);
    int first = box.x0 + box.nx, last = box.x0 - 1;
    for (int x = box.x0; x < box.x0 + box.nx; ++x) {
      if (row[x] < least) row[x] = 0.0;
      if (row[x] > 0.0) {
        first = std::min(first, x);
        last = x;
      }
    }
    if (last < first) continue;
    x0 = std::min(x0, first);
    x1 = std::max(x1, last + 1);
    y0 = std::min(y0, y);
    y1 = y + 1;
  }
  if (y1 <= y0) {
    *this = Layer();
    return;
  }
  const Box tight{x0, y0, x1 - x0, y1 - y0};
  if (tight == box) return;
  Layer layer(tight);
  for (int y = y0; y < y1; ++y) std::copy_n(&Row(y)[x0], tight.nx, &layer.Row(y)[x0]);
  *this = std::move(layer);
}

// Eight running values, joined in one fixed order: quick, and the same bits whatever the vector width.
double Layer::Sum() const {
  std::array<double, 8> lanes{};
  std::size_t i = 0;
  for (; i + 8 <= values.size(); i += 8) {
    for (std::size_t k = 0; k < 8; ++k) lanes[k] += values[i + k];
  }
  for (std::size_t k = 0; i < values.size(); ++i, ++k) lanes[k] += values[i];
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

double Layer::Max() const {
  std::array<double, 8> lanes{};
  std::size_t i = 0;
  for (; i + 8 <= values.size(); i += 8) {
    for (std::size_t k = 0; k < 8; ++k) lanes[k] = values[i + k] > lanes[k] ? values[i + k] : lanes[k];
  }
  double max = 0.0;
  for (; i < values.size(); ++i) max = std::max(max, values[i]);
  for (const double lane : lanes) max = std::max(max, lane);
  return max;
}

double LayeredGrid::Sum() const {
  double sum = 0.0;
  for (const Layer& layer : layers) sum += layer.Sum();
  return sum;
}

double LayeredGrid::Max() const {
  double max = 0.0;
  for (const Layer& layer : layers) max = std::max(max, layer.Max());
  return max;
}

void LayeredGrid::Scale(double factor) {
  for (Layer& layer : layers) {
    for (double& value : layer.values) value *= factor;
  }
}

std::int64_t LayeredGrid::cells() const {
  std::int64_t cells = 0;
  for (const Layer& layer : layers) cells += layer.box.cells();
  return cells;
}

namespace {

Array BoxesOf(const std::vector<Layer>& layers) {
  std::vector<std::int32_t> boxes;
  for (const Layer& layer : layers) {
    boxes.insert(boxes.end(), {layer.box.x0, layer.box.y0, layer.box.nx, layer.box.ny});
  }
  return Array::Of<std::int32_t>({static_cast<std::int64_t>(layers.size()), 4}, boxes);
}

// Layers without values yet. Boxes that no belief can have are refused: their corners would leave 32 bits.
std::vector<Layer> LayersOf(const std::string& prefix, const Blob& blob) {
  const auto boxes = blob.Get<std::int32_t>(prefix + "box");
  if (boxes.size() % 4 != 0) throw InputError("'" + prefix + "box' does not hold four numbers a layer");
  std::vector<Layer> layers(boxes.size() / 4);
  for (std::size_t i = 0; i < layers.size(); ++i) {
    for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) {
      if (boxes[k] < -kFarthest || boxes[k] > kFarthest || (k % 4 > 1 && boxes[k] < 0))
        throw InputError("'" + prefix + "box' holds a box that is none: layer " + std::to_string(i));
    }
    layers[i].box = {boxes[4 * i], boxes[4 * i + 1], boxes[4 * i + 2], boxes[4 * i + 3]};
  }
  return layers;
}

}  // namespace

void LayeredGrid::Store(const std::string& prefix, Blob* blob) const {
  std::vector<double> values;
  for (const Layer& layer : layers) values.insert(values.end(), layer.values.begin(), layer.values.end());
  blob->Put(prefix + "box", BoxesOf(layers));
  blob->PutVector<double>(prefix + "value", values);
}

LayeredGrid LayeredGrid::Load(const std::string& prefix, const Blob& blob) {
  const auto values = blob.Get<double>(prefix + "value");
  LayeredGrid grid{LayersOf(prefix, blob)};
  std::size_t at = 0;
  for (Layer& layer : grid.layers) {
    const auto cells = static_cast<std::size_t>(layer.box.cells());
    if (cells > values.size() - at) throw InputError("'" + prefix + "value' is shorter than its boxes");
    layer.values.assign(values.begin() + static_cast<std::ptrdiff_t>(at),
                        values.begin() + static_cast<std::ptrdiff_t>(at + cells));
    at += cells;
  }
  if (at != values.size()) throw InputError("'" + prefix + "value' is longer than its boxes");
  return grid;
}

void LayeredGrid::StoreSparse(const std::string& prefix, Blob* blob) const {
  std::vector<std::int64_t> runs;
  std::vector<double> values;
  std::size_t filled = 0;
  for (const Layer& layer : layers) filled += layer.values.size() - std::ranges::count(layer.values, 0.0);
  values.reserve(filled);
  std::int64_t at = 0;
  for (const Layer& layer : layers) {
    bool inside = false;
    for (const double value : layer.values) {
      if (value != 0.0) {
        if (!inside) runs.insert(runs.end(), {at, 0});
        ++runs.back();
        values.push_back(value);
      }
      inside = value != 0.0;
      ++at;
    }
  }
  blob->Put(prefix + "box", BoxesOf(layers));
  blob->Put(prefix + "run", Array::Of<std::int64_t>({static_cast<std::int64_t>(runs.size() / 2), 2}, runs));
  blob->PutVector<double>(prefix + "value", values);
}

LayeredGrid LayeredGrid::LoadSparse(const std::string& prefix, const Blob& blob, double most_cells) {
  const auto values = blob.Get<double>(prefix + "value");
  const auto runs = blob.Get<std::int64_t>(prefix + "run");
  LayeredGrid grid{LayersOf(prefix, blob)};
  const auto refuse = [&] { throw InputError("'" + prefix + "run' does not fit its boxes and values"); };
  if (runs.size() % 2 != 0) refuse();
  double all_cells = 0.0;
  for (const Layer& layer : grid.layers) all_cells += static_cast<double>(layer.box.cells());
  RequireWithin("the number of cells of '" + prefix + "box'", all_cells, 0.0, most_cells);
  std::int64_t begin = 0, value = 0;  // of the layer's cells; of the values not yet placed
  std::size_t run = 0;
  for (Layer& layer : grid.layers) {
    const std::int64_t cells = layer.box.cells(), end = begin + cells;
    layer.values.assign(static_cast<std::size_t>(cells), 0.0);
    for (std::int64_t least = begin; run < runs.size() && runs[run] < end; run += 2) {
      const std::int64_t first = runs[run], count = runs[run + 1];
      if (first < least || count < 1 || count > end - first) refuse();
      if (count > static_cast<std::int64_t>(values.size()) - value) refuse();
      std::copy_n(values.begin() + value, count, layer.values.begin() + (first - begin));
      value += count;
      least = first + count;
    }
    begin = end;
  }
  if (run != runs.size() || value != static_cast<std::int64_t>(values.size())) refuse();
  return grid;
}

Layer SumOverLayers(const LayeredGrid& grid) {
  Box box;
  for (const Layer& layer : grid.layers) box = Union(box, layer.box);
  Layer sum(box);
  for (const Layer& layer : grid.layers) sum.AddShifted(layer, 0, 0, 1.0);
  return sum;
}

Layer Blur(const Layer& layer, double sigma) {
  if (sigma <= 0.0 || layer.box.empty()) return layer;
  const Taps taps = GaussianTaps(sigma);
  const int reach = taps.reach();
  Layer along_x(Box{layer.box.x0 - reach, layer.box.y0, layer.box.nx + 2 * reach, layer.box.ny});
  for (int k = -reach; k <= reach; ++k) along_x.AddShifted(layer, k, 0, taps.At(k));
  Layer blurred(along_x.box.empty()
                    ? Box{}
                    : Box{along_x.box.x0, layer.box.y0 - reach, along_x.box.nx, layer.box.ny + 2 * reach});
  for (int k = -reach; k <= reach; ++k) blurred.AddShifted(along_x, 0, k, taps.At(k));
  return blurred;
}

Layer DiscSum(const Layer& layer, double radius) {
  if (layer.box.empty()) return {};
  const int reach = static_cast<int>(std::floor(radius));
  Layer sums(layer.box.Grown(reach));
  std::vector<double> prefix(static_cast<std::size_t>(layer.box.nx) + 1);
  for (int y = layer.box.y0; y < layer.box.y0 + layer.box.ny; ++y) {
    for (int i = 0; i < layer.box.nx; ++i) prefix[i + 1] = prefix[i] + layer.Row(y)[layer.box.x0 + i];
    for (int dy = -reach; dy <= reach; ++dy) {
      const int half = static_cast<int>(std::floor(std::sqrt(radius * radius - double(dy) * dy)));
      const RowOf<double> row = sums.Row(y + dy);
      for (int x = layer.box.x0 - half; x < layer.box.x0 + layer.box.nx + half; ++x) {
        const int low = std::clamp(x - half - layer.box.x0, 0, layer.box.nx);
        const int high = std::clamp(x + half + 1 - layer.box.x0, 0, layer.box.nx);
        row[x] += prefix[static_cast<std::size_t>(high)] - prefix[static_cast<std::size_t>(low)];
      }
    }
  }
  return sums;
}

}  // namespace cairn
