// What lies at the place of an SQLite file and beside it, looked at before SQLite is: it believes what it
// finds there. A rollback journal may name a file of anybody's (a super-journal), which SQLite then removes;
// on a FIFO it waits for ever.
#pragma once

#include <filesystem>
#include <vector>

#include "schema/error.h"

namespace cairn::coordinator::sqlite {

// Renames to FILE.damaged what SQLite must not see: what is no regular file, and a journal that names another
// file, or that lies beside a file in WAL mode, which has none. Gives the names that they had.
// kRefused: such a thing cannot be renamed.
Result<std::vector<std::filesystem::path>> QuarantineUnsafe(const std::filesystem::path& file);

}  // namespace cairn::coordinator::sqlite
