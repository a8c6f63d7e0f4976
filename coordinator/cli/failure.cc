#include "coordinator/cli/failure.h"

namespace cairn::cli {

void Throw(const Status& status) {
  const bool worlds_fault = status.code() == Code::kNoSpace || status.code() == Code::kIo;
  if (worlds_fault) throw WorldError(status.message());
  throw InputError(status.message());
}

}  // namespace cairn::cli
