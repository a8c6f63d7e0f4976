#include "coordinator/cli/common/failure.h"

namespace cairn::cli {

bool IsTheWorldsFault(const Status& status) {
  return status.code() == Code::kNoSpace || status.code() == Code::kIo;
}

void Throw(const Status& status) {
  if (IsTheWorldsFault(status)) throw WorldError(status.message());
  throw InputError(status.message());
}

}  // namespace cairn::cli
