// cairn-images SIDE FILE…: for each image a line "ROWS COLUMNS" and its bytes of red, green, blue, or a line
// "!REASON"; SIDE as in decode_image.h. A program of its own: its libraries are slow to load, and what
// crashes on a damaged image is not `cairn`.
#include <cstdio>
#include <cstdlib>

#include "datasets/images/decode_image.h"

int main(int argc, char** argv) {
  const int most_side = argc > 1 ? std::atoi(argv[1]) : 0;
  if (most_side < 1)
    return std::fputs("cairn-images SIDE FILE...: `cairn import images` calls it\n", stderr), 2;
  for (int i = 2; i < argc; ++i) {
    const cairn::datasets::ImageReading image = cairn::datasets::DecodeImage(argv[i], most_side);
    if (!image.failure.empty()) {
      std::printf("!%s\n", image.failure.c_str());
      continue;
    }
    std::printf("%d %d\n", image.rows, image.columns);
    std::fwrite(image.rgb.data(), 1, image.rgb.size(), stdout);
  }
  return std::fflush(stdout) == 0 ? 0 : 1;
}
