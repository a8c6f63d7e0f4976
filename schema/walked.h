// Values that may lie in a mapped file, larger than the memory: of what is walked over no more stays in
// memory than was looked at last.
#pragma once

#include <bit>
#include <compare>
#include <concepts>
#include <cstddef>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "schema/array.h"

namespace cairn {

// Of all bytes of a file that is mapped, shared, `count` from `at` on, which come back when they are looked
// at again.
void LetGoOfMapped(std::span<const std::byte> all, std::size_t at, std::size_t count);

// Which two blocks of such a file were looked at last; of the others none is in memory.
class MappedBlocks {
 public:
  static constexpr std::size_t kBytes = std::size_t{1} << 18;
  bool IsAt(std::size_t block) const { return block == now_; }
  // `bytes`: all of the file; empty: the values are in memory. `to_write`: all of the block will be written.
  void Turn(std::size_t block, std::size_t block_bytes, std::span<const std::byte> bytes,
            bool to_write = false);

 private:
  std::size_t now_ = static_cast<std::size_t>(-1), before_ = now_;
};

// Elements of a block, as a power of two.
template <class T>
inline constexpr int kMappedBlockShift = std::bit_width(MappedBlocks::kBytes / sizeof(T)) - 1;

// Place `i` of what has an operator[].
template <class Of, class T>
class PlaceIn {
 public:
  using value_type = std::remove_const_t<T>;
  using difference_type = std::ptrdiff_t;
  using iterator_category = std::random_access_iterator_tag;
  using reference = T&;
  using pointer = T*;
  PlaceIn() = default;
  PlaceIn(Of* of, std::size_t at) : of_(of), at_(static_cast<difference_type>(at)) {}
  T& operator*() const { return (*of_)[static_cast<std::size_t>(at_)]; }
  T* operator->() const { return &**this; }
  T& operator[](difference_type n) const { return *(*this + n); }
  PlaceIn& operator+=(difference_type n) { return at_ += n, *this; }
  PlaceIn& operator-=(difference_type n) { return at_ -= n, *this; }
  PlaceIn& operator++() { return *this += 1; }
  PlaceIn& operator--() { return *this -= 1; }
  PlaceIn operator++(int) { return std::exchange(*this, *this + 1); }
  PlaceIn operator--(int) { return std::exchange(*this, *this - 1); }
  friend PlaceIn operator+(PlaceIn a, difference_type n) { return a += n; }
  friend PlaceIn operator+(difference_type n, PlaceIn a) { return a += n; }
  friend PlaceIn operator-(PlaceIn a, difference_type n) { return a -= n; }
  friend difference_type operator-(const PlaceIn& a, const PlaceIn& b) { return a.at_ - b.at_; }
  friend bool operator==(const PlaceIn& a, const PlaceIn& b) { return a.at_ == b.at_; }
  friend auto operator<=>(const PlaceIn& a, const PlaceIn& b) { return a.at_ <=> b.at_; }

 private:
  Of* of_ = nullptr;
  difference_type at_ = 0;
};

// Over values that somebody else owns. Who walks over them at two places at once should not do so by one.
template <class T>
class Walked {
 public:
  Walked() = default;
  // NOLINTBEGIN(google-explicit-constructor): it stands for its elements
  Walked(std::span<const T> values, bool are_in_file = false) : values_(values), in_file_(are_in_file) {}
  Walked(const std::vector<T>& values) : values_(values) {}
  Walked(const Array& array) : Walked(array.As<T>(), array.is_in_file()) {}
  // NOLINTEND(google-explicit-constructor)

  std::size_t size() const { return values_.size(); }
  bool empty() const { return values_.empty(); }
  const T& front() const { return values_.front(); }
  const T& back() const { return values_.back(); }
  const T& operator[](std::size_t i) const {
    const std::size_t block = i >> kMappedBlockShift<T>;
    if (!blocks_.IsAt(block))
      blocks_.Turn(block, sizeof(T) << kMappedBlockShift<T>,
                   in_file_ ? std::as_bytes(values_) : std::span<const std::byte>());
    return values_[i];
  }
  auto begin() const { return PlaceIn<const Walked, const T>(this, 0); }
  auto end() const { return PlaceIn<const Walked, const T>(this, size()); }

 private:
  std::span<const T> values_;
  bool in_file_ = false;
  mutable MappedBlocks blocks_;
};

}  // namespace cairn
