#include "coordinator/cli/output/pages.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <span>
#include <sstream>

#include "coordinator/cli/common/failure.h"
#include "schema/hash.h"
#include "schema/store/atomic_file.h"
#include "schema/store/regular_file.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

fs::path RecordOf(const std::string& dir) { return fs::path(dir) / ".cairn-pages"; }

// Within `dir`.
std::vector<std::string> PagesOf(const std::vector<std::string>& stages) {
  std::vector<std::string> pages;
  for (const char* page : {"map.png", "picture.png", "report.html"}) {
    pages.emplace_back(page);
    for (const std::string& stage : stages) pages.push_back(stage + "/" + page);
  }
  return pages;
}

// Empty where there is none that can be read.
std::string HashOfFile(const fs::path& path) {
  const Result<RegularFile> file = RegularFile::Open(path);
  if (!file.ok()) return "";
  constexpr std::uint64_t kPart = 1 << 20;
  std::vector<std::byte> part(kPart);
  Hasher hasher;
  for (std::uint64_t at = 0; at < file.value().size(); at += kPart) {
    const std::span<std::byte> bytes(part.data(), std::min(kPart, file.value().size() - at));
    if (file.value().ReadAt(bytes, at) != 0) return "";
    hasher.Add(std::span<const std::byte>(bytes));
  }
  return hasher.Finish().Hex();
}

// Name -> hash. A record that is damaged says too little, never too much.
std::map<std::string, std::string> ReadRecord(const std::string& dir) {
  constexpr std::size_t kMostBytes = 1 << 20;
  std::map<std::string, std::string> hashes;
  const Result<std::string> text = ReadSmallFile(RecordOf(dir), kMostBytes);
  if (!text.ok()) return hashes;
  std::istringstream record(text.value());
  for (std::string hash, name; record >> hash >> name;) hashes[name] = hash;
  return hashes;
}

void WriteRecord(const std::string& dir, const std::map<std::string, std::string>& hashes) {
  std::string lines;
  for (const auto& [page, hash] : hashes) lines += hash + " " + page + "\n";
  Check(WriteTextAtomically(RecordOf(dir), lines));
}

}  // namespace

void CheckPagesAreOurs(const std::string& dir, const std::vector<std::string>& stages) {
  const bool from_before = !fs::exists(RecordOf(dir)) && fs::is_directory(fs::path(dir) / ".cairn");
  if (from_before) return;  // a run of a version that kept no record
  const std::map<std::string, std::string> known = ReadRecord(dir);
  for (const std::string& page : PagesOf(stages)) {
    const fs::path path = fs::path(dir) / page;
    if (!fs::exists(fs::symlink_status(path))) continue;
    const auto hash = known.find(page);
    if (hash == known.end() || hash->second != HashOfFile(path))
      throw InputError(
          "'" + path.string() +
          "' is there already, and is not what cairn wrote here: move it away, or say --force to "
          "have it replaced");
  }
}

void RememberPages(const std::string& dir, const std::vector<std::string>& stages) {
  std::map<std::string, std::string> hashes;
  for (const std::string& page : PagesOf(stages))
    if (const std::string hash = HashOfFile(fs::path(dir) / page); !hash.empty()) hashes[page] = hash;
  if (!hashes.empty()) WriteRecord(dir, hashes);
}

void RememberPage(const std::string& path) {
  const std::string dir = fs::absolute(path).parent_path().string();
  if (!fs::exists(RecordOf(dir))) return;
  std::map<std::string, std::string> hashes = ReadRecord(dir);
  hashes[fs::path(path).filename().string()] = HashOfFile(path);
  WriteRecord(dir, hashes);
}

void CheckFolderIsFree(const std::string& folder, bool force) {
  if (force || !fs::is_directory(folder) || fs::is_empty(folder)) return;
  if (!fs::is_directory(fs::path(folder) / "results"))
    throw InputError("'" + folder +
                     "' holds files of something else; name a new folder (--force writes there)");
}

}  // namespace cairn::cli
