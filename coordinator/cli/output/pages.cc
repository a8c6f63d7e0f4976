#include "coordinator/cli/output/pages.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
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

std::string HashOfBytes(const std::string& bytes) {
  Hasher hasher;
  hasher.Add(std::as_bytes(std::span(bytes)));
  return hasher.Finish().Hex();
}

// What a folder's pages may be: of a page that is being replaced both the old and the new one.
struct Record {
  std::string job;  // empty: a record of a version that did not say
  std::map<std::string, std::set<std::string>> hashes = {};

  bool Knows(const std::string& page, const std::string& hash) const {
    const auto known = hashes.find(page);
    return known != hashes.end() && known->second.contains(hash);
  }
};

constexpr const char* kJob = "job";  // no page is called so

// A record that is damaged says too little, never too much.
Record ReadRecord(const std::string& dir) {
  constexpr std::size_t kMostBytes = 1 << 20;
  Record record;
  const Result<std::string> text = ReadSmallFile(RecordOf(dir), kMostBytes);
  if (!text.ok()) return record;
  std::istringstream lines(text.value());
  for (std::string hash, name; lines >> hash >> name;) {
    if (name == kJob)
      record.job = hash;
    else
      record.hashes[name].insert(hash);
  }
  return record;
}

void WriteRecord(const std::string& dir, const Record& record) {
  std::string lines;
  if (!record.job.empty()) lines += record.job + " " + kJob + "\n";
  for (const auto& [page, hashes] : record.hashes)
    for (const std::string& hash : hashes) lines += hash + " " + page + "\n";
  Check(WriteTextAtomically(RecordOf(dir), lines));
}

// Those of `known` that lie there as it says: what somebody has put in their place is none of ours.
Record StillThere(const std::string& dir, const Record& known) {
  Record there{known.job};
  for (const auto& [page, hashes] : known.hashes)
    if (const std::string hash = HashOfFile(fs::path(dir) / page); hashes.contains(hash))
      there.hashes[page] = {hash};
  return there;
}

}  // namespace

void CheckPagesAreOurs(const std::string& dir, const std::vector<std::string>& stages,
                       const std::optional<std::string>& job) {
  const bool is_runs_own = !job && fs::is_directory(fs::path(dir) / ".cairn");
  if (is_runs_own && !fs::exists(RecordOf(dir))) return;  // a run of a version that kept no record
  const Record known = ReadRecord(dir);
  const bool of_another = !is_runs_own && !known.job.empty() && job != known.job;
  for (const std::string& page : PagesOf(stages)) {
    const fs::path path = fs::path(dir) / page;
    if (!fs::exists(fs::symlink_status(path))) continue;
    if (!known.Knows(page, HashOfFile(path)))
      throw InputError(
          "'" + path.string() +
          "' is there already, and is not what cairn wrote here: move it away, or say --force to "
          "have it replaced");
    if (of_another)
      throw InputError("'" + path.string() +
                       "' is there already, and is of another job: name another folder, or say --force to "
                       "have it replaced");
  }
}

void WritePagesOf(const std::string& dir, const std::string& job, const std::vector<Page>& pages) {
  if (pages.empty()) return;
  std::set<fs::path> folders;
  for (const Page& page : pages) folders.insert((fs::path(dir) / page.name).parent_path());
  for (const fs::path& folder : folders) RemoveLeftovers(folder);
  Record written{job}, meanwhile = StillThere(dir, ReadRecord(dir));
  meanwhile.job = job;
  for (const Page& page : pages) {
    written.hashes[page.name] = {HashOfBytes(page.bytes)};
    meanwhile.hashes[page.name].merge(std::set(written.hashes[page.name]));
  }
  WriteRecord(dir, meanwhile);
  for (const Page& page : pages) Check(WriteTextAtomically(fs::path(dir) / page.name, page.bytes));
  WriteRecord(dir, written);
}

void WritePage(const std::string& path, const std::string& bytes) {
  const std::string dir = fs::absolute(path).parent_path().string();
  const bool is_kept = fs::exists(RecordOf(dir));
  if (is_kept) RemoveLeftovers(dir);
  Record record = StillThere(dir, ReadRecord(dir));
  std::set<std::string>& hashes = record.hashes[fs::path(path).filename().string()];
  hashes.insert(HashOfBytes(bytes));
  if (is_kept) WriteRecord(dir, record);
  Check(WriteTextAtomically(path, bytes));
  hashes = {HashOfBytes(bytes)};
  if (is_kept) WriteRecord(dir, record);
}

void TakeStudyFolder(const std::string& folder, bool force) {
  const fs::path mark = fs::path(folder) / ".cairn-study";
  if (!force && fs::is_directory(folder) && !fs::is_empty(folder) && !fs::is_regular_file(mark))
    throw InputError("'" + folder +
                     "' holds files of something else; name a new folder (--force writes there)");
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) Throw(SystemFailure(folder, "cannot make the folder", error.value()));
  if (!fs::exists(mark)) Check(WriteTextAtomically(mark, "cairn-reproduce writes here\n"));
}

}  // namespace cairn::cli
