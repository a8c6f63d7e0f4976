// The small readers of range logs, trajectories and relations: one text for each of them.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "datasets/evaluate/relations.h"
#include "datasets/import/g2o.h"
#include "datasets/import/recorded/ranges.h"
#include "datasets/import/trajectories.h"
#include "tests/fuzz/gzip.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

enum Reader : std::uint8_t {
  kDpSlam,
  kWean,
  kTum,
  kRelations,
  kPioneerPoses,
  kPioneerSonar,
  kKitti,
  kEuroc,
  kG2o,
  kReaders
};
constexpr std::uint8_t kSkipBad = 128, kGzip = 64;

std::string PioneerRow(int values) {
  std::string row = "1000";
  for (int i = 0; i < values; ++i) row += " 900";
  return row + "\n";
}

// A folder of a Pioneer's, of which only the file that is fuzzed changes from run to run.
const ScratchFolder& Pioneer() {
  static const ScratchFolder folder;
  static const bool filled = [] {
    folder.Put("od.txt", "1000 0 0 0\n");
    folder.Put("sonar.txt", PioneerRow(8));
    folder.Put("laser.txt", PioneerRow(361));
    return true;
  }();
  static_cast<void>(filled);
  return folder;
}

void CheckColumns(const Blob& blob) {
  for (const auto& [name, array] : blob.fields()) {
    if (array.type() != DType::kF64 || name.ends_with("/range_m") || name.ends_with("/bearing_rad")) continue;
    const auto values = blob.Get<double>(name);
    CAIRN_DEMAND(std::ranges::all_of(values, [](double v) { return std::isfinite(v); }),
                 name + " is not finite");
    CAIRN_DEMAND(!name.ends_with("time_s") || std::ranges::is_sorted(values), name + " runs backwards");
  }
}

Blob ImportFolder(const char* file, std::string_view text, bool skip_bad) {
  const ScratchFolder& folder = Pioneer();
  folder.Put(file, text);
  Blob log;
  try {
    datasets::ImportPioneer({folder.path().string(), skip_bad, {}}, &log);
  } catch (const InputError&) {
    folder.Put(file, std::string_view(file) == "od.txt" ? "1000 0 0 0\n" : PioneerRow(8));
    throw;
  }
  folder.Put(file, std::string_view(file) == "od.txt" ? "1000 0 0 0\n" : PioneerRow(8));
  return log;
}

Blob Import(std::uint8_t reader, const std::string& text, bool skip_bad) {
  if (reader == kPioneerPoses) return ImportFolder("od.txt", text, skip_bad);
  if (reader == kPioneerSonar) return ImportFolder("sonar.txt", text, skip_bad);
  const MemoryFile file(text);
  Blob blob;
  if (reader == kDpSlam) datasets::ImportDpSlam({file.path(), skip_bad, {}}, &blob);
  if (reader == kWean) datasets::ImportWean({file.path(), skip_bad, {}}, &blob);
  if (reader == kTum) datasets::ImportTrajectories({{file.path()}, {}, skip_bad}, &blob);
  if (reader == kKitti || reader == kEuroc) {
    using Format = datasets::TrajectoryImportOptions::Format;
    const MemoryFile times("0\n1\n2.5\n");
    datasets::ImportTrajectories({.files = {file.path()},
                                  .skip_bad = skip_bad,
                                  .format = reader == kKitti ? Format::kKitti : Format::kEuroc,
                                  .times = {times.path()},
                                  .camera_axes = skip_bad},
                                 &blob);
  }
  if (reader == kG2o) datasets::ImportG2o({.file = file.path(), .skip_bad = skip_bad}, &blob);
  if (reader == kRelations) {
    const datasets::Track track{{0, 1e6}, {{0, 0, 0}, {1, 1, 1}}};
    const auto score = datasets::ScoreRelations(track, datasets::ReadRelations(file.path()), 0);
    CAIRN_DEMAND(std::isfinite(score.rotation_deg) && score.rotation_deg <= 180.001, "no mean error");
  }
  return blob;
}

Outcome Run(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return Outcome::kRefused;
  const std::string_view text = AsText(bytes.subspan(1));
  try {
    CheckColumns(Import((bytes[0] & 63U) % kReaders, (bytes[0] & kGzip) != 0 ? Gzip(text) : std::string(text),
                        (bytes[0] & kSkipBad) != 0));
  } catch (const InputError&) {
    return Outcome::kRefused;
  }
  return Outcome::kAccepted;
}

std::vector<Bytes> Seeds() {
  std::string wean = "O 0 0 0 0.1\nL 100 0 0 125 0 0";
  for (int beam = 0; beam < 180; ++beam) wean += " 200";
  const std::array<std::string, kReaders> good{
      "Odometry 1 0 0\nLaser 3 1 8.191 2\nOdometry 2 0 0.5\nLaser 3 1 2 3\n",
      wean + " 0.2\n",
      "# t\n1 2 3 0 0 0 0 1\n2 3 4 0 0 0 0.6 0.8\n3 1 1 0.5\n",
      "1 2 0.5 -0.1 0 0 0 3.5\n3 4 0 0 0 0 0 0\n",
      "1000 10 20 3599\n",
      PioneerRow(8),
      "1 0 0 0 0 1 0 0 0 0 1 0\n0 0 -1 -2 0 1 0 0 1 0 0 5\n1 0 0 3 0 1 0 0 0 0 1 0\n",
      "#timestamp, x\n1000,1,2,0,1,0,0,0,nan\n2000000000,1,2,0,0.6,0,0,0.8,nan\n",
      "VERTEX_SE2 0 0 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 2 1 1 0 3 1 0 0 1 0 1\n"
      "EDGE_SE2_XY 1 9 1 2 1 0 1\nEDGE_SE2_XY 2 9 0 0 1 0 1\nEDGE_SE2 0 2 1 1 1 1 0 0 1 0 1\n"};
  std::vector<Bytes> seeds;
  for (std::uint8_t reader = 0; reader < kReaders; ++reader) {
    for (const std::uint8_t flags : {0, 0 + kSkipBad, 0 + kGzip}) {
      seeds.emplace_back(good[reader].begin(), good[reader].end());
      seeds.back().insert(seeds.back().begin(), static_cast<std::uint8_t>(reader + flags));
    }
  }
  return seeds;
}

}  // namespace

Target RangesTarget() { return {"ranges", Run, Seeds, 4000}; }

}  // namespace cairn::fuzz
