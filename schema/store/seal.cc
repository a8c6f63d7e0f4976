#include "schema/store/seal.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "schema/hash.h"
#include "schema/store/atomic_file.h"
#include "schema/store/encode.h"

namespace cairn::store {
namespace {

constexpr std::array<char, 8> kMagic{'C', 'A', 'I', 'R', 'N', 'S', 'U', 'M'};

std::array<std::byte, kSealBytes> SealOf(const Hasher& hasher) {
  std::array<std::byte, kSealBytes> seal;
  const Hash hash = hasher.Finish();
  std::memcpy(seal.data(), kMagic.data(), kMagic.size());
  std::memcpy(seal.data() + kMagic.size(), hash.bytes.data(), hash.bytes.size());
  return seal;
}

Status Judge(const std::string& name, const std::array<std::byte, kSealBytes>& want,
             std::span<const std::byte> have) {
  if (std::memcmp(have.data(), kMagic.data(), kMagic.size()) != 0)
    return {Code::kCorrupt, name + ": damaged: it lacks the seal of a file that was written whole"};
  if (!std::ranges::equal(have, want))
    return {Code::kCorrupt, name + ": damaged: its bytes are not those that were written"};
  return Status::Ok();
}

Status TooShort(const std::string& name) {
  return {Code::kCorrupt, name + ": damaged: too short for a seal"};
}

// Whether it is as long as HDF5's part of it says, and the seal.
Status CheckLength(const RegularFile& file, const std::string& name) {
  std::array<std::byte, kHeadBytes> head{};
  const auto known = std::span(head).first(std::min<std::uint64_t>(head.size(), file.size()));
  const std::uint64_t end = file.ReadAt(known, 0) == 0 ? StatedEnd(known) : 0;
  if (end == 0 || file.size() >= end + kSealBytes || end > ~std::uint64_t{0} - kSealBytes)
    return Status::Ok();
  return {Code::kCorrupt, name + ": damaged: truncated: it has " + std::to_string(file.size()) + " of its " +
                              std::to_string(end + kSealBytes) + " bytes"};
}

}  // namespace

std::array<std::byte, kSealBytes> SealOf(std::span<const std::byte> bytes) {
  Hasher hasher;
  hasher.Add(bytes);
  return SealOf(hasher);
}

Status CheckSeal(std::span<const std::byte> image, const std::string& name) {
  if (image.size() < kSealBytes) return TooShort(name);
  const std::size_t size = image.size() - kSealBytes;
  return Judge(name, SealOf(image.first(size)), image.subspan(size));
}

Status CheckSeal(const RegularFile& file, const std::string& name) {
  if (file.size() < kSealBytes) return TooShort(name);
  const std::uint64_t end = file.size() - kSealBytes;
  Hasher hasher;
  std::vector<std::byte> part(std::size_t{1} << 18);
  for (std::uint64_t at = 0; at < end;) {
    const auto count = std::min<std::uint64_t>(part.size(), end - at);
    if (const int error = file.ReadAt(std::span(part).first(count), at))
      return SystemFailure(name, "cannot read", error);
    hasher.Add(std::span<const std::byte>(part).first(count));
    at += count;
  }
  std::array<std::byte, kSealBytes> have;
  if (const int error = file.ReadAt(have, end)) return SystemFailure(name, "cannot read", error);
  const bool sealed = std::memcmp(have.data(), kMagic.data(), kMagic.size()) == 0;
  if (Status cut_off = sealed ? Status::Ok() : CheckLength(file, name); !cut_off.ok()) return cut_off;
  return Judge(name, SealOf(hasher), have);
}

Status CheckSeal(const std::filesystem::path& path) {
  const Result<RegularFile> file = RegularFile::Open(path);
  return file.ok() ? CheckSeal(file.value(), path.string()) : file.status();
}

bool HasSeal(const RegularFile& file) {
  std::array<std::byte, kMagic.size()> have;
  return file.size() >= kSealBytes && file.ReadAt(have, file.size() - kSealBytes) == 0 &&
         std::memcmp(have.data(), kMagic.data(), kMagic.size()) == 0;
}

bool HasSeal(const std::filesystem::path& path) {
  const Result<RegularFile> file = RegularFile::Open(path);
  return file.ok() && HasSeal(file.value());
}

}  // namespace cairn::store
