#include "coordinator/cli/commands/import/parts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/job_file/inputs.h"
#include "coordinator/cli/output/path.h"
#include "coordinator/cli/output/plan_text.h"
#include "datasets/common/text_file.h"
#include "datasets/common/unit_doubts.h"
#include "schema/kinds/kind.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

constexpr std::size_t kMostLine = 10'000;  // what an import says quotes names of strangers

void PrintCounts(const char* verb, const std::map<std::string, std::int64_t>& counts) {
  for (const auto& [reason, count] : counts) {
    std::fprintf(stderr, "cairn: %s %lld: %s\n", verb, static_cast<long long>(count),
                 Printable(reason, kMostLine).c_str());
  }
}

void PrintLines(const char* what, const std::vector<std::string>& lines) {
  for (const std::string& line : lines)
    std::fprintf(stderr, "cairn: %s: %s\n", what, Printable(line, kMostLine).c_str());
}

void AddNoiseOption(Command command, const char* flag, std::optional<double>& field, const char* help) {
  command.Add(flag, field, help).NotNegative().Heading("Noise parameters (else estimated)");
}

}  // namespace

int StoreImport(const ImportOutput& output, Blob blob, const datasets::ImportReport& report,
                const char* kind) {
  return TellImport(output, WriteImport(output, std::move(blob), report, kind), report, kind);
}

std::string WriteImport(const ImportOutput& output, Blob blob, const datasets::ImportReport& report,
                        const char* kind) {
  if (const Status texts = CheckTexts(blob); !texts.ok()) throw InputError(texts.message());
  if (!report.unit_doubts.empty() && !output.units_are_right) CheckUnits("", report.unit_doubts);
  CheckKind(blob, kind);
  // The mapping asks more than an import does: insisting counts there, too.
  if (output.units_are_right) datasets::NoteUnitsAreRight(&blob);
  WriteOutput(output.out, kind, blob, output.force);
  return ContentText(blob);
}

int TellImport(const ImportOutput& output, const std::string& content, const datasets::ImportReport& report,
               const char* kind) {
  PrintLines("warning", report.unit_doubts);
  if (output.json) {
    const nlohmann::ordered_json json = {{"file", output.out},         {"kind", kind},
                                         {"content", content},         {"read", report.read},
                                         {"skipped", report.skipped},  {"left_out", report.dropped},
                                         {"warnings", report.warnings}};
    std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
    return kExitDone;
  }
  PrintLines("warning", report.warnings);
  PrintCounts("read", report.read);
  PrintCounts("skipped", report.skipped);
  PrintCounts("left out", report.dropped);
  std::printf("%s: %s\n", output.out.c_str(), content.c_str());
  return kExitDone;
}

namespace {

std::optional<Pose> MountIn(std::string_view text) {
  std::vector<double> numbers;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const auto number = ToReal(std::string(text.substr(at, end - at)));
    if (!number || !std::isfinite(*number)) return std::nullopt;
    numbers.push_back(*number);
    at = end + 1;
  }
  if (numbers.size() != 3) return std::nullopt;
  return Pose{numbers[0], numbers[1], numbers[2] * std::numbers::pi / 180};
}

}  // namespace

std::pair<std::string, Pose> ParseMountOfRobot(const std::string& option, const std::string& text) {
  const std::size_t place = text.rfind('=') + 1;  // 0 where there is none
  const auto mount = MountIn(std::string_view(text).substr(place));
  if (!mount || place == 1)
    throw InputError(option + " " + text +
                     ": what is meant is X,Y,DEGREES or ROBOT=X,Y,DEGREES: metres ahead and to the left, "
                     "degrees to the left");
  return {place == 0 ? "" : text.substr(0, place - 1), *mount};
}

std::pair<std::string, Pose> ParseNamedMount(const std::string& text, const std::string& example) {
  const std::size_t equals = std::min(text.rfind('='), text.size());
  const auto mount = equals < text.size() ? MountIn(std::string_view(text).substr(equals + 1)) : std::nullopt;
  if (!mount || equals == 0)
    throw InputError("--mount " + text + ": what is meant is SENSOR=X,Y,DEGREES, such as " + example);
  return {text.substr(0, equals), *mount};
}

void AddTextLimit(Command command) {
  command
      .AddTaking<std::uint64_t>(
          "--max-text-mb",
          [](std::uint64_t mb) { datasets::SetTextLimits({.file_bytes = mb << 20, .line_bytes = mb << 14}); },
          "What a text file may hold, unpacked (1024); a line of it a 64th of that")
      .Within(std::uint64_t{1}, std::uint64_t{1} << 30);
}

void AddOdometryNoise(Command command, datasets::NoiseParameters& noise) {
  AddNoiseOption(command, "--heading-drift-rad-per-m", noise.heading_drift_rad_per_m,
                 "sd of a constant drift of the heading");
  AddNoiseOption(command, "--heading-walk-rad-per-sqrt-m", noise.heading_walk_rad_per_sqrt_m,
                 "sd of the heading's random walk");
  AddNoiseOption(command, "--forward-ratio", noise.forward_ratio,
                 "sd of the distance's error, a fraction of the distance");
  AddNoiseOption(command, "--turn-ratio", noise.turn_ratio, "sd of a turn's error, a fraction of the turn");
}

void AddSensorNoise(Command command, datasets::NoiseParameters& noise) {
  AddNoiseOption(command, "--contact-m", noise.contact_m,
                 "sd of the distance between robot and landmark at a contact detection, an axis");
  AddNoiseOption(command, "--range-m", noise.range_m, "sd of a range");
  AddNoiseOption(command, "--bearing-rad", noise.bearing_rad, "sd of a bearing");
  AddNoiseOption(
      command, "--false-ratio", noise.false_ratio,
      "share of the observations that are of nothing, 0 to 1 (0.02: one in fifty); what is seen at a "
      "distance is told by where it falls, whatever this says, which the verdict holds against it");
  AddNoiseOption(command, "--miss-ratio", noise.miss_ratio,
                 "share of the landmarks that are passed, or in view, and not observed, 0 to 1");
  AddNoiseOption(command, "--max-range-m", noise.max_range_m,
                 "largest range of the sensor; larger ones are bad lines");
  AddNoiseOption(command, "--field-of-view-rad", noise.field_of_view_rad,
                 "full angle that the sensor sees, centred ahead; bearings outside it are bad lines");
}

}  // namespace cairn::cli
