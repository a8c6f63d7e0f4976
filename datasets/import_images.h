// `cairn import images`: a folder of images, and a table of where each was taken. The table is plain or
// gzipped, with a header; columns stand in any order:
//
//   image,time_s,x_m,y_m[,heading_rad]   image: its path in the folder
//   run                                  of any name, may be missing: then all are one, called after the
//   folder any other                            an input beside the image's (a range), called by its column
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "datasets/log_rows.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct ImagesImportOptions {
  std::string folder;
  std::string poses;
  bool skip_bad = false;  // skip bad lines, and images without one, and count them by reason
};

// Features of an image (images/image_features.h), or why there are none.
struct ImageReading {
  std::vector<float> features;
  std::string failure;
};
// One for each path. Images are decoded by another program, or by a test.
using ImageReader = std::function<std::vector<ImageReading>(const std::vector<std::string>& paths)>;

// Makes `samples` (schema/FORMAT.md): the image's features, then the table's inputs. Throws InputError
// "FILE:LINE: REASON: DETAIL". Bad lines are those of import_vectors.h, and: no such image, bad image.
// Refused are also an image in the folder (PNG, JPEG, PPM) that the table does not name, an input without a
// name of its own, a run of less than two samples.
ImportReport ImportImages(const ImagesImportOptions& options, const ImageReader& read, Blob* samples);

}  // namespace cairn::datasets
