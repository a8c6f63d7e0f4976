// What range sensors' drivers write where nothing came back: 0, or always the same large reading. Taken for
// what was met, they are walls at the sensor, or all around it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/kinds/log.h"
#include "schema/walked.h"

namespace cairn::datasets {

struct ConstantReading {
  double range_m = 0;
  double share = 0;  // of the readings that are numbers
};

// The reading at or near the largest that has an implausible share of all: more than one in twenty, from
// many beams, and hardly another one about as large. A sensor of coarse steps has none: what it meets far
// away has many distances. `range_m`: a row of `beams` for each scan; NaN says nothing.
std::optional<ConstantReading> FindConstantReading(const Walked<double>& range_m, std::size_t beams);

// A warning a sensor with one that is below the reach that the log states. Forgives what is missing.
std::vector<std::string> ConstantReadingsOf(const Blob& log);

// A sentence a sensor of which more than one in a thousand readings are exactly 0: there is nothing to be
// taken for. Fewer are a sensor's own, and do no harm.
std::vector<std::string> ZeroReadingsOf(const kinds::Log& log);

}  // namespace cairn::datasets
