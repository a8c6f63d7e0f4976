#include "datasets/images/decode_image.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <utility>

#include "datasets/images/jpeg_form.h"

namespace cairn::datasets {
namespace {

// The mean of a square of `side` pixels, rounded.
std::uint8_t Mean(const cv::Mat& bgr, int row, int column, int channel, int side) {
  std::int64_t sum = 0;
  for (int r = row; r < row + side; ++r) {
    for (int c = column; c < column + side; ++c) sum += bgr.at<cv::Vec3b>(r, c)[channel];
  }
  const std::int64_t pixels = std::int64_t{side} * side;
  return static_cast<std::uint8_t>((2 * sum + pixels) / (2 * pixels));
}

// Empty: nothing that a decoder would not tell.
std::string WhatIsWrongWithJpeg(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes(kJpeg.size(), 0);
  if (!file.read(bytes.data(), static_cast<std::streamsize>(kJpeg.size())) || bytes != kJpeg) return "";
  bytes.append(std::istreambuf_iterator<char>(file), {});
  if (HasTooManyScans(bytes)) return "it cannot be decoded";
  return BreaksOff(bytes) ? "it cannot be decoded: it breaks off" : "";
}

}  // namespace

ImageReading DecodeImage(const std::string& path, int most_side) {
  if (std::string wrong = WhatIsWrongWithJpeg(path); !wrong.empty()) return {.failure = std::move(wrong)};
  cv::Mat image;
  try {
    image = cv::imread(path, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    image.release();  // too large, or damaged in a way that the codec throws
  }
  if (image.empty()) return {.failure = "it cannot be decoded"};
  const int side = std::max(1, (std::max(image.rows, image.cols) + most_side - 1) / most_side);
  ImageReading reading{.rows = image.rows / side, .columns = image.cols / side};
  if (reading.rows == 0 || reading.columns == 0) return {.failure = "it is too long for its width"};
  reading.rgb.reserve(static_cast<std::size_t>(reading.rows) * static_cast<std::size_t>(reading.columns) * 3);
  for (int row = 0; row < reading.rows; ++row) {
    for (int column = 0; column < reading.columns; ++column) {
      for (const int channel : {2, 1, 0})
        reading.rgb.push_back(Mean(image, row * side, column * side, channel, side));
    }
  }
  return reading;
}

std::vector<ImageReading> DecodeImages(std::span<const std::string> paths, int most_side,
                                       std::size_t most_bytes) {
  std::vector<ImageReading> readings;
  std::size_t bytes = 0;
  for (const std::string& path : paths) {
    if (!readings.empty() && bytes >= most_bytes) break;
    readings.push_back(DecodeImage(path, most_side));
    bytes += readings.back().rgb.size();
  }
  return readings;
}

}  // namespace cairn::datasets
