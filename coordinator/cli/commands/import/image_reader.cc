#include "coordinator/cli/commands/import/image_reader.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string_view>

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/programs.h"

namespace cairn::cli {
namespace {

constexpr std::size_t kImagesACall = 64;          // far below what a command line holds
constexpr const char* kMostPixels = "134217728";  // 400 MB

// Cuts an image off the front of what cairn-images says.
datasets::ImageReading TakeImage(std::string_view* said) {
  const WorldError other("cairn-images is of another version: it does not say an image for a file");
  const std::size_t end = said->find('\n');
  if (end == std::string_view::npos) throw other;
  const std::string_view line = said->substr(0, end);
  said->remove_prefix(end + 1);
  if (line.starts_with('!')) return {.failure = std::string(line.substr(1))};
  datasets::ImageReading image;
  const char* last = line.data() + line.size();
  const auto rows = std::from_chars(line.data(), last, image.rows);
  if (rows.ec != std::errc() || rows.ptr == last || *rows.ptr != ' ') throw other;
  const auto columns = std::from_chars(rows.ptr + 1, last, image.columns);
  if (columns.ec != std::errc() || columns.ptr != last || image.rows < 1 || image.columns < 1) throw other;
  const std::size_t bytes =
      static_cast<std::size_t>(image.rows) * static_cast<std::size_t>(image.columns) * 3;
  if (said->size() < bytes) throw other;
  image.rgb.assign(said->begin(), said->begin() + static_cast<std::ptrdiff_t>(bytes));
  said->remove_prefix(bytes);
  return image;
}

}  // namespace

std::vector<datasets::ImageReading> ReadImagesElsewhere(const std::vector<std::string>& paths,
                                                        int most_side) {
  // OpenCV's own limit, 2^30 pixels, is 3 GB of memory for an image that may be a kilobyte long.
  ::setenv("OPENCV_IO_MAX_IMAGE_PIXELS", kMostPixels, 0);
  std::vector<std::string> arguments = {std::to_string(most_side)};
  const std::size_t most = std::min(kImagesACall, paths.size());
  arguments.insert(arguments.end(), paths.begin(), paths.begin() + static_cast<std::ptrdiff_t>(most));
  const std::string text = OutputOf(ImagesProgram(), arguments);
  std::vector<datasets::ImageReading> readings;
  for (std::string_view said = text; readings.empty() || (!said.empty() && readings.size() < most);)
    readings.push_back(TakeImage(&said));
  return readings;
}

}  // namespace cairn::cli
