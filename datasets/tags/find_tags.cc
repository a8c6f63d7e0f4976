#include "datasets/tags/find_tags.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>

#include <algorithm>
#include <charconv>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "datasets/images/jpeg_form.h"

namespace cairn::datasets {
namespace {

struct Family {
  const char* name;
  apriltag_family_t* (*make)();
  void (*end)(apriltag_family_t*);
};
constexpr Family kFamilies[] = {
    {"tag36h11", tag36h11_create, tag36h11_destroy},
    {"tag25h9", tag25h9_create, tag25h9_destroy},
    {"tag16h5", tag16h5_create, tag16h5_destroy},
    {"tag36h10", tag36h10_create, tag36h10_destroy},
    {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
    {"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy},
};

const Family& FamilyOf(const std::string& name) {
  std::string known;
  for (const Family& family : kFamilies) {
    if (name == family.name) return family;
    known += (known.empty() ? "" : ", ") + std::string(family.name);
  }
  throw std::invalid_argument("no family of tags that is known: '" + name + "'; known are " + known);
}

// A number that ends the line, cut off with it.
bool TakeLength(std::string_view* text, std::size_t* length) {
  const auto end = std::from_chars(text->data(), text->data() + text->size(), *length);
  const auto used = static_cast<std::size_t>(end.ptr - text->data());
  if (end.ec != std::errc() || used >= text->size() || (*text)[used] != '\n') return false;
  text->remove_prefix(used + 1);
  return *length <= text->size();
}

}  // namespace

struct TagDetector::Library {
  void (*end)(apriltag_family_t*);
  apriltag_family_t* family;
  apriltag_detector_t* detector;
};

TagDetector::TagDetector(const std::string& family)
    : library_(new Library{FamilyOf(family).end, FamilyOf(family).make(), apriltag_detector_create()}) {
  constexpr int kBitsMended = 1;  // with two, what is no tag is taken for one now and then
  apriltag_detector_add_family_bits(library_->detector, library_->family, kBitsMended);
  library_->detector->nthreads = 1;
  library_->detector->quad_decimate = 1;  // corners of all pixels: a range hangs on them
}

TagDetector::~TagDetector() {
  apriltag_detector_destroy(library_->detector);
  library_->end(library_->family);
}

std::vector<TagInImage> TagDetector::Find(const cv::Mat& grey) const {
  constexpr double kLeastMargin = 25, kHalf = 0.5;  // the library's pixels begin at whole numbers
  constexpr int kLeastSide = 8;                     // of smaller ones the library reads beyond the end
  if (std::min(grey.cols, grey.rows) < kLeastSide) return {};
  image_u8_t image{grey.cols, grey.rows, static_cast<int>(grey.step), grey.data};
  zarray_t* found = apriltag_detector_detect(library_->detector, &image);
  std::vector<TagInImage> tags;
  for (int i = 0; i < zarray_size(found); ++i) {
    apriltag_detection_t* one = nullptr;
    zarray_get(found, i, static_cast<void*>(&one));
    if (one->decision_margin < kLeastMargin) continue;
    TagInImage& tag = tags.emplace_back();
    tag.id = one->id;
    for (std::size_t c = 0; c < tag.corners_px.size(); ++c)
      tag.corners_px[c] = {one->p[c][0] - kHalf, one->p[c][1] - kHalf};
  }
  apriltag_detections_destroy(found);
  return tags;
}

std::string TagDetector::FindInAll(std::string_view images) const {
  std::string lines;
  for (std::size_t length = 0; TakeLength(&images, &length); images.remove_prefix(length)) {
    cv::Mat grey;
    try {
      const cv::Mat bytes(1, static_cast<int>(length), CV_8U, const_cast<char*>(images.data()));
      const std::string_view image = images.substr(0, length);
      if (length > 0 && !HasTooManyScans(image) && !BreaksOff(image))
        grey = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
    } catch (const cv::Exception&) {
      grey.release();  // too large, or damaged in a way that the codec throws
    }
    constexpr int kMostSide = 32767;  // of more pixels the library ends the program
    if (grey.empty() || std::max(grey.cols, grey.rows) > kMostSide) {
      lines += "!it cannot be decoded\n";
      continue;
    }
    const std::vector<TagInImage> tags = Find(grey);
    lines += std::to_string(grey.cols) + ' ' + std::to_string(grey.rows) + ' ' + std::to_string(tags.size());
    for (const TagInImage& tag : tags) {
      lines += ' ' + std::to_string(tag.id);
      for (const auto& corner : tag.corners_px)
        for (const double px : corner) lines += ' ' + std::to_string(px);
    }
    lines += '\n';
  }
  return lines;
}

cv::Mat TagDetector::Picture(int id) const {
  image_u8_t* image = apriltag_to_image(library_->family, id);
  const cv::Mat picture =
      cv::Mat(image->height, image->width, CV_8U, image->buf, static_cast<std::size_t>(image->stride))
          .clone();
  image_u8_destroy(image);
  return picture;
}

}  // namespace cairn::datasets
