#include "datasets/bag/window_file.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace cairn::datasets::bag {
namespace {

constexpr std::uint64_t kLeastAhead = 1 << 12, kMostAhead = 1 << 18;

RegularFile OpenRegular(const std::string& path) {
  Result<RegularFile> file = RegularFile::Open(path);
  if (!file.ok()) throw InputError(file.status().message());
  return std::move(file).value();
}

}  // namespace

WindowFile::WindowFile(std::string path) : path_(std::move(path)), file_(OpenRegular(path_)) {}

ByteSpan WindowFile::View(std::uint64_t at, std::uint64_t count) {
  if (at > size() || count > size() - at) throw Damage{"the file ends within it"};
  if (count > kMostRecordBytes)
    throw Damage{"a record of " + std::to_string(count >> 20) + " MB, where " +
                 std::to_string(kMostRecordBytes >> 20) + " MB are allowed"};
  if (at < begin_ || at + count > begin_ + filled_) {
    const bool goes_on = at >= begin_ && at <= begin_ + filled_;
    ahead_ = goes_on ? std::clamp(4 * ahead_, kLeastAhead, kMostAhead) : kLeastAhead;
    const std::uint64_t wanted = std::min(std::max(count, ahead_), size() - at);
    if (window_.size() < wanted) window_.resize(wanted);
    filled_ = 0;
    if (const int error = file_.ReadAt(std::span(window_).first(wanted), at); error != 0)
      throw InputError(path_ + ": cannot be read: " + std::strerror(error));
    begin_ = at;
    filled_ = wanted;
  }
  return ByteSpan(window_).subspan(at - begin_, count);
}

}  // namespace cairn::datasets::bag
