// Options of image_features, each with unit, range and effect.
#pragma once

#include <cstdint>

#include "pipelines/common/options.h"

namespace cairn::image_features {

struct Options {
  std::int64_t bands = 10;  // [Thr98] 5.1.3, as are the others
  std::int64_t texture_rows = 60;
  std::int64_t texture_columns = 64;
};

template <class V>
void VisitOptions(V& visit, Options& o) {
  visit(Option{"bands", "", 1, 100, "rows, and columns, that an image is cut into; each gives 7 inputs"},
        o.bands);
  visit(Option{"texture_rows", "pixels", 2, 10000, "texture is that of an image of so many rows at most"},
        o.texture_rows);
  visit(Option{"texture_columns", "pixels", 2, 10000, "and of so many columns"}, o.texture_columns);
}

}  // namespace cairn::image_features
