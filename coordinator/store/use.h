// What a store takes on disk, against its limit. Counted by the thread that writes; any thread may look.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>

#include "schema/error.h"

namespace cairn::coordinator {

class StoreUse {
 public:
  // 0: no limit.
  StoreUse(std::filesystem::path dir, std::uint64_t limit_bytes);

  // Of all files, as of the last Count and what was reserved since; what was removed since is still in it.
  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t limit_bytes() const { return limit_bytes_; }
  // Looks at every file.
  void Count();
  // `more` bytes are about to be written. kNoSpace: they would go over the limit.
  Status Reserve(std::uint64_t more_bytes);
  // Why so much more would not fit, for people; empty where it does.
  std::string WhyNoRoom(std::uint64_t more_bytes) const;

 private:
  const std::filesystem::path dir_;
  const std::uint64_t limit_bytes_;
  std::atomic<std::uint64_t> bytes_{0};
};

// "1.5 GB", for people.
std::string BytesText(std::uint64_t bytes);

}  // namespace cairn::coordinator
