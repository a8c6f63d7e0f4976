// What the import commands have in common.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "coordinator/cli/common/invocation.h"
#include "datasets/import/log_rows.h"
#include "schema/blob.h"
#include "schema/error.h"
#include "schema/geometry.h"

namespace cairn::cli {

struct ImportOutput {
  std::string out;
  bool force = false, json = false;
  bool units_are_right = false;  // read in what no robot does
};

// Refuses what no robot does, unless somebody insists. Writes the file; says what was read, skipped and left
// out, and what the file holds, for people or as JSON. Returns the exit code.
int StoreImport(const ImportOutput& output, Blob blob, const datasets::ImportReport& report,
                const char* kind = "log");
// Its two halves: the first gives what the file holds, the second says it.
std::string WriteImport(const ImportOutput& output, Blob blob, const datasets::ImportReport& report,
                        const char* kind = "log");
int TellImport(const ImportOutput& output, const std::string& content, const datasets::ImportReport& report,
               const char* kind = "log");

// Options for the noise parameters of the odometry, and of a sensor that sees landmarks.
void AddOdometryNoise(Command command, datasets::NoiseParameters& noise);
void AddSensorNoise(Command command, datasets::NoiseParameters& noise);

// Of "X,Y,DEGREES" or "ROBOT=X,Y,DEGREES", what `option` was given: where a sensor sits on its robot. Throws
// InputError.
std::pair<std::string, Pose> ParseMountOfRobot(const std::string& option, const std::string& text);
// Of "NAME=X,Y,DEGREES": where something sits on the robot. Throws InputError that says what is meant, such
// as `example`.
std::pair<std::string, Pose> ParseNamedMount(const std::string& text, const std::string& example);

// Throws InputError where `option` was given the same name before.
template <class T>
void AddOnce(const char* option, std::pair<std::string, T> one, std::map<std::string, T>* all) {
  if (!all->insert(one).second)
    throw InputError(std::string(option) + " is said twice" + (one.first.empty() ? "" : " of " + one.first));
}

inline constexpr char kUnitsAreRight[] = "--units-are-right";

// --max-text-mb.
void AddTextLimit(Command command);

// --skip-bad, --units-are-right, --max-text-mb, --force, --json, OUT.h5.
template <class Options>
void AddOutput(Command command, Options& options) {
  command.AddFlag("--skip-bad", options.import.skip_bad, "Skip bad lines and count them, by reason");
  command.AddFlag(kUnitsAreRight, options.units_are_right,
                  "Take in what no robot does (60 m/s, two turns a second), instead of asking for units");
  AddTextLimit(command);
  command.AddFlag("--force", options.force, "Replace OUT.h5 where it is there already");
  command.AddFlag("--json", options.json, "Say what was read, skipped and left out as JSON");
  command.Add("OUT.h5", options.out, "The file to write").Required();
}

// `cairn import bag`.
void AddBagImport(Command import, Invocation& call);
// `cairn import carmen` and the other recorded range logs.
void AddRangeImports(Command import, Invocation& call);

}  // namespace cairn::cli
