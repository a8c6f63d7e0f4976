// Whether the job that is followed is still the same: another store, or one that was made of a backup, gives
// ids anew.
#pragma once

#include <string>

#include "schema/wire.pb.h"

namespace cairn::cli {

class SameJob {
 public:
  // Throws InputError where another has its id now. `info`: of an answer to `status` or `logs`.
  void Check(const wire::JobInfo& info);

 private:
  bool known_ = false;
  std::string mark_;
};

}  // namespace cairn::cli
