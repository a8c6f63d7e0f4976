// Images by OpenCV's imgcodecs. That costs 140 libraries and 50 ms a start: only `cairn-images` and tests
// link it.
#pragma once

#include <string>

#include "datasets/images/image_features.h"

namespace cairn::datasets {

// PNG, JPEG, PPM and what else OpenCV reads, as 8 bits of red, green, blue; turned as it was stored. Throws
// InputError "it cannot be decoded", "it has … pixels; …", without the file's name.
RgbImage DecodeImage(const std::string& path);

}  // namespace cairn::datasets
