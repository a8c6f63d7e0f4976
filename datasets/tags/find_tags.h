// AprilTags in images, by Debian's libapriltag (E. Olson, AprilTag: a robust and flexible visual fiducial
// system, ICRA 2011; J. Wang, E. Olson, AprilTag 2, IROS 2016).
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace cv {
class Mat;
}

namespace cairn::datasets {

struct TagInImage {
  int id = 0;
  std::array<std::array<double, 2>, 4> corners_px;  // the centres of pixels at whole numbers
};

class TagDetector {
 public:
  // Throws std::invalid_argument that names those that it knows, for an unknown family.
  explicit TagDetector(const std::string& family);
  ~TagDetector();
  TagDetector(const TagDetector&) = delete;
  TagDetector& operator=(const TagDetector&) = delete;

  // Of grey pixels; those whose codes are clear.
  std::vector<TagInImage> Find(const cv::Mat& grey) const;
  // A line for each image of `images`, each of which is a line with its length and then its bytes as a file
  // has them (PNG, JPEG, PGM): its columns and rows, how many tags, and of each its id and its corners; or
  // "!REASON".
  std::string FindInAll(std::string_view images) const;
  // The tag's picture, a pixel a cell, with its white edge.
  cv::Mat Picture(int id) const;

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace cairn::datasets
