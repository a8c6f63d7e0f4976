#include <array>
#include <string_view>

#include "datasets/import/recorded/mrclam.h"
#include "tests/fuzz/gzip.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

struct File {
  const char* name;
  std::string_view good;
};
constexpr std::array<File, 7> kFiles{{
    {"Barcodes.dat", "# subject barcode\n1 5\n2 14\n6 72\n7 27\n"},
    {"Landmark_Groundtruth.dat", "6 1.5 -2.5 0.001 0.002\n7 0 3 0.001 0.002\n"},
    {"Robot1_Odometry.dat", "1.0 0.1 0\n2.0 0.1 0.5\n2.5 0 0\n"},
    {"Robot1_Measurement.dat", "1.5 72 2.0 0.3\n1.5 14 1.0 -0.5\n2.0 99 1 0.2\n"},
    {"Robot1_Groundtruth.dat", "1.0 0 0 0\n2.0 0.1 0 -3.5\n"},
    {"Robot2_Odometry.dat", "1.0 0.1 0\n9.0 0.1 0.5\n"},
    {"Robot2_Measurement.dat", "5.0 72 2.0 0.3\n"},
}};
constexpr std::uint8_t kSkipBad = 128, kGzip = 64, kWithhold = 32;

// Only the file that is fuzzed changes from run to run.
const ScratchFolder& Folder() {
  static const ScratchFolder folder;
  static const bool filled = [] {
    for (const File& file : kFiles) folder.Put(file.name, file.good);
    return true;
  }();
  static_cast<void>(filled);
  return folder;
}

Outcome Run(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return Outcome::kRefused;
  const std::uint8_t choice = bytes[0];
  const File& file = kFiles[(choice & 31) % kFiles.size()];
  const ScratchFolder& folder = Folder();
  const std::string_view text = AsText(bytes.subspan(1));
  folder.Put(file.name, (choice & kGzip) != 0 ? Gzip(text) : std::string(text));
  datasets::MrclamImportOptions options{
      folder.path().string(), (choice & kSkipBad) != 0, (choice & kWithhold) != 0, {}, false};
  Outcome outcome = Outcome::kAccepted;
  try {
    Blob log;
    datasets::ImportMrclam(options, &log);
    CAIRN_DEMAND(log.Texts("robots").size() == 2, "two robots have an odometry");
  } catch (const InputError&) {
    outcome = Outcome::kRefused;
  }
  folder.Put(file.name, file.good);
  return outcome;
}

std::vector<Bytes> Seeds() {
  std::vector<Bytes> seeds;
  for (std::size_t i = 0; i < kFiles.size(); ++i) {
    for (const std::uint8_t flags : {0, 0 + kSkipBad, 0 + kGzip, 0 + kWithhold}) {
      seeds.emplace_back(kFiles[i].good.begin(), kFiles[i].good.end());
      seeds.back().insert(seeds.back().begin(), static_cast<std::uint8_t>(i + flags));
    }
  }
  return seeds;
}

}  // namespace

Target MrclamTarget() { return {"mrclam", Run, Seeds, 2000}; }

}  // namespace cairn::fuzz
