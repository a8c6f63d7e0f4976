#include "schema/store/spooled_rows.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <new>

#include "schema/store/atomic_file.h"
#include "schema/store/spool.h"

namespace cairn {
namespace {

constexpr std::align_val_t kSpooledAlignment{64};

// So that writing to the mapping finds the room. Returns errno, or 0.
int TakeRoomFor(int fd, std::size_t from, std::size_t to) {
  int error = EINTR;
  while (error == EINTR)
    error = ::posix_fallocate(fd, static_cast<off_t>(from), static_cast<off_t>(to - from));
  return error;
}

}  // namespace

SpooledBytes::SpooledBytes(SpooledBytes&& other) noexcept { *this = std::move(other); }

SpooledBytes& SpooledBytes::operator=(SpooledBytes&& other) noexcept {
  std::swap(folder_, other.folder_);
  std::swap(data_, other.data_);
  std::swap(capacity_, other.capacity_);
  std::swap(fd_, other.fd_);
  return *this;
}

SpooledBytes::~SpooledBytes() { Free(); }

void SpooledBytes::Free() {
  if (fd_ >= 0) {
    ::munmap(data_, capacity_);
    ::close(fd_);
  } else {
    ::operator delete(data_, kSpooledAlignment);
  }
  data_ = nullptr;
  capacity_ = 0;
  fd_ = -1;
}

void SpooledBytes::Grow(std::size_t least, std::size_t used) {
  if (fd_ >= 0 || (!folder_.empty() && least > MappedBlocks::kBytes)) return GrowFile(least, used);
  constexpr std::size_t kFirst = 256;
  const std::size_t capacity = std::max({least, 2 * capacity_, kFirst});
  auto* data = static_cast<std::byte*>(::operator new(capacity, kSpooledAlignment));
  if (used > 0) std::memcpy(data, data_, used);
  ::operator delete(data_, kSpooledAlignment);
  data_ = data;
  capacity_ = capacity;
}

void SpooledBytes::GrowFile(std::size_t least, std::size_t used) {
  constexpr std::size_t kLeastStep = std::size_t{1} << 20, kMostStep = std::size_t{1} << 26;
  const bool is_new = fd_ < 0;
  const std::size_t had = is_new ? 0 : capacity_;
  const std::size_t capacity = std::max(least, had + std::clamp(had / 2, kLeastStep, kMostStep));
  int error = 0;
  const int fd = is_new ? OpenNamelessFile(folder_, &error) : fd_;
  if (error == 0) error = TakeRoomFor(fd, had, capacity);
  void* bytes = MAP_FAILED;
  if (error == 0) {
    bytes = is_new ? ::mmap(nullptr, capacity, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0)
                   : ::mremap(data_, capacity_, capacity, MREMAP_MAYMOVE);
    if (bytes == MAP_FAILED) error = errno;
  }
  if (error != 0) {
    if (is_new && fd >= 0) ::close(fd);
    throw NotStored{SystemFailure(folder_, "cannot write what is read", error)};
  }
  if (is_new && used > 0) std::memcpy(bytes, data_, used);
  if (is_new) ::operator delete(data_, kSpooledAlignment);
  data_ = static_cast<std::byte*>(bytes);
  capacity_ = capacity;
  fd_ = fd;
}

Array SpooledBytes::Take(DType type, std::size_t item_bytes, std::size_t used) {
  const Shape shape{static_cast<std::int64_t>(used / item_bytes)};
  if (used == 0) {
    Free();
    return Array::FromBytes(type, item_bytes, shape, {}).value();
  }
  const bool is_file = is_in_file();
  if (is_file) {
    LetGoOfMapped({data_, capacity_}, 0, capacity_);
    ::close(std::exchange(fd_, -1));
  }
  const std::size_t size = std::exchange(capacity_, 0);
  const std::shared_ptr<const std::byte> owner(
      std::exchange(data_, nullptr), [is_file, size](const std::byte* of) {
        if (is_file)
          ::munmap(const_cast<std::byte*>(of), size);
        else
          ::operator delete(const_cast<std::byte*>(of), kSpooledAlignment);
      });
  const std::span<const std::byte> bytes(owner.get(), used);
  Result<Array> array = is_file ? Array::OverFile(type, item_bytes, shape, bytes, owner)
                                : Array::Over(type, item_bytes, shape, bytes, owner);
  CAIRN_DEMAND(array.ok(), array.status().message());
  return std::move(array).value();
}

}  // namespace cairn
