#include "datasets/tags/find_tags.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "datasets/detect/tag_pose.h"

namespace cairn::datasets {
namespace {

constexpr double kSize_m = 0.16;  // of the black square
const Camera kCamera{500, 500, 319.5, 239.5, {}};

// What the camera sees of a tag: libapriltag's own picture of it, by the homography of its plane; drawn four
// times as large and made smaller, as a sensor's pixels are means.
cv::Mat Seen(const TagDetector& tags, int id, const Eigen::Vector3d& middle, const Eigen::Matrix3d& axes) {
  constexpr int kFiner = 4, kCells = 10, kHalf = 5, kBlack = 8;  // of a tag of 36h11, with its white edge
  cv::Mat picture, large, image;
  cv::resize(tags.Picture(id), picture, {}, 20, 20, cv::INTER_NEAREST);
  std::vector<cv::Point2f> from, to;
  for (const auto& [u, v] : {std::pair(0, 0), {kCells, 0}, {kCells, kCells}, {0, kCells}}) {
    from.emplace_back(static_cast<float>(20 * u - 0.5), static_cast<float>(20 * v - 0.5));
    const Eigen::Vector3d on_tag((u - kHalf) * kSize_m / kBlack, (v - kHalf) * kSize_m / kBlack, 0);
    const Eigen::Vector2d px = kCamera.Project(axes * on_tag + middle);
    to.emplace_back(static_cast<float>(kFiner * (px.x() + 0.5) - 0.5),
                    static_cast<float>(kFiner * (px.y() + 0.5) - 0.5));
  }
  cv::warpPerspective(picture, large, cv::getPerspectiveTransform(from, to), {kFiner * 640, kFiner * 480},
                      cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(180));
  cv::resize(large, image, {640, 480}, 0, 0, cv::INTER_AREA);
  return image;
}

std::optional<LocatedTag> Locate(const TagInImage& tag) {
  TagCorners corners;
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = {tag.corners_px[i][0], tag.corners_px[i][1]};
  return LocateTag(corners, kCamera, kSize_m);
}

// Whether pixels' centres or corners are at whole numbers shows in the bearing: half a pixel is a
// milliradian.
TEST(TagDetector, FindsTagsWhereTheyAre) {
  const TagDetector tags("tag36h11");
  double off_aside = 0, most_off = 0;
  int seen = 0;
  for (int k = 0; k < 40; ++k) {
    const double away_m = 1 + 0.05 * k;
    const Eigen::Vector3d middle(0.6 * std::sin(k), 0.3 * std::cos(3 * k), away_m);
    const Eigen::Matrix3d axes = (Eigen::AngleAxisd(0.8 * std::sin(2 * k), Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(0.1 * k, Eigen::Vector3d::UnitZ()))
                                     .toRotationMatrix();
    const auto found = tags.Find(Seen(tags, 3 * k, middle, axes));
    ASSERT_EQ(found.size(), 1u) << k;
    EXPECT_EQ(found[0].id, 3 * k);
    const auto located = Locate(found[0]);
    ASSERT_TRUE(located);
    ++seen;
    off_aside += located->middle.x() / located->middle.z() - middle.x() / middle.z();
    most_off = std::max(most_off, (located->middle - middle).norm() / away_m);
  }
  EXPECT_LT(std::abs(off_aside / seen), 0.0002);
  EXPECT_LT(most_off, 0.03);
}

TEST(TagDetector, AnImageWithoutTagsHasNone) {
  cv::Mat noise(480, 640, CV_8U);
  cv::RNG random(5);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  EXPECT_TRUE(TagDetector("tag36h11").Find(noise).empty());
}

// The library reads beyond the end of such ones.
TEST(TagDetector, ImagesOfAFewPixelsHaveNone) {
  const TagDetector tags("tag36h11");
  for (const auto& [rows, cols] : {std::pair(1, 1), {2, 2}, {1, 640}, {640, 1}, {2, 8}})
    EXPECT_TRUE(tags.Find(cv::Mat(rows, cols, CV_8U, cv::Scalar(0))).empty()) << rows << " x " << cols;
}

TEST(TagDetector, TakesImagesOneAfterTheOther) {
  const TagDetector tags("tag36h11");
  std::vector<unsigned char> png;
  cv::imencode(".png", Seen(tags, 11, {0, 0, 1}, Eigen::Matrix3d::Identity()), png);
  const std::string image(png.begin(), png.end()), grey = "P5 4 3 255\n" + std::string(12, 'x');
  const auto entry = [](const std::string& bytes) { return std::to_string(bytes.size()) + "\n" + bytes; };
  const std::string said = tags.FindInAll(entry(image) + entry("no image") + entry(grey) + entry(""));
  EXPECT_EQ(said.substr(0, 13), "640 480 1 11 ");
  EXPECT_EQ(said.substr(said.find('\n')), "\n!it cannot be decoded\n4 3 0\n!it cannot be decoded\n");
  EXPECT_EQ(tags.FindInAll("12\nshort"), "");
  // A decoder goes over all pixels for each scan.
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", cv::Mat(16, 16, CV_8U, cv::Scalar(90)), jpeg, {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  std::string scans(jpeg.begin(), jpeg.end() - 2);
  const std::string last = scans.substr(scans.rfind("\xFF\xDA"));
  EXPECT_EQ(tags.FindInAll(entry(scans + "\xFF\xD9")), "16 16 0\n");
  EXPECT_EQ(tags.FindInAll(entry(scans)), "!it cannot be decoded\n") << "it breaks off";
  for (int i = 0; i < 100; ++i) scans += last;
  EXPECT_EQ(tags.FindInAll(entry(scans + "\xFF\xD9") + entry(grey)), "!it cannot be decoded\n4 3 0\n");
  // Of an image as long as that the library ends the program.
  const std::string row = "P5 32768 8 255\n" + std::string(8 * 32768, 'x');
  EXPECT_EQ(tags.FindInAll(entry(row) + entry(grey)), "!it cannot be decoded\n4 3 0\n");
}

TEST(TagDetector, AFamilyThatIsNoneIsRefusedWithThoseThatAre) {
  try {
    const TagDetector tags("tag99");
    FAIL() << "taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("tag36h11"), std::string::npos);
  }
}

}  // namespace
}  // namespace cairn::datasets
