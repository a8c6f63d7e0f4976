#include "pipelines/forward_map/dynamic.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cairn::forward_map {

// [Thr01] figures 4 and 5 show dots of who walked by: by how much such a cell explains readings better than a
// wall
double CameAndWentNats(const FlipGains& gains, const std::vector<double>& time_s, std::int32_t cell) {
  const std::vector<FlipGains::Look> looks = gains.LooksAt(cell);
  double first_s = std::numeric_limits<double>::infinity(), last_s = -first_s, caught = 0;
  for (const FlipGains::Look& look : looks) {
    caught += look.caught;
    if (look.caught <= 0.5) continue;
    first_s = std::min(first_s, time_s[look.reading]);
    last_s = std::max(last_s, time_s[look.reading]);
  }
  if (first_s > last_s) return 0;
  double missed = 0, nats = 0;
  for (const FlipGains::Look& look : looks) {
    const double at_s = time_s[look.reading];
    if (at_s >= first_s && at_s <= last_s) continue;
    missed += look.missed;
    nats -= look.missed * std::log(gains.MissProbability(look.reading));
  }
  return missed >= 2 * caught ? nats : 0;
}

}  // namespace cairn::forward_map
