// Which store a folder is, whatever it is called: DIR/id, which a store gets when it is first served. Another
// store in the same place has another one, and so has a store that was made of a backup.
#pragma once

#include <filesystem>
#include <string>

#include "schema/error.h"

namespace cairn::coordinator {

std::string NewId();  // 32 random hexadecimal digits

struct StoreId {
  std::string id;             // empty: it has none
  std::string restored_from;  // BackupOf::stamp of the backup that it was made of; empty: of none, or unknown
  bool was_new = false;       // the store held nothing yet when it got its id
};
// Of a store without such a file, or whose file is damaged, one without an id. kRefused, kIo: nobody knows.
Result<StoreId> ReadStoreId(const std::filesystem::path& path);
Status WriteStoreId(const std::filesystem::path& path, const StoreId& id);

// What DIR/backup-of says, in a backup.
struct BackupOf {
  std::string store;  // where it was
  std::string id;     // empty: it had none, or the backup is of an earlier Cairn
  std::string stamp;  // another one each time that something is copied there
};
// As ReadSmallFile.
Result<BackupOf> ReadBackupOf(const std::filesystem::path& path);
Status WriteBackupOf(const std::filesystem::path& path, const BackupOf& of);

}  // namespace cairn::coordinator
