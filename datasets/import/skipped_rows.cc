#include "datasets/import/skipped_rows.h"

#include "datasets/import/row_times.h"
#include "schema/error.h"

namespace cairn::datasets {

void SkippedRows::RequireHalf(const std::string& path, std::size_t good) const {
  std::string reasons;
  std::int64_t skipped = 0, backwards = 0;
  for (const auto& [reason, count] : bad_.counts()) {
    const auto before = before_.find(reason);
    const std::int64_t here = count - (before == before_.end() ? 0 : before->second);
    if (here == 0) continue;
    skipped += here;
    if (reason == "time runs backwards") backwards = here;
    reasons += (reasons.empty() ? "" : ", ") + reason + " (" + std::to_string(here) + ")";
  }
  const auto left = static_cast<std::int64_t>(good);
  if (left >= skipped) return;
  throw InputError(path + ": --skip-bad leaves " + (left == 0 ? "nothing" : std::to_string(left)) +
                   " of its " + std::to_string(left + skipped) + " rows" +
                   (left == 0 ? "" : ", less than half") + "; skipped: " + reasons +
                   (2 * backwards > skipped ? std::string("; ") + kSortRows : "") +
                   ". Without --skip-bad the first such row is named");
}

}  // namespace cairn::datasets
