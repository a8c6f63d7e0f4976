// What libFuzzer calls. CAIRN_FUZZ_TARGET: one of targets.h.
//
//   fuzz_TARGET --seeds FOLDER     # writes the good inputs that long runs start from
#include <google/protobuf/stubs/logging.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "schema/error.h"
#include "tests/fuzz/targets.h"

namespace {

const cairn::fuzz::Target& Chosen() {
  static const cairn::fuzz::Target chosen = cairn::fuzz::CAIRN_FUZZ_TARGET();
  return chosen;
}

void WriteSeeds(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  int number = 0;
  for (const cairn::fuzz::Bytes& seed : Chosen().seeds())
    std::ofstream(folder / ("seed" + std::to_string(number++)), std::ios::binary)
        .write(reinterpret_cast<const char*>(seed.data()), static_cast<std::streamsize>(seed.size()));
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  google::protobuf::SetLogHandler(nullptr);  // it complains of each text that is no UTF-8
  if (*argc == 3 && std::string_view((*argv)[1]) == "--seeds") {
    WriteSeeds((*argv)[2]);
    std::exit(0);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static_cast<void>(Chosen().run({data, size}));
  return 0;
}
