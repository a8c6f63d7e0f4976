// HDF5's C API behind small types. Nothing outside schema/store/ includes this.
#pragma once

#include <hdf5.h>

#include <mutex>
#include <string>
#include <utility>

#include "schema/array.h"

namespace cairn::store {

// An HDF5 identifier with the function that closes it.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Closer closer) : id_(id), closer_(closer) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), closer_(other.closer_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(closer_, other.closer_);
    return *this;
  }
  ~Handle() { Close(); }
  bool ok() const { return id_ >= 0; }
  hid_t get() const { return id_; }
  // False where HDF5 could not close it (it flushes when a file closes). What HDF5 said of a call that failed
  // before stays known (LastCause): the call that closes would begin with a clean slate.
  bool Close() {
    const hid_t id = std::exchange(id_, -1);
    if (id < 0) return true;
    const hid_t errors = H5Eget_num(H5E_DEFAULT) > 0 ? H5Eget_current_stack() : -1;
    const bool closed = closer_(id) >= 0;
    if (errors >= 0) H5Eset_current_stack(errors);
    return closed;
  }

 private:
  hid_t id_ = -1;
  Closer closer_ = nullptr;
};

// Of numbers, in the file as in memory: blobs are little-endian. Of text there is none.
Handle NumberType(DType type);

// Held by whoever is inside HDF5, which has one lock for all of itself anyway; with it held no other thread
// is, and the process may fork.
std::mutex& LibraryMutex();

// HDF5 prints its error stack to stderr by itself, a thread at a time: off while one of these lives.
class QuietErrors {
 public:
  QuietErrors() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~QuietErrors() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

// What HDF5's error stack of this thread holds.
struct Hdf5Cause {
  std::string text;          // the innermost description
  bool in_a_filter = false;  // a checksum or a decompression failed
  bool no_memory = false;    // the system gave none
};
Hdf5Cause LastCause();

}  // namespace cairn::store
