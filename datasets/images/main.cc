// cairn-images SIDE FILE…: for each image a line "ROWS COLUMNS" and its bytes of red, green, blue, or a line
// "!REASON"; SIDE as in decode_image.h. Once they take a quarter of a gigabyte it ends: whoever calls it asks
// again for the others. A program of its own: its libraries are slow to load, and what crashes on a damaged
// image is not `cairn`.
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "datasets/images/decode_image.h"

constexpr std::size_t kMostBytes = std::size_t{1} << 28;

int main(int argc, char** argv) {
  const int most_side = argc > 1 ? std::atoi(argv[1]) : 0;
  if (most_side < 1)
    return std::fputs("cairn-images SIDE FILE...: `cairn import images` calls it\n", stderr), 2;
  const std::vector<std::string> paths(argv + 2, argv + argc);
  for (const cairn::datasets::ImageReading& image :
       cairn::datasets::DecodeImages(paths, most_side, kMostBytes)) {
    if (!image.failure.empty()) {
      std::printf("!%s\n", image.failure.c_str());
      continue;
    }
    std::printf("%d %d\n", image.rows, image.columns);
    std::fwrite(image.rgb.data(), 1, image.rgb.size(), stdout);
  }
  return std::fflush(stdout) == 0 ? 0 : 1;
}
