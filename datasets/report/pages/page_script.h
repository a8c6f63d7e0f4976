// page.js, which every page ends with.
#pragma once

namespace cairn::datasets::report {

extern const char kPageScript[];

}  // namespace cairn::datasets::report
