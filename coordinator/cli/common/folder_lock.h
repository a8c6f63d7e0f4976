// One command at a time in a folder.
#pragma once

#include <filesystem>
#include <string>

namespace cairn::cli {

// Waits until no other has it; where `busy` says what to tell who must not wait, throws InputError with that.
// Where a file system has no such locks (NFS), nobody waits.
// Throws WorldError where there is no folder that can be opened.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder, const std::string& busy = "");
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int fd_;
};

}  // namespace cairn::cli
