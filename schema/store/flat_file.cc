#include "schema/store/flat_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <string>
#include <vector>

#include "schema/array_form.h"
#include "schema/store/atomic_file.h"
#include "schema/store/regular_file.h"

namespace cairn {
namespace {

namespace fs = std::filesystem;

// So many bytes are sent to the disk as soon as they are there: else all that the system has not written yet
// would be left for the sync, for which everybody waits.
constexpr std::uint64_t kStartBytes = 8 << 20;
constexpr std::size_t kPartBytes = 1 << 18;

Status AboutFile(const fs::path& path, const Status& status) {
  return status.ok() ? status : Status(status.code(), path.string() + ": " + status.message());
}

// Returns errno, or 0.
int WriteWhole(int fd, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(fd, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return count < 0 ? errno : EIO;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return 0;
}

// Takes a file into `check`, part by part: all of it, or what tells its arrays.
Status Feed(const RegularFile& file, const fs::path& path, bool head_alone, FlatCheck& check) {
  std::vector<std::byte> part(kPartBytes);
  for (std::uint64_t at = 0; at < file.size() && !(head_alone && check.meta() != nullptr);) {
    const auto bytes = std::span(part).first(std::min<std::uint64_t>(part.size(), file.size() - at));
    if (const int error = file.ReadAt(bytes, at)) return SystemFailure(path, "cannot read", error);
    if (Status good = check.Add(bytes); !good.ok()) return AboutFile(path, good);
    at += bytes.size();
  }
  return head_alone && check.meta() != nullptr ? Status::Ok() : AboutFile(path, check.Finish());
}

// Whether both can be read and have the same arrays; `check` has seen the head of the first. What a head says
// of arrays may be written in more than one way.
bool AreSame(const fs::path& path, const FlatCheck& check, const fs::path& other) {
  const Result<RegularFile> a = RegularFile::Open(path), b = RegularFile::Open(other);
  FlatCheck head(check.hash());
  if (!a.ok() || !b.ok() || !Feed(b.value(), other, true, head).ok()) return false;
  const std::uint64_t bytes = a.value().size() - check.head_bytes();
  if (b.value().size() - head.head_bytes() != bytes) return false;
  std::vector<std::byte> of_a(kPartBytes), of_b(kPartBytes);
  for (std::uint64_t at = 0; at < bytes; at += kPartBytes) {
    const auto count = std::min<std::uint64_t>(kPartBytes, bytes - at);
    const auto part_a = std::span(of_a).first(count), part_b = std::span(of_b).first(count);
    const bool read = a.value().ReadAt(part_a, check.head_bytes() + at) == 0 &&
                      b.value().ReadAt(part_b, head.head_bytes() + at) == 0;
    if (!read || !std::ranges::equal(part_a, part_b)) return false;
  }
  return true;
}

Result<Array> ReadArray(const RegularFile& file, const fs::path& path, const wire::ArrayMeta& meta,
                        std::uint64_t at) {
  const Shape shape(meta.shape().begin(), meta.shape().end());
  const auto type = static_cast<DType>(meta.type());
  const Result<std::size_t> size = BytesOfArray(type, meta.item_bytes(), shape);
  if (!size.ok()) return AboutFile(path, size.status());
  if (at > file.size() || size.value() > file.size() - at)
    return Status(Code::kCorrupt, path.string() + ": not a flat blob: truncated");
  const std::shared_ptr<std::byte> bytes = AlignedBytes(size.value());
  const std::span<std::byte> all(bytes.get(), size.value());
  if (const int error = file.ReadAt(all, at)) return SystemFailure(path, "cannot read", error);
  return Array::Over(type, meta.item_bytes(), shape, all, bytes);
}

}  // namespace

Result<FlatFileWriter> FlatFileWriter::Create(const fs::path& temporary, const Hash& hash) {
  const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd < 0) return SystemFailure(temporary, "cannot write", errno);
  return FlatFileWriter(temporary, fd, hash);
}

FlatFileWriter::FlatFileWriter(FlatFileWriter&& other) noexcept
    : temporary_(std::exchange(other.temporary_, {})),
      fd_(std::exchange(other.fd_, -1)),
      check_(std::move(other.check_)),
      chunks_(std::move(other.chunks_)),
      written_(other.written_),
      started_(other.started_) {}

FlatFileWriter::~FlatFileWriter() {
  if (fd_ >= 0) ::close(fd_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

Status FlatFileWriter::Write(std::span<const std::byte> bytes) {
  if (Status good = check_->Add(bytes); !good.ok()) return good;
  chunks_.Add(bytes);
  if (const int error = WriteWhole(fd_, bytes)) return SystemFailure(temporary_, "cannot write", error);
  written_ += bytes.size();
  if (written_ - started_ < kStartBytes) return Status::Ok();
  // Where it cannot be begun, the sync does it all.
  ::sync_file_range(fd_, static_cast<off_t>(started_), static_cast<off_t>(written_ - started_),
                    SYNC_FILE_RANGE_WRITE);
  started_ = written_;
  return Status::Ok();
}

Status FlatFileWriter::Publish(const fs::path& path) {
  if (Status whole = check_->Finish(); !whole.ok()) return whole;
  std::error_code none;
  if (fs::exists(path, none)) {
    if (AreSame(temporary_, *check_, path)) return Status::Ok();
    if (CheckFlatFile(path, check_->hash()).ok())
      return {Code::kCorrupt, "another blob of this hash is there, of other content"};
  }
  if (::fsync(fd_) != 0) return SystemFailure(temporary_, "cannot write", errno);
  if (::close(std::exchange(fd_, -1)) != 0) return SystemFailure(temporary_, "cannot write", errno);
  if (::rename(temporary_.c_str(), path.c_str()) != 0) return SystemFailure(path, "cannot write", errno);
  temporary_.clear();
  Status synced = SyncFolder(path.parent_path());
  if (!synced.ok()) ::unlink(path.c_str());
  return synced;
}

FlatParts FlatFileWriter::TakeParts(const fs::path& path) {
  return {path, *check_, written_, std::move(chunks_)};
}

Result<BlobPtr> ReadFlatFile(const fs::path& path, const Hash& hash) {
  const Result<RegularFile> file = RegularFile::Open(path);
  if (!file.ok()) return file.status();
  FlatCheck head(hash);
  if (Status good = Feed(file.value(), path, true, head); !good.ok()) return good;
  Blob::Fields fields;
  std::uint64_t at = head.head_bytes();
  for (const wire::ArrayMeta& meta : head.meta()->arrays()) {
    Result<Array> array = ReadArray(file.value(), path, meta, at);
    if (!array.ok()) return array.status();
    at += array.value().bytes().size();
    fields.emplace(meta.name(), std::move(array).value());
  }
  auto blob = std::make_shared<const Blob>(std::move(fields));
  if (at != file.value().size() || blob->ContentHash() != hash)
    return Status(Code::kCorrupt, path.string() + ": its content is another than its name says");
  return BlobPtr(std::move(blob));
}

Status CheckFlatFile(const fs::path& path, const Hash& hash) {
  const Result<RegularFile> file = RegularFile::Open(path);
  if (!file.ok()) return file.status();
  FlatCheck check(hash);
  return Feed(file.value(), path, false, check);
}

}  // namespace cairn
