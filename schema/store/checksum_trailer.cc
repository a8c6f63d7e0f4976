#include "schema/store/checksum_trailer.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include "schema/hash.h"
#include "schema/store/atomic_file.h"
#include "schema/store/encode.h"

namespace cairn::store {
namespace {

constexpr std::array<char, 8> kMagic{'C', 'A', 'I', 'R', 'N', 'S', 'U', 'M'};

std::array<std::byte, kTrailerBytes> TrailerOf(const Hasher& hasher) {
  std::array<std::byte, kTrailerBytes> trailer;
  const Hash hash = hasher.Finish();
  std::memcpy(trailer.data(), kMagic.data(), kMagic.size());
  std::memcpy(trailer.data() + kMagic.size(), hash.bytes.data(), hash.bytes.size());
  return trailer;
}

// Of the bytes before `end`. Returns errno, or 0.
int HashInto(const RegularFile& file, std::uint64_t end, Hasher* hasher) {
  std::vector<std::byte> part(std::size_t{1} << 18);
  for (std::uint64_t at = 0; at < end;) {
    const auto bytes = std::span(part).first(std::min<std::uint64_t>(part.size(), end - at));
    if (const int error = file.ReadAt(bytes, at)) return error;
    hasher->Add(bytes);
    at += bytes.size();
  }
  return 0;
}

Status Judge(const std::string& name, const std::array<std::byte, kTrailerBytes>& want,
             std::span<const std::byte> have) {
  if (std::memcmp(have.data(), kMagic.data(), kMagic.size()) != 0)
    return {Code::kCorrupt,
            name + ": damaged: it lacks the checksum trailer of a file that was written whole"};
  if (!std::ranges::equal(have, want))
    return {Code::kCorrupt, name + ": damaged: its bytes are not those that were written"};
  return Status::Ok();
}

Status TooShort(const std::string& name) {
  return {Code::kCorrupt, name + ": damaged: too short for a checksum trailer"};
}

// Whether it is as long as HDF5's part of it says, and the checksum trailer.
Status CheckLength(const RegularFile& file, const std::string& name) {
  std::array<std::byte, kHeadBytes> head{};
  const auto known = std::span(head).first(std::min<std::uint64_t>(head.size(), file.size()));
  const std::uint64_t end = file.ReadAt(known, 0) == 0 ? StatedEnd(known) : 0;
  if (end == 0 || file.size() >= end + kTrailerBytes || end > ~std::uint64_t{0} - kTrailerBytes)
    return Status::Ok();
  return {Code::kCorrupt, name + ": damaged: truncated: it has " + std::to_string(file.size()) + " of its " +
                              std::to_string(end + kTrailerBytes) + " bytes"};
}

}  // namespace

std::array<std::byte, kTrailerBytes> TrailerOf(std::span<const std::byte> bytes) {
  Hasher hasher;
  hasher.Add(bytes);
  return TrailerOf(hasher);
}

Status CheckTrailer(std::span<const std::byte> image, const std::string& name) {
  if (image.size() < kTrailerBytes) return TooShort(name);
  const std::size_t size = image.size() - kTrailerBytes;
  return Judge(name, TrailerOf(image.first(size)), image.subspan(size));
}

Status CheckTrailer(const RegularFile& file, const std::string& name) {
  if (file.size() < kTrailerBytes) return TooShort(name);
  const std::uint64_t end = file.size() - kTrailerBytes;
  Hasher hasher;
  if (const int error = HashInto(file, end, &hasher)) return SystemFailure(name, "cannot read", error);
  std::array<std::byte, kTrailerBytes> have;
  if (const int error = file.ReadAt(have, end)) return SystemFailure(name, "cannot read", error);
  const bool trailer = std::memcmp(have.data(), kMagic.data(), kMagic.size()) == 0;
  if (Status cut_off = trailer ? Status::Ok() : CheckLength(file, name); !cut_off.ok()) return cut_off;
  return Judge(name, TrailerOf(hasher), have);
}

Status CheckTrailer(const std::filesystem::path& path) {
  const Result<RegularFile> file = RegularFile::Open(path);
  return file.ok() ? CheckTrailer(file.value(), path.string()) : file.status();
}

int EndWithTrailer(const std::filesystem::path& path) {
  const Result<RegularFile> file = RegularFile::Open(path);
  if (!file.ok()) return EIO;
  std::array<std::byte, kHeadBytes> head{};
  if (const int error = file.value().ReadAt(head, 0)) return error;
  const std::uint64_t end = StatedEnd(head);
  CAIRN_DEMAND(end > 0 && end <= file.value().size(), "HDF5 made a file whose end cannot be found");
  Hasher hasher;
  if (const int error = HashInto(file.value(), end, &hasher)) return error;
  const std::array<std::byte, kTrailerBytes> trailer = TrailerOf(hasher);
  const int out = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (out < 0) return errno;
  errno = ENOSPC;  // where it is written in part
  const auto at = static_cast<off_t>(end);
  const bool done =
      ::ftruncate(out, at) == 0 && ::pwrite(out, trailer.data(), trailer.size(), at) == std::ssize(trailer);
  const int error = done ? 0 : errno;
  ::close(out);
  return error;
}

bool HasTrailer(const RegularFile& file) {
  std::array<std::byte, kMagic.size()> have;
  return file.size() >= kTrailerBytes && file.ReadAt(have, file.size() - kTrailerBytes) == 0 &&
         std::memcmp(have.data(), kMagic.data(), kMagic.size()) == 0;
}

bool HasTrailer(const std::filesystem::path& path) {
  const Result<RegularFile> file = RegularFile::Open(path);
  return file.ok() && HasTrailer(file.value());
}

}  // namespace cairn::store
