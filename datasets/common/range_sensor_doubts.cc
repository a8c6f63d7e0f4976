#include "datasets/common/range_sensor_doubts.h"

#include "datasets/common/range_doubts.h"
#include "datasets/common/ring_turn_doubts.h"
#include "datasets/common/stuck_beams.h"

namespace cairn::datasets {

std::vector<std::string> RangeSensorDoubtsOf(const Blob& log) {
  std::vector<std::string> all;
  for (const auto& doubts : {ConstantReadingsOf(log), StuckBeamsOf(log), RingTurnDoubtsOf(log)})
    all.insert(all.end(), doubts.begin(), doubts.end());
  return all;
}

}  // namespace cairn::datasets
