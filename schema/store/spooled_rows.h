// Rows as they come, of which there may be more than the memory holds: where a folder is named they lie, but
// for few, in a file without a name there. They are read and written like a vector's, and most of them are
// not in memory as long as they are gone through in their order (schema/walked.h).
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "schema/array.h"
#include "schema/error.h"
#include "schema/walked.h"

namespace cairn {

// Thrown where the disk does not take what is read.
struct NotStored {
  Status status;
};

// The bytes of such rows, which begin at a multiple of 64.
class SpooledBytes {
 public:
  SpooledBytes() = default;
  explicit SpooledBytes(std::filesystem::path folder) : folder_(std::move(folder)) {}
  SpooledBytes(SpooledBytes&& other) noexcept;
  SpooledBytes& operator=(SpooledBytes&& other) noexcept;
  ~SpooledBytes();

  const std::filesystem::path& folder() const { return folder_; }
  std::byte* data() const { return data_; }
  std::size_t capacity() const { return capacity_; }
  bool is_in_file() const { return fd_ >= 0; }
  // Makes room for so many; the first `used` stay. Throws NotStored.
  void Grow(std::size_t least, std::size_t used);
  // An array of the first `used`, which are here no more.
  Array Take(DType type, std::size_t item_bytes, std::size_t used);

 private:
  void GrowFile(std::size_t least, std::size_t used);
  void Free();

  std::filesystem::path folder_;
  std::byte* data_ = nullptr;
  std::size_t capacity_ = 0;
  int fd_ = -1;
};

template <class T>
class SpooledRows {
  static_assert(std::is_trivially_copyable_v<T>, "rows are stored as their bytes");

 public:
  using value_type = T;
  SpooledRows() = default;
  explicit SpooledRows(std::filesystem::path folder) : bytes_(std::move(folder)) {}
  SpooledRows(const SpooledRows& other) : SpooledRows(other.folder()) {
    for (const T& row : other) push_back(row);
  }
  SpooledRows(SpooledRows&& other) noexcept
      : bytes_(std::move(other.bytes_)), size_(std::exchange(other.size_, 0)), blocks_(other.blocks_) {}
  SpooledRows& operator=(SpooledRows other) noexcept {
    bytes_ = std::move(other.bytes_);
    size_ = std::exchange(other.size_, 0);
    blocks_ = other.blocks_;
    return *this;
  }
  SpooledRows& operator=(const std::vector<T>& rows) {
    size_ = 0;
    for (const T& row : rows) push_back(row);
    return *this;
  }
  ~SpooledRows() = default;

  const std::filesystem::path& folder() const { return bytes_.folder(); }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  // A row's place may change when another is added.
  T& operator[](std::size_t i) { return *At(i); }
  const T& operator[](std::size_t i) const { return *At(i); }
  const T& front() const { return (*this)[0]; }
  const T& back() const { return (*this)[size_ - 1]; }
  auto begin() { return PlaceIn<SpooledRows, T>(this, 0); }
  auto end() { return PlaceIn<SpooledRows, T>(this, size_); }
  auto begin() const { return PlaceIn<const SpooledRows, const T>(this, 0); }
  auto end() const { return PlaceIn<const SpooledRows, const T>(this, size_); }

  void push_back(const T& row) {
    const T copy = row;  // it may be one of these
    if ((size_ + 1) * sizeof(T) > bytes_.capacity()) bytes_.Grow((size_ + 1) * sizeof(T), size_ * sizeof(T));
    *At(size_, true) = copy;
    ++size_;
  }
  void pop_back() { --size_; }
  void resize(std::size_t size, const T& row) {
    size_ = std::min(size, size_);
    while (size_ < size) push_back(row);
  }
  void clear() { *this = SpooledRows(folder()); }
  std::vector<T> vector() const { return {begin(), end()}; }
  // NOLINTNEXTLINE(google-explicit-constructor): it stands for its elements
  operator Walked<T>() const { return {{Rows(), size_}, bytes_.is_in_file()}; }
  // All of them, which are here no more.
  Array Take() { return bytes_.Take(DTypeOf<T>(), sizeof(T), std::exchange(size_, 0) * sizeof(T)); }

  void EraseIf(const auto& is_gone) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const T row = (*this)[i];
      if (is_gone(row)) continue;
      if (kept < i) (*this)[kept] = row;
      ++kept;
    }
    size_ = kept;
  }

 private:
  T* Rows() const { return reinterpret_cast<T*>(bytes_.data()); }
  T* At(std::size_t i, bool to_write = false) const {
    const std::size_t block = i >> kMappedBlockShift<T>;
    if (!blocks_.IsAt(block))
      blocks_.Turn(block, sizeof(T) << kMappedBlockShift<T>,
                   bytes_.is_in_file() ? std::span<const std::byte>(bytes_.data(), bytes_.capacity())
                                       : std::span<const std::byte>(),
                   to_write);
    return Rows() + i;
  }

  SpooledBytes bytes_;
  std::size_t size_ = 0;
  mutable MappedBlocks blocks_;
};

// By key(row), rows of equal keys in the order that they have: pieces at a time, and then two runs at a time.
template <class T, class Key>
void SortRows(SpooledRows<T>* rows, const Key& key) {
  constexpr std::size_t kPiece = std::max<std::size_t>((std::size_t{1} << 20) / sizeof(T), 1);
  const auto less = [&](const T& a, const T& b) { return key(a) < key(b); };
  std::vector<std::size_t> runs;  // where each begins
  for (std::size_t first = 0; first < rows->size(); first += kPiece) {
    const std::size_t end = std::min(first + kPiece, rows->size());
    const auto from = rows->begin() + static_cast<std::ptrdiff_t>(first),
               to = rows->begin() + static_cast<std::ptrdiff_t>(end);
    if (!std::is_sorted(from, to, less)) {
      std::vector<T> piece(from, to);
      std::ranges::stable_sort(piece, less);
      std::ranges::copy(piece, from);
    }
    if (first == 0 || less((*rows)[first], (*rows)[first - 1])) runs.push_back(first);
  }
  while (runs.size() > 1) {
    SpooledRows<T> merged(rows->folder());
    std::vector<std::size_t> longer;
    for (std::size_t run = 0; run < runs.size(); run += 2) {
      longer.push_back(runs[run]);
      std::size_t a = runs[run];
      const std::size_t a_end = run + 1 < runs.size() ? runs[run + 1] : rows->size();
      std::size_t b = a_end;
      const std::size_t b_end = run + 2 < runs.size() ? runs[run + 2] : rows->size();
      while (a < a_end || b < b_end) {
        const bool takes_b = b < b_end && (a == a_end || less((*rows)[b], (*rows)[a]));
        merged.push_back((*rows)[takes_b ? b++ : a++]);
      }
    }
    *rows = std::move(merged);
    runs = std::move(longer);
  }
}

}  // namespace cairn
