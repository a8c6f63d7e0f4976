// A store as a service has it.
#pragma once

#include <filesystem>

#include "coordinator/store/folder.h"

namespace cairn::coordinator {

inline Result<StoreFolder> OpenAndServe(const std::filesystem::path& dir, bool take_over) {
  Result<StoreFolder> folder = StoreFolder::OpenToServe(dir);
  if (!folder.ok()) return folder;
  if (Status served = folder.value().Serve(take_over); !served.ok()) return served;
  return folder;
}

}  // namespace cairn::coordinator
