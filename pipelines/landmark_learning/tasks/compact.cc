#include "pipelines/landmark_learning/tasks/compact.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pipelines/landmark_learning/error_sum/features.h"
#include "pipelines/landmark_learning/error_sum/posterior_error.h"
#include "pipelines/landmark_learning/state/sum_path.h"

namespace cairn::landmark_learning {
namespace {

// Adds a row of `vectors` numbers, times `factor`.
template <class Real>
void AddScaledRow(Real factor, const Real* from, int vectors, Real* to) {
  for (int f = 0; f < vectors; ++f) to[f] += factor * from[f];
}

template <class Real>
std::vector<Real> Means(const Cells& cells, const std::vector<Real>& probability, int vectors) {
  const auto width = static_cast<std::size_t>(vectors);
  std::vector<Real> means(static_cast<std::size_t>(cells.size()) * width, Real(0));
  for (std::size_t k = 0; k < cells.of.size(); ++k) {
    const auto cell = static_cast<std::size_t>(cells.of[k]);
    // [Thr98] section 4.4.2, item 2: P(f | xi) of cells
    AddScaledRow(Real(1) / static_cast<Real>(cells.count[cell]), &probability[k * width], vectors,
                 &means[cell * width]);
  }
  return means;
}

}  // namespace

Cells CellsOf(const SampleSet& samples, double cell_m) {
  Cells cells;
  std::map<std::pair<double, double>, std::int32_t> index;
  const Positions& from = samples.positions;
  for (std::size_t k = 0; k < samples.weight.size(); ++k) {
    const auto [cell, is_new] =
        index.try_emplace({std::floor(from.x_m[k] / cell_m), std::floor(from.y_m[k] / cell_m)},
                          static_cast<std::int32_t>(cells.count.size()));
    if (is_new) {
      for (auto* values :
           {&cells.positions.x_m, &cells.positions.y_m, &cells.positions.along_m, &cells.weight})
        values->push_back(0.0);
      cells.count.push_back(0);
      if (!from.row.empty())
        cells.positions.row.push_back(from.row[k]);  // of a table: that of its first sample
    }
    const auto c = static_cast<std::size_t>(cell->second);
    cells.of.push_back(cell->second);
    ++cells.count[c];
    cells.positions.x_m[c] += from.x_m[k];
    cells.positions.y_m[c] += from.y_m[k];
    cells.positions.along_m[c] += from.along_m[k];
    cells.weight[c] += samples.weight[k];
  }
  for (std::size_t c = 0; c < cells.count.size(); ++c) {
    for (auto* values : {&cells.positions.x_m, &cells.positions.y_m, &cells.positions.along_m})
      (*values)[c] /= cells.count[c];
  }
  cells.positions.table = from.table;
  return cells;
}

template <class Real>
CellShare<Real> OutputGradientOfCells(const Options& options, const Cells& cells,
                                      std::span<const Real> outputs, int networks, const IndexRange& block) {
  const auto row = static_cast<std::size_t>(networks);
  if (outputs.size() != cells.of.size() * row)
    throw InputError("the outputs are of other samples or networks");
  const int vectors = static_cast<int>(FeatureVectors(networks));
  const std::vector<Real> g(outputs.begin(), outputs.end());
  const std::vector<Real> means = Means(cells, FeatureProbabilities(g, networks), vectors);
  const Pairs pairs(cells.positions, cells.positions, BeliefOf(options), ErrorOf(options));
  const auto share = ErrorOfTruePositions(pairs, means, vectors, cells.weight, block);
  const auto width = static_cast<std::size_t>(vectors);
  std::vector<Real> d_probability(cells.of.size() * width, Real(0));
  for (std::size_t k = 0; k < cells.of.size(); ++k) {
    const auto cell = static_cast<std::size_t>(cells.of[k]);
    AddScaledRow(Real(1) / static_cast<Real>(cells.count[cell]), &share.d_probability[cell * width], vectors,
                 &d_probability[k * width]);
  }
  return {share.posterior, OutputGradient(g, networks, d_probability)};
}

template CellShare<float> OutputGradientOfCells(const Options&, const Cells&, std::span<const float>, int,
                                                const IndexRange&);
template CellShare<double> OutputGradientOfCells(const Options&, const Cells&, std::span<const double>, int,
                                                 const IndexRange&);

}  // namespace cairn::landmark_learning
