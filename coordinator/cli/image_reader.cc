#include "coordinator/cli/image_reader.h"

#include <algorithm>
#include <sstream>

#include "coordinator/cli/failure.h"
#include "coordinator/cli/programs.h"
#include "datasets/images/image_features.h"
#include "datasets/text_file.h"

namespace cairn::cli {
namespace {

constexpr std::size_t kImagesACall = 256;  // far below what a command line holds

datasets::ImageReading ParseReading(const std::string& line) {
  if (line.starts_with('!')) return {{}, line.substr(1)};
  datasets::ImageReading reading;
  std::istringstream fields(line);
  for (std::string field; std::getline(fields, field, ',');) {
    const char* reason = "";
    const std::optional<double> value = datasets::ParseNumber(field, &reason);
    if (!value) throw WorldError("cairn-images says what is no feature: " + field);
    reading.features.push_back(static_cast<float>(*value));
  }
  if (reading.features.size() != static_cast<std::size_t>(datasets::kImageFeatures))
    throw WorldError("cairn-images is of another version: " + std::to_string(reading.features.size()) +
                     " features");
  return reading;
}

}  // namespace

std::vector<datasets::ImageReading> ReadImagesElsewhere(const std::vector<std::string>& paths) {
  std::vector<datasets::ImageReading> readings;
  for (std::size_t begin = 0; begin < paths.size(); begin += kImagesACall) {
    const std::size_t end = std::min(begin + kImagesACall, paths.size());
    const std::vector<std::string> block(paths.begin() + static_cast<std::ptrdiff_t>(begin),
                                         paths.begin() + static_cast<std::ptrdiff_t>(end));
    std::istringstream lines(OutputOf(ImagesProgram(), block));
    for (std::string line; std::getline(lines, line);) readings.push_back(ParseReading(line));
    if (readings.size() != end) throw WorldError("cairn-images does not say a line for each image");
  }
  return readings;
}

}  // namespace cairn::cli
