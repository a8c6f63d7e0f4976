// The script that every page ends with: saving.js, map_shapes.js, map_viewer.js and page.js in one.
#pragma once

namespace cairn::datasets::report {

extern const char kPageScript[];

}  // namespace cairn::datasets::report
