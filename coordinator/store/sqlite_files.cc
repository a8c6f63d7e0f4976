#include "coordinator/store/sqlite_files.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string>

#include "coordinator/store/folder.h"
#include "schema/store/regular_file.h"

namespace cairn::coordinator::sqlite {
namespace {

namespace fs = std::filesystem;

bool IsThere(const fs::path& path) {
  std::error_code error;
  const fs::file_type type = fs::symlink_status(path, error).type();
  return type != fs::file_type::not_found && type != fs::file_type::none;
}

bool IsRegular(const fs::path& path) {
  std::error_code error;
  return fs::symlink_status(path, error).type() == fs::file_type::regular;
}

// https://sqlite.org/fileformat.html: one of the two versions of the format at byte 18 is 2.
bool IsInWalMode(const fs::path& path) {
  const Result<RegularFile> file = RegularFile::Open(path);
  std::array<std::byte, 2> versions{};
  return file.ok() && file.value().ReadAt(versions, 18) == 0 &&
         std::ranges::find(versions, std::byte{2}) != versions.end();
}

// Such a journal ends with the magic number with which all of them begin.
bool MayNameAnotherFile(const fs::path& journal) {
  constexpr std::array<unsigned char, 8> kMagic{0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7};
  const Result<RegularFile> file = RegularFile::Open(journal);
  if (!file.ok()) return true;
  std::array<std::byte, kMagic.size()> end{};
  if (file.value().size() < end.size()) return false;
  return file.value().ReadAt(end, file.value().size() - end.size()) != 0 ||
         std::ranges::equal(end, std::as_bytes(std::span(kMagic)));
}

}  // namespace

Result<std::vector<fs::path>> QuarantineUnsafe(const fs::path& file) {
  std::vector<fs::path> unsafe;
  for (const char* ending : {"", "-journal", "-wal", "-shm"})
    if (const fs::path path = file.string() + ending; IsThere(path) && !IsRegular(path))
      unsafe.push_back(path);
  const fs::path journal = file.string() + "-journal";
  if (IsRegular(journal) && (!IsRegular(file) || IsInWalMode(file) || MayNameAnotherFile(journal)))
    unsafe.push_back(journal);
  for (const fs::path& path : unsafe) {
    Quarantine(path);
    if (IsThere(path))
      return Status(Code::kRefused, path.string() + " is not read, and cannot be renamed: move it away");
  }
  return unsafe;
}

}  // namespace cairn::coordinator::sqlite
