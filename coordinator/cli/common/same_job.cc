#include "coordinator/cli/common/same_job.h"

#include "schema/error.h"

namespace cairn::cli {

void SameJob::Check(const wire::JobInfo& info) {
  if (!known_) mark_ = info.mark();
  known_ = true;
  if (info.mark() != mark_)
    throw InputError(
        "job " + info.id() +
        " is another than before: the coordinator has another store now, or one that was made of "
        "a backup");
}

}  // namespace cairn::cli
