// A file of any size of which a part is in memory. Who goes through it reads it in large pieces, who leaps
// over most of it little more than what is looked at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "datasets/bag/bytes.h"
#include "schema/store/regular_file.h"

namespace cairn::datasets::bag {

// What one record of a bag may take in memory: a chunk, unpacked, or a message.
inline constexpr std::uint64_t kMostRecordBytes = std::uint64_t{1} << 28;

class WindowFile {
 public:
  // Throws InputError that names the file.
  explicit WindowFile(std::string path);
  const std::string& path() const { return path_; }
  std::uint64_t size() const { return file_.size(); }
  // The bytes from `at` on, valid until the next call. Throws Damage where the file ends before them, or they
  // are more than kMostRecordBytes; InputError where they cannot be read.
  ByteSpan View(std::uint64_t at, std::uint64_t count);

 private:
  std::string path_;
  RegularFile file_;
  std::vector<std::byte> window_;
  std::uint64_t begin_ = 0, filled_ = 0;  // what of the file is in the window
  std::uint64_t ahead_ = 0;               // how much is read at once
};

}  // namespace cairn::datasets::bag
