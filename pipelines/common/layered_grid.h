// Sparse stacks of 2-D grids: a belief over x-y-theta (a layer per heading), expected counts and landmark
// maps (a layer per landmark type). Each layer keeps only the bounding box of its support ([TBF98] section 5,
// selective memorization). Cell (i, j) is the square of edge cell_m centred on (i, j) * cell_m; indices may
// be negative.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn {

// Cells x0 <= i < x0 + nx, y0 <= j < y0 + ny.
struct Box {
  std::int32_t x0 = 0, y0 = 0, nx = 0, ny = 0;

  bool empty() const { return nx <= 0 || ny <= 0; }
  std::int64_t cells() const { return empty() ? 0 : std::int64_t{nx} * ny; }
  bool Contains(int x, int y) const { return x >= x0 && x < x0 + nx && y >= y0 && y < y0 + ny; }
  Box Shifted(int dx, int dy) const { return {x0 + dx, y0 + dy, nx, ny}; }
  Box Grown(int margin) const { return {x0 - margin, y0 - margin, nx + 2 * margin, ny + 2 * margin}; }
  friend bool operator==(const Box&, const Box&) = default;
};

Box Union(const Box& a, const Box& b);
Box Intersection(const Box& a, const Box& b);

// A row of a layer, indexed by cell: row[x]. `row + dx` reads dx cells further.
template <class T>
struct RowOf {
  T* first;
  int x0;
  T& operator[](int x) const { return first[x - x0]; }
  RowOf operator+(int dx) const { return {first, x0 - dx}; }
};

// One layer: values [ny][nx] over its box, zero outside.
struct Layer {
  Box box;
  std::vector<double> values;

  Layer() = default;
  // Zeros. Throws InputError where the box lies so far away that sums of cells would leave 32 bits.
  explicit Layer(const Box& b);
  RowOf<double> Row(int y) { return {values.data() + std::int64_t{y - box.y0} * box.nx, box.x0}; }
  RowOf<const double> Row(int y) const { return {values.data() + std::int64_t{y - box.y0} * box.nx, box.x0}; }
  double At(int x, int y) const { return box.Contains(x, y) ? Row(y)[x] : 0.0; }

  // Widens the box to hold `wanted` too, keeping the values.
  void Cover(const Box& wanted);
  // this += weight * other shifted by (dx, dy); `other`'s shifted box must lie inside this one's.
  void AddShifted(const Layer& other, int dx, int dy, double weight);
  // Zeroes values below `least` and shrinks the box to what is left.
  void Prune(double least);
  double Sum() const;
  double Max() const;
};

struct LayeredGrid {
  std::vector<Layer> layers;

  double Sum() const;  // in the order of layers, rows, cells
  double Max() const;
  void Scale(double factor);
  std::int64_t cells() const;

  // Arrays PREFIXbox [L,4] i32 (x0, y0, nx, ny) and PREFIXvalue [sum of cells] f64.
  void Store(const std::string& prefix, Blob* blob) const;
  // Throws InputError where a box is none, or the boxes do not have as many cells as there are values.
  static LayeredGrid Load(const std::string& prefix, const Blob& blob);
  // The same without zeros, for grids that are nearly empty: PREFIXvalue holds what PREFIXrun [R,2] i64
  // (index of a run's first cell in the order of layers, rows, cells; its length) picks out.
  void StoreSparse(const std::string& prefix, Blob* blob) const;
  // Throws InputError as Load does, where the runs do not fit the boxes and values, and where with its zeros
  // it would have more than `most_cells`.
  static LayeredGrid LoadSparse(const std::string& prefix, const Blob& blob,
                                double most_cells = std::numeric_limits<double>::infinity());
};

// The layers added up, in their order.
Layer SumOverLayers(const LayeredGrid& grid);

// A separable blur by a Gaussian of `sigma` cells, mass kept; the box grows by the taps' reach.
Layer Blur(const Layer& layer, double sigma);

// For each cell of `layer`'s box grown by the radius: the sum over the cells whose centres lie within
// `radius` cells.
Layer DiscSum(const Layer& layer, double radius);

}  // namespace cairn
