// tag_pictures FAMILY COUNT FOLDER: libapriltag's own pictures of the first tags, FOLDER/ID.png, a pixel a
// cell.
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "datasets/tags/find_tags.h"

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const cairn::datasets::TagDetector tags(argv[1]);
  for (int id = 0; id < std::atoi(argv[2]); ++id)
    if (!cv::imwrite(std::string(argv[3]) + "/" + std::to_string(id) + ".png", tags.Picture(id))) return 1;
}
