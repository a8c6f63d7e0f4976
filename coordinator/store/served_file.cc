#include "coordinator/store/served_file.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <string>

#include "schema/hash.h"
#include "schema/store/atomic_file.h"
#include "schema/store/regular_file.h"

namespace cairn::coordinator {
namespace {

std::string LineOf(const std::string& seconds) {
  Hasher hasher;
  hasher.Add(std::string_view(seconds));
  return seconds + " " + hasher.Finish().Hex() + "\n";
}

}  // namespace

Status WriteServed(const std::filesystem::path& path, double served_s) {
  return WriteTextAtomically(path, LineOf(fmt::format("{:.3f}", served_s)));
}

Result<double> ReadServed(const std::filesystem::path& path) {
  constexpr std::size_t kMostBytes = 1 << 10;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return 0.0;
  const Result<std::string> read = ReadSmallFile(path, kMostBytes);
  if (!read.ok()) return read.status();
  const std::string& line = read.value();
  const std::string seconds = line.substr(0, line.find(' '));
  double served_s = 0;
  const auto [rest, failed] = std::from_chars(seconds.data(), seconds.data() + seconds.size(), served_s);
  if (failed != std::errc{} || rest != seconds.data() + seconds.size() || !(served_s >= 0) ||
      line != LineOf(seconds))
    return Status(Code::kCorrupt, path.string() + ": not the time that a store was served for");
  return served_s;
}

}  // namespace cairn::coordinator
