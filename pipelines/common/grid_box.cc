#include "pipelines/common/grid_box.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "pipelines/common/options.h"
#include "schema/error.h"

namespace cairn {
namespace {

std::string Number(double value) { return fmt::format("{:.4g}", value); }

}  // namespace

void Extent::Grow(double margin_m) {
  x0_ -= margin_m;
  y0_ -= margin_m;
  x1_ += margin_m;
  y1_ += margin_m;
}

GridBox Extent::ToGrid(double cell_m, double most_cells) const {
  const double columns = std::floor(x1_ / cell_m) - std::floor(x0_ / cell_m) + 1;
  const double rows = std::floor(y1_ / cell_m) - std::floor(y0_ / cell_m) + 1;
  if (!(columns * rows <= most_cells)) {
    throw InputError("a map of " + Number(x1_ - x0_) + " by " + Number(y1_ - y0_) + " m has " +
                     Number(columns * rows) + " cells of " + Number(cell_m) + " m, and memory_mb allows " +
                     Number(most_cells) + ": make cell_m larger, box_m smaller, or allow more");
  }
  return {std::floor(x0_ / cell_m) * cell_m, std::floor(y0_ / cell_m) * cell_m, cell_m,
          static_cast<std::int64_t>(columns), static_cast<std::int64_t>(rows)};
}

Extent ParseExtent(const std::string& option, const std::string& text) {
  std::vector<double> values;
  for (const std::string& part : ByCommas(text)) {
    std::size_t used = 0;
    double value = std::nan("");
    try {
      value = std::stod(part, &used);
    } catch (const std::exception&) {
      used = 0;
    }
    if (used != part.size() || !std::isfinite(value))
      throw InputError("option '" + option + "': '" + part + "' is not a number");
    values.push_back(value);
  }
  if (values.size() != 4 || values[0] >= values[2] || values[1] >= values[3]) {
    throw InputError("option '" + option +
                     "' is 'x0,y0,x1,y1' in metres, the lower left and the upper right corner; it is '" +
                     text + "'");
  }
  Extent extent;
  extent.Add(values[0], values[1]);
  extent.Add(values[2], values[3]);
  return extent;
}

}  // namespace cairn
