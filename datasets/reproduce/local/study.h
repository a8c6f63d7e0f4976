// What `cairn-reproduce local` runs: simulated offices and their local maps, for the figures of
// [DM98].
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/job.pb.h"

namespace cairn::datasets {

// Offices of one kind.
struct OfficeKind {
  std::string title;
  std::vector<std::string> logs;  // names of inputs; the result of one is its name + "_map"
};

struct LocalStudy {
  std::map<std::string, Blob> inputs;  // with truth
  proto::Job job;                      // its inputs by these names
  std::vector<OfficeKind> kinds;
};

// Of `seeds` seeds from `seed` on, ten minutes each: as it stands; with furniture that moves in between; with
// one more room, whose walls are turned.
LocalStudy MakeLocalStudy(std::uint64_t seed, int seeds);

}  // namespace cairn::datasets
