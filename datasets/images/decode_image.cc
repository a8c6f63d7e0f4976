#include "datasets/images/decode_image.h"

#include <opencv2/imgcodecs.hpp>

#include "schema/error.h"

namespace cairn::datasets {

RgbImage DecodeImage(const std::string& path) {
  cv::Mat image;
  try {
    image = cv::imread(path, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    image.release();  // too large, or damaged in a way that the codec throws
  }
  if (image.empty()) throw InputError("it cannot be decoded");
  if (image.rows < kImageBands || image.cols < kImageBands) {
    throw InputError("it has " + std::to_string(image.rows) + " by " + std::to_string(image.cols) +
                     " pixels; 10 by 10 or more are needed");
  }
  RgbImage rgb{image.rows, image.cols, {}};
  rgb.rgb.reserve(image.total() * 3);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const auto& bgr = image.at<cv::Vec3b>(row, column);
      rgb.rgb.insert(rgb.rgb.end(), {bgr[2], bgr[1], bgr[0]});
    }
  }
  return rgb;
}

}  // namespace cairn::datasets
