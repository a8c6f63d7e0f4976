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
// the store `from`, which it is by its id, or, where the copy has none, by its place. A store that was made
// of the copy as it stands goes on with it: from then on it is that one's. Jobs that were deleted there go
// from it; one whose checkpoints are lost there stays, and is named. Each copied file is read again, and what
// it holds is checked; `check`: also what was copied before, which is copied anew where it is damaged.
// kNotFound: `from` is no store. kRefused: `to` is a store of its own or a copy of another, or lies in
// `from`; `from` has the id of the store that `to` is of, which is still there; `from` has no id and no job,
// but the copy has. Of `to` as StoreFolder::Open says, kNoSpace and kIo of its disk.
Result<BackupFacts> BackUp(const std::filesystem::path& from, const std::filesystem::path& to,
                           bool check = false);

// Makes `to` a store of the backup `from`, with an id of its own: the one that the backup is of may yet come
// back. Where one was cut off, the same again goes on with it; until that is done nobody serves it
// (kRestoreOf in folder.h). kNotFound: `from` is no store. kRefused: `to` holds anything but a restore of
// `from` that was cut off. Else as BackUp says.
Result<BackupFacts> RestoreStore(const std::filesystem::path& from, const std::filesystem::path& to);

// In a copy that was made to its end. Gone while another is made over it.
inline constexpr const char* kBackupMark = "backup-is-whole";

}  // namespace cairn::coordinator
