// Images by OpenCV's imgcodecs. That costs 140 libraries and 50 ms a start: only `cairn-images` and tests
// link it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "datasets/import/images.h"

namespace cairn::datasets {

// PNG, JPEG, PPM and what else OpenCV reads, turned as it was stored. Where a side is longer than `most_side`
// pixels, each becomes the mean of a square of as few as will do; what is left over of such squares on the
// right and below is cut off. What cannot be decoded has a failure, without the file's name.
ImageReading DecodeImage(const std::string& path, int most_side);

// One after the other, until their pixels take `most_bytes` or more: of the first of `paths`, of one at
// least.
std::vector<ImageReading> DecodeImages(std::span<const std::string> paths, int most_side,
                                       std::size_t most_bytes);

}  // namespace cairn::datasets
