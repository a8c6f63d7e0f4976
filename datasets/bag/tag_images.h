// AprilTags in a bag's images, as landmarks.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/bag/import_bag.h"
#include "datasets/bag/readers.h"
#include "datasets/detect/tag_pose.h"

namespace cairn::datasets::bag {

// "TOPIC=SIZE_M".
struct TagSource {
  std::string topic;
  double size_m = 0;
};
TagSource ParseTagSource(const std::string& text);  // throws InputError
// "FX,FY,CX,CY[,K1,K2,P1,P2[,K3[,K4,K5,K6]]]". Throws InputError.
Camera ParseCamera(const std::string& text);

// What one topic's images show.
class TagCamera {
 public:
  TagCamera(TagSource source, const BagImportOptions& options);

  const TagSource& source() const { return source_; }
  // Of images, and of the CameraInfo beside them.
  std::unique_ptr<TopicReader> ReadImages(const std::string& type);
  std::unique_ptr<TopicReader> ReadInfo();
  bool has_camera() const { return camera_.has_value(); }
  // After all has been read. Throws InputError: nothing says what the camera is like.
  void Finish(ImportReport* report);

  struct Seen {
    Sighting tag;  // `point` as the camera's optical frame has it: x to the right, y down, z ahead
    Eigen::Matrix3d covariance;
  };
  const std::vector<Seen>& seen() const { return seen_; }
  const std::string& frame() const { return frame_; }

 private:
  friend class ImageReader;
  friend class InfoReader;
  struct Corners {
    double time_s = 0;
    std::size_t number = 0;
    std::string id;
    TagCorners corners;
  };
  void Add(double time_s, std::size_t number, const std::string& image);
  void Look();  // at those that wait
  void TakeLine(const std::string& line, double time_s, std::size_t number);

  TagSource source_;
  std::string family_;
  std::function<std::string(const std::string& family, const std::string& images)> find_tags_;
  std::string frame_;
  std::optional<Camera> camera_;
  struct Size {
    std::size_t columns = 0, rows = 0;
    bool operator==(const Size&) const = default;
  };
  std::optional<Size> camera_size_;  // of the images that the camera is of, where that is said
  std::optional<Size> size_;         // of the first image
  std::string waiting_;              // images, as the detector takes them
  std::vector<std::pair<double, std::size_t>> when_;  // of each of them: time, number
  std::vector<Corners> corners_;
  std::int64_t images_ = 0, undecoded_ = 0, of_other_size_ = 0;
  std::vector<Seen> seen_;
};

}  // namespace cairn::datasets::bag
