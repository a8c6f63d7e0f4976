// Images by the program cairn-images, so that its libraries do not slow every start of `cairn`.
#pragma once

#include <string>
#include <vector>

#include "datasets/import/images.h"

namespace cairn::cli {

// With sides of `most_side` pixels at most (datasets/images/decode_image.h). Of the first of `paths`: as many
// as the program decodes at once, which it does by the memory that they take.
// Throws WorldError where it cannot be run, or crashes on an image.
std::vector<datasets::ImageReading> ReadImagesElsewhere(const std::vector<std::string>& paths, int most_side);

}  // namespace cairn::cli
