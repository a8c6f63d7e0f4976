#include "pipelines/landmark_learning/data/error_table.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>

#include "pipelines/landmark_learning/data/free_cells.h"

namespace cairn::landmark_learning {
namespace {

void CheckTableSize(std::int64_t rows, const char* what) {
  if (rows > kMostTableRows)
    throw InputError(std::string(what) + ": " + std::to_string(rows) +
                     " positions; allowed: " + std::to_string(kMostTableRows) + " at most");
}

std::size_t Nearest(double x_m, double y_m, std::span<const double> xs, std::span<const double> ys) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < xs.size(); ++p) {
    const double dx = xs[p] - x_m, dy = ys[p] - y_m, square = dx * dx + dy * dy;
    if (square >= least) continue;
    least = square;
    nearest = p;
  }
  return nearest;
}

// Calls f(set, sample) for the samples of both sets.
template <class F>
void ForEachSample(TrainingData* data, const F& f) {
  for (SampleSet* set : {&data->training, &data->held_out}) {
    set->positions.row.resize(static_cast<std::size_t>(set->size()));
    for (std::size_t k = 0; k < set->positions.row.size(); ++k) f(*set, k);
  }
}

void PutTable(const Array& table, TrainingData* data) {
  data->training.positions.table = table;
  data->held_out.positions.table = table;
}

std::string NameOf(const TrainingData& data, const SampleSet& set, std::size_t k) {
  return fmt::format("run '{}', the sample at ({:.3f}, {:.3f}) m",
                     data.runs[static_cast<std::size_t>(set.run[k])], set.positions.x_m[k],
                     set.positions.y_m[k]);
}

}  // namespace

void AttachTable(const Blob& errors, TrainingData* data) {
  if (!errors.Has("error")) throw InputError("the input 'errors': no table in it ('error' is missing)");
  const auto x = errors.Get<double>("position/x_m"), y = errors.Get<double>("position/y_m");
  const auto values = errors.Get<double>("error");
  const auto rows = static_cast<std::int64_t>(x.size());
  if (rows == 0) throw InputError("the input 'errors': there are no positions in it");
  CheckTableSize(rows, "the input 'errors'");
  // [Thr98] section 3.1: any e
  const std::vector<float> table(values.begin(), values.end());
  ForEachSample(data, [&](SampleSet& set, std::size_t k) {
    set.positions.row[k] =
        static_cast<std::int32_t>(Nearest(set.positions.x_m[k], set.positions.y_m[k], x, y));
  });
  PutTable(Array::Of<float>({rows, rows}, table), data);
}

void AttachTravel(const Blob& map, TrainingData* data) {
  const FreeCells cells = FreeCells::Of(map);
  std::map<std::size_t, std::int32_t> row_of;  // cell -> row
  std::vector<std::size_t> cell_of;            // the reverse
  std::vector<std::string> name_of;            // the first sample of each
  ForEachSample(data, [&](SampleSet& set, std::size_t k) {
    const auto cell = cells.At(set.positions.x_m[k], set.positions.y_m[k]);
    if (!cell) throw InputError(NameOf(*data, set, k) + ": it lies in no free cell of the map");
    const auto [position, is_new] = row_of.try_emplace(*cell, static_cast<std::int32_t>(cell_of.size()));
    if (is_new) {
      cell_of.push_back(*cell);
      name_of.push_back(NameOf(*data, set, k));
    }
    set.positions.row[k] = position->second;
  });
  const auto rows = static_cast<std::int64_t>(cell_of.size());
  CheckTableSize(rows, "the map has too small cells for so many samples");
  std::vector<float> table;
  for (std::size_t from = 0; from < cell_of.size(); ++from) {
    const std::vector<double> paths_m = cells.PathLengthsFrom(cell_of[from]);
    for (std::size_t to = 0; to < cell_of.size(); ++to) {
      if (std::isinf(paths_m[cell_of[to]]))
        throw InputError(name_of[to] + ": no way leads there through the map from " + name_of[from]);
      // [Thr98] section 5.1.5: e is the way that a robot must travel.
      table.push_back(static_cast<float>(paths_m[cell_of[to]]));
    }
  }
  PutTable(Array::Of<float>({rows, rows}, table), data);
}

}  // namespace cairn::landmark_learning
