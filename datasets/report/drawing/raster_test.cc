#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "datasets/report/drawing/picture.h"

namespace cairn::datasets::report {
namespace {

// Four cells, of which the picture shows the middle: a hundredth of the image's side.
Picture MuchEnlarged() {
  constexpr double kSide = 100, kCells = 100 * kSide;
  Raster cells{2, 2};
  for (const Rgb colour : {Rgb{200, 0, 0}, Rgb{0, 200, 0}, Rgb{0, 0, 200}, Rgb{200, 200, 0}})
    cells.Add(colour);
  Picture picture(kSide, kSide, "x");
  picture.Image({(kSide - kCells) / 2, (kSide - kCells) / 2, kCells, kCells}, cells);
  return picture;
}

TEST(PicturePng, OfAnEnlargedImageItShowsWhatLiesWithin) {
  const std::string png = MuchEnlarged().Png(1);
  const cv::Mat image = cv::imdecode(std::vector<unsigned char>(png.begin(), png.end()), cv::IMREAD_COLOR);
  ASSERT_EQ(image.size(), cv::Size(100, 100));
  EXPECT_EQ(image.at<cv::Vec3b>(20, 20), cv::Vec3b(0, 0, 200));
  EXPECT_EQ(image.at<cv::Vec3b>(20, 80), cv::Vec3b(0, 200, 0));
  EXPECT_EQ(image.at<cv::Vec3b>(80, 20), cv::Vec3b(200, 0, 0));
  EXPECT_EQ(image.at<cv::Vec3b>(80, 80), cv::Vec3b(0, 200, 200));
}

#ifndef CAIRN_SANITIZED
// All of it would take 1.2 GB.
TEST(PicturePng, AnEnlargedImageTakesNoMoreMemoryThanIsSeen) {
  const auto draw = [] {
    constexpr rlim_t kMore = rlim_t{200} << 20;
    std::ifstream self("/proc/self/statm");
    rlim_t pages = 0;
    self >> pages;
    const rlim_t most = pages * static_cast<rlim_t>(::getpagesize()) + kMore;
    const rlimit limit{most, most};
    ::setrlimit(RLIMIT_AS, &limit);
    ::_exit(MuchEnlarged().Png(1).empty() ? 1 : 0);
  };
  EXPECT_EXIT(draw(), testing::ExitedWithCode(0), "");
}
#endif

}  // namespace
}  // namespace cairn::datasets::report
