// cairn-tags FAMILY: the tags in images on stdin, as TagDetector::FindInAll has both. A program of its own:
// its libraries are slow to load, and what crashes on a damaged image is not `cairn`.
#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <string_view>

#include "datasets/tags/find_tags.h"

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("cairn-tags FAMILY: `cairn import bag --tags` calls it\n", stderr), 2;
  // It goes with who called it, and writes to nothing but its stdout.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::close_range(STDERR_FILENO + 1, ~0U, 0);
  // No camera makes images of more pixels; OpenCV reads this as it is loaded.
  constexpr const char *kLimit = "OPENCV_IO_MAX_IMAGE_PIXELS", *kPixels = "67108864";
  const char* const limit = std::getenv(kLimit);
  if (limit == nullptr || std::string_view(limit) != kPixels) {
    ::setenv(kLimit, kPixels, 1);
    ::execv("/proc/self/exe", argv);
    return std::perror("cairn-tags: cannot bound the pixels of an image"), 1;
  }
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
