// cairn-images FILE…: a line for each image, its features with commas between, or "!" and why there are none.
// A program of its own: its libraries are slow to load, and what crashes on a damaged image is not `cairn`.
#include <cstdio>

#include "datasets/images/decode_image.h"
#include "schema/error.h"

namespace {

void PrintFeatures(const std::string& path) {
  using namespace cairn::datasets;
  try {
    const char* between = "";
    for (const float value : ImageFeatures(DecodeImage(path))) {
      std::printf("%s%.9g", between, static_cast<double>(value));
      between = ",";
    }
    std::puts("");
  } catch (const cairn::InputError& error) {
    std::printf("!%s\n", error.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) PrintFeatures(argv[i]);
  return std::fflush(stdout) == 0 ? 0 : 1;
}
