// A copy of a store, made while a coordinator may serve it: it takes no lock there and writes nothing. What a
// coordinator has written is whole or not there, and never changes; what is removed while it is copied is
// looked for again. The copy is a store at each moment, of each job its newest checkpoint with all that it
// names, and only gets newer: whoever ends in the middle leaves one that has some jobs as they were before.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "schema/error.h"

namespace cairn::coordinator {

struct BackupFacts {
  std::size_t jobs = 0;
  std::size_t files = 0;  // that were copied
  std::uint64_t bytes = 0;
  std::vector<std::string>
      damaged;  // what could not be copied, and why; of such a job the copy keeps what it had
};

// Makes `to`, a folder that is not there yet, is empty, or is an earlier copy of the same store, a copy of
// the store `from`. Jobs that were deleted there go from it. Each copied file is read again, and what it
// holds is checked; `check`: also what was copied before, which is copied anew where it is damaged.
// kNotFound: `from` is no store. kRefused: `to` is a store of its own or a copy of another, or lies in
// `from`; `from` has no job, but the copy has. Of `to` as StoreFolder::Open says, kNoSpace and kIo of its
// disk.
Result<BackupFacts> BackUp(const std::filesystem::path& from, const std::filesystem::path& to,
                           bool check = false);

// Makes `to` a store of the backup `from`. Where one was cut off, the same again goes on with it; until that
// is done nobody serves it (kRestoreOf in folder.h).
// kNotFound: `from` is no store. kRefused: `to` holds anything but a restore of `from` that was cut off. Else
// as BackUp says.
Result<BackupFacts> RestoreStore(const std::filesystem::path& from, const std::filesystem::path& to);

// In each copy: of which store it is.
inline constexpr const char* kBackupOf = "backup-of";
// In a copy that was made to its end. Gone while another is made over it.
inline constexpr const char* kBackupMark = "backup-is-whole";

}  // namespace cairn::coordinator
