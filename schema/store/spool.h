// Values as they come, for an array that may be larger than the memory: in memory, or in a file without a
// name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "schema/array.h"

namespace cairn {

// A file in the folder that no other process sees, open for both; where the file system knows none without a
// name, one that loses it at once. -1 with `error`, an errno, where there can be none.
int OpenNamelessFile(const std::filesystem::path& folder, int* error);

class Spool {
 public:
  // In which folder the file is made, once there are more than a few values; empty: all is kept in memory.
  explicit Spool(std::filesystem::path folder = {}) : folder_(std::move(folder)) {}
  Spool(Spool&& other) noexcept;
  Spool& operator=(Spool&& other) noexcept;
  ~Spool();

  template <class T>
  void Add(std::span<const T> values) {
    AddBytes(std::as_bytes(values));
  }
  const std::filesystem::path& folder() const { return folder_; }
  // All of them, which it has no more. Fails as SystemFailure (atomic_file.h) says where not all could be
  // written.
  Result<Array> Take(DType type, std::size_t item_bytes, const Shape& shape);

 private:
  void AddBytes(std::span<const std::byte> bytes);
  void Flush();

  std::filesystem::path folder_;
  std::vector<std::byte> last_;  // those that are not in the file
  std::uint64_t written_ = 0;
  int fd_ = -1, error_ = 0;
};

}  // namespace cairn
