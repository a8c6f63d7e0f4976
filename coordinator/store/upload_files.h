// The files of inputs that are on their way into a store (core/uploads.h). For the thread that writes.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "coordinator/core/uploads.h"
#include "coordinator/store/folder.h"
#include "coordinator/store/use.h"
#include "schema/store/flat_file.h"

namespace cairn::coordinator {

class UploadFiles {
 public:
  UploadFiles(const StoreFolder& folder, StoreUse& use) : folder_(folder), use_(use) {}

  // Each fails as schema/store/flat_file.h says, and for good: what follows of the same upload fails too,
  // with the first reason. kNoSpace also by the store's limit.
  Status Do(const OpenUpload& open);
  Status Do(const WritePiece& piece);
  // Whole: its blob is durable. In any case nothing else is left of it.
  Status Do(const CloseUpload& close);

 private:
  struct File {
    std::optional<FlatFileWriter> writer;  // none: it has failed
    Status status;
  };
  const StoreFolder& folder_;
  StoreUse& use_;
  std::map<std::uint64_t, File> files_;  // by the upload's number
};

}  // namespace cairn::coordinator
