// Files that are there whole or not at all: a temporary file in the same folder, fsync, rename, fsync of the
// folder.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "schema/error.h"

namespace cairn {

// Replaces `path` by `bytes`. On any failure nothing new is left behind, and a file that was there before
// stays as it was. The Status names the file and the cause: kNotFound (the folder), kNoSpace, kRefused, kIo.
// What is no file (IsNoFile) is not replaced: kRefused. A process that is killed in between leaves at most a
// hidden ".cairn-NAME.PID-N.tmp", which nothing reads.
Status WriteFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes);
// The same, but a file that is there already stays: kRefused. Of several that write it at once one does,
// where the file system can (FAT cannot); else the last one's stays.
Status WriteNewFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes);
Status WriteTextAtomically(const std::filesystem::path& path, std::string_view text);
// The same of what `fill` writes into the temporary file, which is there and empty.
Status WriteInPlaceAtomically(const std::filesystem::path& path, bool is_new,
                              const std::function<Status(const std::filesystem::path& temporary)>& fill);

// Who may do what with a file.
struct FileRights {
  uid_t owner;
  gid_t group;
  mode_t mode;
};
// The same; the new file has these rights before it stands in the old one's place. kRefused where this user
// may not give it them.
Status WriteTextAtomically(const std::filesystem::path& path, std::string_view text,
                           const FileRights& rights);

// There is a device, a pipe or a socket, perhaps by a link: a rename would put a file in its place.
bool IsNoFile(const std::filesystem::path& path);

// So that what was renamed or removed in it stays so.
Status SyncFolder(const std::filesystem::path& folder);

// The files that processes that are no more have left behind right in `folder` while they wrote, among them
// those whose number this process has. A file of the user's, of whatever name without "cairn", is none.
std::vector<std::filesystem::path> Leftovers(const std::filesystem::path& folder);
// Removes them. What cannot be removed stays.
void RemoveLeftovers(const std::filesystem::path& folder);
// Those alone that processes left behind while they wrote this file.
void RemoveLeftoversOf(const std::filesystem::path& file);

// Its disk has room for bytes, and for no more files (inodes).
bool HasNoRoomForFiles(const std::filesystem::path& folder);

// The Status for a failed system call on `path`: kNotFound; kNoSpace (also quotas and file size limits);
// kRefused: no place to write to (no right to, read-only, no name that a file may have); kIo.
Status SystemFailure(const std::filesystem::path& path, const std::string& doing, int error_number);

}  // namespace cairn
