#include "coordinator/store/served_file.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <fstream>
#include <iterator>
#include <string>

#include "schema/hash.h"
#include "schema/store/atomic_file.h"

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
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return 0.0;
  std::ifstream file(path);
  const std::string line{std::istreambuf_iterator<char>(file), {}};
  const std::string seconds = line.substr(0, line.find(' '));
  double served_s = 0;
  const auto [rest, failed] = std::from_chars(seconds.data(), seconds.data() + seconds.size(), served_s);
  if (failed != std::errc{} || rest != seconds.data() + seconds.size() || !(served_s >= 0) ||
      line != LineOf(seconds))
    return Status(Code::kCorrupt, path.string() + ": not the time that a store was served for");
  return served_s;
}

}  // namespace cairn::coordinator
