#include "datasets/import/recorded/ranges.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "coordinator/cli/commands/import/parts.h"
#include "coordinator/cli/output/path.h"
#include "datasets/import/recorded/carmen.h"
#include "datasets/import/trajectories.h"
#include "schema/error.h"

namespace cairn::cli {
namespace {

struct CarmenOptions : ImportOutput {
  datasets::CarmenImportOptions import;
  std::vector<std::string> mounts;
  bool corrected = false, raw = false;
};

std::pair<std::string, Pose> ParseLaserMount(const std::string& text) {
  std::pair<std::string, Pose> mount = ParseNamedMount(text, "laser2=-0.2,0,180");
  constexpr std::array kLasers = {"laser", "laser2", "laser3", "laser4", "laser5"};
  if (std::ranges::find(kLasers, mount.first) == kLasers.end())
    throw InputError("--mount " + text + ": a CARMEN log has the lasers laser, laser2 (rear), … laser5");
  return mount;
}

int ImportCarmen(const CarmenOptions& options, const Invocation&) {
  using Poses = datasets::CarmenImportOptions::Poses;
  CheckOutputIsNoInput(options.out, {options.import.path});
  CheckOverwrite(options.out, options.force);
  datasets::CarmenImportOptions import = options.import;
  if (options.corrected) import.poses = Poses::kCorrected;
  if (options.raw) import.poses = Poses::kRaw;
  for (const std::string& mount : options.mounts) AddOnce("--mount", ParseLaserMount(mount), &import.mounts);
  Blob log;
  const datasets::ImportReport report = datasets::ImportCarmen(import, &log);
  return StoreImport(options, log, report);
}

void AddCarmen(Command import, Invocation& call) {
  Command command;
  const auto options = AddCommand<CarmenOptions>(
      import, call, "carmen", "Logs of CARMEN: lasers, sonars, odometry (docs/datasets.md)",
      "cairn import carmen intel.log.gz intel.h5", ImportCarmen, &command);
  datasets::CarmenImportOptions& log = options->import;
  command.Add("LOG", log.path, "The log, plain or gzipped").Required();
  const Argument corrected = command.AddFlag("--corrected", options->corrected,
                                             "Its poses were mended by a program (else detected)");
  command.AddFlag("--raw", options->raw, "Its poses are odometry").Excludes(corrected);
  command.AddFlag("--numbered", log.numbered, "Time is a line's number, not its time stamp");
  command.AddFlag("--named-markers", log.named_markers,
                  "Markers of the same text are at the same landmark; else nothing tells landmarks apart");
  command.Add("--laser-first-deg", log.first_deg,
              "Where the first beam points; for messages that do not say it (-90)");
  command.Add("--laser-step-deg", log.step_deg, "Angle from beam to beam; likewise").Within(1e-3, 180.0);
  command.Add("--laser-max-range-m", log.max_range_m, "Reach: from there on nothing was met")
      .Within(1e-3, 1e3);
  command.Add("--sonar-max-range-m", log.sonar_max_range_m, "The same of the sonars").Within(1e-3, 1e3);
  command
      .Add("--mount", options->mounts,
           "Where a laser sits, SENSOR=X,Y,DEGREES on the robot, for laser, laser2 (rear), … (again: "
           "of several)")
      .OneEachTime();
  AddOdometryNoise(command, log.noise);
  AddOutput(command, *options);
}

struct RangeOptions : ImportOutput {
  datasets::RangeImportOptions import;
};

template <datasets::ImportReport (*Import)(const datasets::RangeImportOptions&, Blob*)>
int ImportRanges(const RangeOptions& options, const Invocation&) {
  CheckOutputIsNoInput(options.out, {options.import.path});
  CheckOutputIsNotInDataset(options.out, options.import.path);
  CheckOverwrite(options.out, options.force);
  Blob log;
  const datasets::ImportReport report = Import(options.import, &log);
  return StoreImport(options, log, report);
}

template <datasets::ImportReport (*Import)(const datasets::RangeImportOptions&, Blob*)>
void AddRanges(Command import, Invocation& call, const char* name, const char* what, const char* source,
               const char* example) {
  Command command;
  const auto options =
      AddCommand<RangeOptions>(import, call, name, what, example, ImportRanges<Import>, &command);
  command.Add(source, options->import.path, "What to read, plain or gzipped").Required();
  AddOdometryNoise(command, options->import.noise);
  AddOutput(command, *options);
}

struct TrajectoryOptions : ImportOutput {
  datasets::TrajectoryImportOptions import;
};

int ReadTrajectories(const TrajectoryOptions& options, const Invocation&) {
  CheckOutputIsNoInput(options.out, options.import.files);
  CheckOutputIsNoInput(options.out, options.import.times);
  CheckOverwrite(options.out, options.force);
  Blob poses;
  const datasets::ImportReport report = datasets::ImportTrajectories(options.import, &poses);
  return StoreImport(options, poses, report, "poses");
}

struct TrajectoryFormat {
  datasets::TrajectoryImportOptions::Format format;
  const char* name;
  const char* help;
  const char* lines;
  const char* example;
};

constexpr TrajectoryFormat kTrajectoryFormats[] = {
    {datasets::TrajectoryImportOptions::Format::kTum, "tum",
     "Trajectories, a file a robot, as a table of poses",
     "Lines of 'time x y z qx qy qz qw' (as evo reads them) or 'time x y heading'; plain or gzipped",
     "cairn import tum trajectories/robot.tum poses.h5"},
    {datasets::TrajectoryImportOptions::Format::kKitti, "kitti", "The same of KITTI's, with files of times",
     "Lines of 12 numbers, the upper three rows of a pose's matrix; plain or gzipped",
     "cairn import kitti 00.txt --times times.txt --camera-axes poses.h5"},
    {datasets::TrajectoryImportOptions::Format::kEuroc, "euroc", "The same of EuRoC's",
     "CSV of nanoseconds, position, quaternion (w first), and more that is not looked at; plain or gzipped",
     "cairn import euroc data.csv --robot robot poses.h5"},
};

void AddTrajectories(Command import, Invocation& call, const TrajectoryFormat& format) {
  Command command;
  const auto options = AddCommand<TrajectoryOptions>(import, call, format.name, format.help, format.example,
                                                     ReadTrajectories, &command);
  options->import.format = format.format;
  command.PlaceByChecks();  // by their endings: any number of trajectories, then the file to write
  command.Add("FILE", options->import.files, format.lines).Required().Check([](const std::string& name) {
    return name.ends_with(".h5") ? "a trajectory is a text" : "";
  });
  command.Add("--robot", options->import.robots,
              "The robot's name, as the log has it (again: of each file; else named after the files)");
  if (format.format == datasets::TrajectoryImportOptions::Format::kKitti) {
    command
        .Add("--times", options->import.times, "The poses' times, seconds, a line each (again: of each FILE)")
        .OneEachTime()
        .Required();
    command.AddFlag("--camera-axes", options->import.camera_axes,
                    "Poses are a camera's, as KITTI's own: x to the right, y down, z ahead. Else z is up");
  }
  AddOutput(command, *options);
}

}  // namespace

void AddRangeImports(Command import, Invocation& call) {
  AddCarmen(import, call);
  AddRanges<datasets::ImportPioneer>(import, call, "pioneer",
                                     "A Pioneer robot's sonars and laser (docs/datasets.md)", "FOLDER",
                                     "cairn import pioneer run1 run1.h5");
  AddRanges<datasets::ImportDpSlam>(import, call, "dpslam", "Laser logs of DP-SLAM (docs/datasets.md)", "LOG",
                                    "cairn import dpslam loop5.log.gz loop5.h5");
  AddRanges<datasets::ImportWean>(import, call, "wean", "Laser logs of Wean Hall (docs/datasets.md)", "LOG",
                                  "cairn import wean robotdata1.log.gz wean1.h5");
  for (const TrajectoryFormat& format : kTrajectoryFormats) AddTrajectories(import, call, format);
}

}  // namespace cairn::cli
