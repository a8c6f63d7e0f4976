#include "schema/wire/shared_blobs.h"

#include <fcntl.h>
#include <google/protobuf/stubs/logging.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

namespace cairn::wire {
namespace {

// As it lies there: the index's length in eight bytes, the index, and each array at the next multiple of 64.
using Length = std::uint64_t;
constexpr std::size_t kAlignment = 64;
constexpr int kSeals = F_SEAL_WRITE | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;

std::size_t Padding(std::size_t at) { return (kAlignment - at % kAlignment) % kAlignment; }

Status Failure(const std::string& doing, int error) {
  return {error == ENOSPC || error == ENOMEM || error == EFBIG ? Code::kNoSpace : Code::kIo,
          "shared memory: " + doing + ": " + std::strerror(error)};
}

Status CorruptMemory(const std::string& why) { return {Code::kCorrupt, "shared memory: " + why}; }

// Appends to a file, and remembers how long it is.
class Writer {
 public:
  explicit Writer(int fd) : fd_(fd) {}
  int error() const { return error_; }
  void Put(std::span<const std::byte> bytes) {
    while (error_ == 0 && !bytes.empty()) {
      constexpr std::size_t kAtOnce = std::size_t{1} << 30;  // Linux writes at most 2 GiB a call
      const ssize_t count = ::write(fd_, bytes.data(), std::min(bytes.size(), kAtOnce));
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) {
        error_ = count < 0 ? errno : EIO;
        return;
      }
      at_ += static_cast<std::size_t>(count);
      bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
  }
  void Align() {
    static constexpr std::array<std::byte, kAlignment> kZeros{};
    Put(std::span(kZeros).first(Padding(at_)));
  }

 private:
  int fd_;
  std::size_t at_ = 0;
  int error_ = 0;
};

// What is left of the mapped bytes, from its beginning on.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> all) : all_(all) {}
  // None where fewer are left.
  std::optional<std::span<const std::byte>> Take(std::uint64_t bytes) {
    if (bytes > all_.size() - at_) return std::nullopt;
    const auto taken = all_.subspan(at_, static_cast<std::size_t>(bytes));
    at_ += taken.size();
    return taken;
  }
  std::optional<std::span<const std::byte>> TakeAligned(std::uint64_t bytes) {
    return Take(Padding(at_)) ? Take(bytes) : std::nullopt;
  }

 private:
  std::span<const std::byte> all_;
  std::size_t at_ = 0;
};

struct Mapping {
  std::shared_ptr<const void> owner;
  std::span<const std::byte> bytes;
};

Result<Mapping> Map(const SharedMemory& memory) {
  // Else whoever wrote it could change it, or cut it off, under the reader.
  if ((::fcntl(memory.descriptor(), F_GET_SEALS) & kSeals) != kSeals) return CorruptMemory("not sealed");
  struct stat info{};
  if (::fstat(memory.descriptor(), &info) != 0) return Failure("cannot look at it", errno);
  const auto size = static_cast<std::size_t>(info.st_size);
  if (size == 0) return CorruptMemory("empty");
  void* begin = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, memory.descriptor(), 0);
  if (begin == MAP_FAILED) return Failure("cannot map it", errno);
  std::shared_ptr<const void> owner(begin, [size](void* p) { ::munmap(p, size); });
  return Mapping{std::move(owner), {static_cast<const std::byte*>(begin), size}};
}

Result<wire::SharedBlobs> ReadIndex(Reader& reader) {
  const auto head = reader.Take(sizeof(Length));
  if (!head) return CorruptMemory("too short");
  Length length = 0;
  std::memcpy(&length, head->data(), sizeof length);
  const auto bytes = reader.Take(std::min<Length>(length, Limits().envelope_bytes));
  const google::protobuf::LogSilencer quiet;
  wire::SharedBlobs index;
  if (!bytes || bytes->size() != length ||
      !index.ParseFromArray(bytes->data(), static_cast<int>(bytes->size())))
    return CorruptMemory("its index cannot be read");
  return index;
}

}  // namespace

SharedMemory::SharedMemory(SharedMemory&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
SharedMemory& SharedMemory::operator=(SharedMemory&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}
SharedMemory::~SharedMemory() {
  if (fd_ >= 0) ::close(fd_);
}

Result<SharedMemory> ShareBlobs(std::span<const NamedBlob> blobs) {
  wire::SharedBlobs index;
  for (const NamedBlob& named : blobs) {
    *index.add_blobs() = MetaOf(named);
    for (const auto& [name, array] : named.blob->fields()) index.add_array_bytes(array.bytes().size());
  }
  const std::string head = index.SerializeAsString();
  const Length length = head.size();
  SharedMemory memory(::memfd_create("cairn-inputs", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (memory.descriptor() < 0) return Failure("cannot make any", errno);
  Writer writer(memory.descriptor());
  writer.Put(std::as_bytes(std::span(&length, 1)));
  writer.Put(std::as_bytes(std::span(head)));
  for (const NamedBlob& named : blobs) {
    for (const auto& [name, array] : named.blob->fields()) {
      writer.Align();
      writer.Put(array.bytes());
    }
  }
  if (writer.error() != 0) return Failure("cannot write", writer.error());
  if (::fcntl(memory.descriptor(), F_ADD_SEALS, kSeals) != 0) return Failure("cannot seal it", errno);
  return memory;
}

Result<std::vector<NamedBlob>> TakeSharedBlobs(int fd) {
  const SharedMemory memory(fd);
  const Result<Mapping> mapping = Map(memory);
  if (!mapping.ok()) return mapping.status();
  Reader reader(mapping.value().bytes);
  const Result<wire::SharedBlobs> index = ReadIndex(reader);
  if (!index.ok()) return index.status();
  std::vector<NamedBlob> blobs;
  int array = 0;
  for (const BlobMeta& meta : index.value().blobs()) {
    std::vector<std::span<const std::byte>> frames;
    for (int i = 0; i < meta.arrays_size(); ++i, ++array) {
      const auto frame = array < index.value().array_bytes_size()
                             ? reader.TakeAligned(index.value().array_bytes(array))
                             : std::nullopt;
      if (!frame) return CorruptMemory("shorter than its index says");
      frames.push_back(*frame);
    }
    Result<NamedBlob> blob = DecodeBlob(meta, frames, mapping.value().owner);
    if (!blob.ok()) return blob.status();
    blobs.push_back(std::move(blob).value());
  }
  if (array != index.value().array_bytes_size()) return CorruptMemory("its index names more than it holds");
  return blobs;
}

}  // namespace cairn::wire
