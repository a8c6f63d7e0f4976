#include "coordinator/store/use.h"

#include <array>
#include <cstdio>
#include <utility>

namespace cairn::coordinator {

namespace fs = std::filesystem;

StoreUse::StoreUse(fs::path dir, std::uint64_t limit_bytes)
    : dir_(std::move(dir)), limit_bytes_(limit_bytes) {
  Count();
}

void StoreUse::Count() {
  std::uint64_t bytes = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator it(dir_, error), end; !error && it != end; it.increment(error)) {
    std::error_code gone;  // what vanishes meanwhile takes no room
    const std::uint64_t size = it->is_regular_file(gone) ? it->file_size(gone) : 0;
    if (!gone) bytes += size;
  }
  bytes_ = bytes;
}

std::string StoreUse::WhyNoRoom(std::uint64_t more_bytes) const {
  const std::uint64_t used = bytes_;
  if (limit_bytes_ == 0 || (used <= limit_bytes_ && more_bytes <= limit_bytes_ - used)) return "";
  return "the store holds " + BytesText(used) + " of at most " + BytesText(limit_bytes_) + " (--store-gb); " +
         BytesText(more_bytes) + " more do not fit";
}

Status StoreUse::Reserve(std::uint64_t more_bytes) {
  if (!WhyNoRoom(more_bytes).empty()) Count();  // much may have been removed
  if (const std::string why = WhyNoRoom(more_bytes); !why.empty()) return {Code::kNoSpace, why};
  bytes_ += more_bytes;
  return Status::Ok();
}

std::string BytesText(std::uint64_t bytes) {
  constexpr std::array kUnits = {"B", "kB", "MB", "GB", "TB"};
  auto value = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; value >= 1000 && unit + 1 < kUnits.size(); ++unit) value /= 1000;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), unit == 0 ? "%.0f %s" : "%.1f %s", value, kUnits[unit]);
  return text.data();
}

}  // namespace cairn::coordinator
