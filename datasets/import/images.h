// `cairn import images`: a folder of images, and tables of when and where each was taken, of which columns
// stand in any order. Either `poses` names the images,
//
//   image,time_s,x_m,y_m[,heading_rad]   image: its path in the folder
//   run                                  of any name; without it all are one, called after the folder
//   any other                            an input beside the image (a range), called by its column
//
// or it is a track (pose_track.h) and `times` names them, with the same columns but for the pose.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "datasets/import/log_rows.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct ImagesImportOptions {
  std::string folder;
  std::string poses;
  std::string ranges;       // readings of other sensors by time (timed_inputs.h); empty: none
  std::string times;        // empty: `poses` names the images
  double smooth_s = 0;      // of a track
  double most_gap_s = 1.0;  // between rows of a track, and from an image to its ranges
  bool skip_bad = false;    // skip bad lines, and images without one, and count them by reason
  std::size_t most_image_bytes = 2'000'000'000;  // of pixels, of all together
};

// An image, 8 bits of red, green, blue, or why there is none.
struct ImageReading {
  int rows = 0, columns = 0;
  std::vector<std::uint8_t> rgb = {};  // [rows][columns][3]
  std::string failure = {};
};
// Of the first of `paths`, of one at least, each: as many as the reader takes into memory at once, which is
// little beside most_image_bytes. Images are decoded by another program, or by a test.
using ImageReader = std::function<std::vector<ImageReading>(const std::vector<std::string>& paths)>;

// Makes `samples` (schema/FORMAT.md) with images, whose inputs are those of the tables. Bad lines are those
// of vectors.h, and: no such image, bad image, an image of another size than the run's first, one without a
// pose or ranges at its time. Refused are also an image in the folder (PNG, JPEG, PPM) that no table names,
// an input without a name of its own, a run of less than two samples.
// Throws InputError "FILE:LINE: REASON: DETAIL".
ImportReport ImportImages(const ImagesImportOptions& options, const ImageReader& read, Blob* samples);

}  // namespace cairn::datasets
