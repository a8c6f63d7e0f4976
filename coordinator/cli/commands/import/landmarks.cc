#include <cmath>
#include <optional>

#include "coordinator/cli/commands/import/parts.h"
#include "coordinator/cli/common/result_file.h"
#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/output/path.h"
#include "datasets/detect/scan_landmarks.h"
#include "schema/error.h"

namespace cairn::cli {
namespace {

struct LandmarkArguments : ImportOutput {
  std::string log, poles, reflectors;
  datasets::ScanLandmarkOptions find;
};

// "0.05..0.6": metres.
std::optional<datasets::ScanLandmarkOptions::Widths> ParseWidths(const std::string& option,
                                                                 const std::string& text) {
  if (text.empty()) return std::nullopt;
  constexpr double kMost_m = 5;
  const std::size_t dots = std::min(text.find(".."), text.size());
  const auto least = ToReal(text.substr(0, dots)),
             most = ToReal(dots < text.size() ? text.substr(dots + 2) : "");
  if (!least || !most || !(*least >= 0 && *least < *most && *most <= kMost_m))
    throw InputError(option + " " + text + ": what is meant is LEAST..MOST in metres, such as 0.05..0.6");
  return {{*least, *most}};
}

int FindLandmarks(const LandmarkArguments& options, const Invocation&) {
  CheckOutputIsNoInput(options.out, {options.log});
  CheckOverwrite(options.out, options.force);
  datasets::ScanLandmarkOptions find = options.find;
  find.poles = ParseWidths("--poles", options.poles);
  find.reflectors = ParseWidths("--reflectors", options.reflectors);
  if (!find.poles && !find.reflectors)
    throw InputError("what to look for? --poles 0.05..0.6 or --reflectors 0.02..0.3, or both");
  Blob log = ReadResult(options.log, "log").blob;
  try {
    const datasets::ImportReport report = FindLandmarksInScans(find, &log);
    return StoreImport(options, std::move(log), report);
  } catch (const InputError& error) {
    throw InputError(options.log + ": " + error.what());
  }
}

}  // namespace

void AddLandmarks(Command app, Invocation& call) {
  Command command;
  const auto options = AddCommand<LandmarkArguments>(
      app, call, "landmarks", "Finds poles and reflectors in a log's laser scans, as landmarks",
      "cairn landmarks scans.h5 poles.h5 --poles 0.05..0.6", FindLandmarks, &command);
  command.Add("LOG.h5", options->log, "A log with scans of a laser").Required();
  command.Add("OUT.h5", options->out, "The file to write: the log, with observations of landmarks")
      .Required();
  command.Add("--poles", options->poles,
              "LEAST..MOST diameter, metres: what stands nearer than all beside it, and is round");
  command.Add("--reflectors", options->reflectors,
              "LEAST..MOST width, metres: what is brighter by far than else at its distance");
  command.Add("--least-scans", options->find.least_scans, "In which it is seen at one place, at least")
      .Within(1, 1000)
      .ShowDefault();
  command.Add("--least-s", options->find.least_s, "From the first of them to the last, at least; less moves")
      .NotNegative()
      .ShowDefault();
  command
      .Add("--every-m", options->find.every_m,
           "How far on the robot is when it counts the same landmark again")
      .NotNegative()
      .ShowDefault();
  command.AddFlag("--replace", options->find.replace, "Leave out the observations that the log has already");
  command.AddFlag("--force", options->force, "Replace OUT.h5 where it is there already");
  command.AddFlag("--json", options->json, "Say what was found and left out as JSON");
}

}  // namespace cairn::cli
