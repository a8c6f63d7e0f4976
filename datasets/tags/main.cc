// cairn-tags FAMILY: the tags in images on stdin, as TagDetector::FindInAll has both. A program of its own:
// its libraries are slow to load, and what crashes on a damaged image is not `cairn`.
#include <cstdio>
#include <exception>
#include <string>

#include "datasets/tags/find_tags.h"

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("cairn-tags FAMILY: `cairn import bag --tags` calls it\n", stderr), 2;
  try {
    const cairn::datasets::TagDetector detector(argv[1]);
    std::string images;
    char piece[1 << 16];
    for (std::size_t n = 0; (n = std::fread(piece, 1, sizeof piece, stdin)) > 0;) images.append(piece, n);
    std::fputs(detector.FindInAll(images).c_str(), stdout);
  } catch (const std::exception& error) {
    std::printf("!!%s\n", error.what());  // stderr may be closed
  }
  return std::fflush(stdout) == 0 ? 0 : 1;
}
