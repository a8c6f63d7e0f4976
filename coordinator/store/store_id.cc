#include "coordinator/store/store_id.h"

#include <algorithm>
#include <random>
#include <sstream>

#include "schema/store/atomic_file.h"
#include "schema/store/regular_file.h"

namespace cairn::coordinator {
namespace {

constexpr std::size_t kMostIdBytes = 1 << 13;
constexpr std::size_t kIdDigits = 32;
constexpr const char* kWasNew = "new";
constexpr const char* kIdAlphabet = "0123456789abcdef";

std::string NextId(std::istream& lines) {
  std::string line;
  std::getline(lines, line);
  const bool is_id = line.size() == kIdDigits && line.find_first_not_of(kIdAlphabet) == std::string::npos;
  return is_id ? line : "";
}

}  // namespace

std::string NewId() {
  std::random_device device;
  std::string id(kIdDigits, '0');
  for (char& digit : id) digit = kIdAlphabet[device() % 16];
  return id;
}

Result<StoreId> ReadStoreId(const std::filesystem::path& path) {
  const Result<std::string> text = ReadSmallFile(path, kMostIdBytes);
  if (text.status().code() == Code::kNotFound || text.status().code() == Code::kCorrupt) return StoreId{};
  if (!text.ok()) return text.status();
  std::istringstream lines(text.value());
  StoreId id;
  id.id = NextId(lines);
  id.restored_from = NextId(lines);
  std::string last;
  std::getline(lines, last);
  id.was_new = last == kWasNew;
  return id;
}

Status WriteStoreId(const std::filesystem::path& path, const StoreId& id) {
  return WriteTextAtomically(path,
                             id.id + "\n" + id.restored_from + "\n" + (id.was_new ? kWasNew : "") + "\n");
}

Result<BackupOf> ReadBackupOf(const std::filesystem::path& path) {
  const Result<std::string> text = ReadSmallFile(path, kMostIdBytes);
  if (!text.ok()) return text.status();
  std::istringstream lines(text.value());
  BackupOf of;
  std::getline(lines, of.store);
  of.id = NextId(lines);
  of.stamp = NextId(lines);
  return of;
}

Status WriteBackupOf(const std::filesystem::path& path, const BackupOf& of) {
  return WriteTextAtomically(path, of.store + "\n" + of.id + "\n" + of.stamp + "\n");
}

}  // namespace cairn::coordinator
