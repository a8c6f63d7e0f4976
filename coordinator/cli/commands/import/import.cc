#include <cmath>
#include <map>
#include <utility>

#include "coordinator/cli/commands/import/image_reader.h"
#include "coordinator/cli/commands/import/parts.h"
#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/output/path.h"
#include "datasets/import/csv.h"
#include "datasets/import/errors.h"
#include "datasets/import/g2o.h"
#include "datasets/import/images.h"
#include "datasets/import/recorded/mrclam.h"
#include "datasets/import/recorded/recorded.h"
#include "datasets/import/vectors.h"

namespace cairn::cli {
namespace {

struct CsvOptions : ImportOutput {
  datasets::CsvImportOptions import;
  std::vector<std::string> mounts, late;
  bool drop_repeats = false, keep_repeats = false;
};

std::pair<std::string, double> ParseLateness(const std::string& text) {
  const std::size_t number = text.rfind('=') + 1;  // 0 where there is none
  const auto late_s = ToReal(text.substr(number));
  if (!late_s || !std::isfinite(*late_s) || number == 1)
    throw InputError("--sensor-late-s " + text + ": what is meant is SECONDS or ROBOT=SECONDS");
  return {number == 0 ? "" : text.substr(0, number - 1), *late_s};
}

int ImportCsv(const CsvOptions& options, const Invocation&) {
  const datasets::CsvImportOptions& files = options.import;
  CheckOutputIsNoInput(options.out, {files.odometry, files.observations, files.truth_poses,
                                     files.truth_landmarks, files.truth_associations});
  CheckOverwrite(options.out, options.force);
  datasets::CsvImportOptions import = files;
  for (const std::string& mount : options.mounts)
    AddOnce("--sensor-mount", ParseMountOfRobot("--sensor-mount", mount), &import.mounts);
  for (const std::string& late : options.late)
    AddOnce("--sensor-late-s", ParseLateness(late), &import.late_s);
  using datasets::RepeatedSteps;
  if (options.drop_repeats) import.repeated_steps = RepeatedSteps::kCopies;
  if (options.keep_repeats) import.repeated_steps = RepeatedSteps::kMotion;
  Blob log;
  const datasets::ImportReport report = datasets::ImportCsv(import, &log);
  return StoreImport(options, log, report);
}

struct MrclamOptions : ImportOutput {
  datasets::MrclamImportOptions import;
};

struct RecordedOptions : ImportOutput {
  datasets::RecordedImportOptions import;
};

int ImportMrclam(const MrclamOptions& options, const Invocation&) {
  CheckOutputIsNotInDataset(options.out, options.import.folder);
  CheckOverwrite(options.out, options.force);
  Blob log;
  const datasets::ImportReport report = datasets::ImportMrclam(options.import, &log);
  return StoreImport(options, log, report);
}

template <datasets::ImportReport (*Import)(const datasets::RecordedImportOptions&, Blob*)>
int ImportRecorded(const RecordedOptions& options, const Invocation&) {
  CheckOutputIsNotInDataset(options.out, options.import.folder);
  CheckOverwrite(options.out, options.force);
  Blob log;
  const datasets::ImportReport report = Import(options.import, &log);
  return StoreImport(options, log, report);
}

struct G2oOptions : ImportOutput {
  datasets::G2oImportOptions import;
};

int ImportG2o(const G2oOptions& options, const Invocation&) {
  CheckOutputIsNoInput(options.out, {options.import.file});
  CheckOverwrite(options.out, options.force);
  Blob log;
  const datasets::ImportReport report = datasets::ImportG2o(options.import, &log);
  return StoreImport(options, log, report);
}

struct VectorsOptions : ImportOutput {
  datasets::VectorsImportOptions import;
};

int ImportVectors(const VectorsOptions& options, const Invocation&) {
  CheckOutputIsNoInput(options.out, options.import.runs);
  CheckOverwrite(options.out, options.force);
  Blob samples;
  const datasets::ImportReport report = datasets::ImportVectors(options.import, &samples);
  return StoreImport(options, samples, report, "samples");
}

struct ErrorsOptions : ImportOutput {
  datasets::ErrorsImportOptions import;
};

int ImportErrors(const ErrorsOptions& options, const Invocation&) {
  CheckOutputIsNoInput(options.out, {options.import.file});
  CheckOverwrite(options.out, options.force);
  Blob errors;
  const datasets::ImportReport report = datasets::ImportErrors(options.import, &errors);
  return StoreImport(options, errors, report, "errors");
}

struct ImagesOptions : ImportOutput {
  datasets::ImagesImportOptions import;
  std::vector<std::string> tables;  // poses, and it may be ranges
  int most_side = 640;
};

int ImportImages(const ImagesOptions& options, const Invocation&) {
  datasets::ImagesImportOptions import = options.import;
  import.poses = options.tables.front();
  if (options.tables.size() > 1) import.ranges = options.tables.back();
  CheckOutputIsNoInput(options.out, {import.poses, import.ranges, import.times});
  CheckOverwrite(options.out, options.force);
  const auto read = [&](const auto& paths) { return ReadImagesElsewhere(paths, options.most_side); };
  Blob samples;
  const datasets::ImportReport report = datasets::ImportImages(import, read, &samples);
  return StoreImport(options, samples, report, "samples");
}

void AddNoiseOptions(Command command, datasets::NoiseParameters& noise) {
  AddOdometryNoise(command, noise);
  AddSensorNoise(command, noise);
}

void AddCsv(Command import, Invocation& call) {
  Command command;
  const auto options = AddCommand<CsvOptions>(
      import, call, "csv", "Your own logs, plain or gzipped (docs/my-own-log.md)",
      "cairn import csv --odometry odometry.csv --observations observations.csv log.h5", ImportCsv, &command);
  datasets::CsvImportOptions& files = options->import;
  command
      .Add("--odometry", files.odometry,
           "time_s,robot,turn_rad,forward_m or time_s,robot,v_mps,omega_radps or "
           "time_s,robot,x_m,y_m,heading_rad; also in _ms, _mm, _deg and the like")
      .Required();
  command.Add("--observations", files.observations, "time_s,robot,landmark,range_m,bearing_rad");
  command.Add("--truth-poses", files.truth_poses, "time_s,robot,x_m,y_m,heading_rad");
  command.Add("--truth-landmarks", files.truth_landmarks, "landmark,x_m,y_m");
  command.Add("--truth-associations", files.truth_associations, "time_s,robot,landmark");
  command
      .Add("--sensor-mount", options->mounts,
           "[ROBOT=]X,Y,DEGREES: the observations are by a sensor so many metres ahead of the robot's centre "
           "and to its left, turned to the left; again for another robot")
      .OneEachTime();
  command
      .Add("--sensor-late-s", options->late,
           "[ROBOT=]SECONDS: the times of the observations are so much too late by the odometry's clock "
           "(early: below 0); again for another robot")
      .OneEachTime();
  const Argument drop = command.AddFlag(
      "--drop-repeats", options->drop_repeats,
      "Leave out rows turn_rad,forward_m that are the same as another of their time, instead of finding out "
      "whether they are copies");
  command
      .AddFlag("--keep-repeats", options->keep_repeats,
               "Such rows are motion: the robot did so again within one time stamp")
      .Excludes(drop);
  command.AddFlag("--steps-are-arcs", files.steps_are_arcs,
                  "Rows turn_rad,forward_m are of a robot that turns while it goes (wheels that are read at "
                  "intervals), instead of first the turn, then the way");
  AddNoiseOptions(command, files.noise);
  AddOutput(command, *options);
}

void AddMrclam(Command import, Invocation& call) {
  Command command;
  const auto options =
      AddCommand<MrclamOptions>(import, call, "mrclam", "UTIAS multi-robot logs (docs/datasets.md)",
                                "cairn import mrclam MRCLAM_Dataset6 mrclam6.h5", ImportMrclam, &command);
  command.Add("FOLDER", options->import.folder, "One dataset: its .dat files, plain or gzipped").Required();
  command.AddFlag("--withhold-identities", options->import.withhold_identities,
                  "Do not tell which landmark an observation is of; the truth still does");
  command.AddFlag("--robots-as-clutter", options->import.robots_as_clutter,
                  "Robots that are seen become observations of nothing, instead of observations of robots");
  AddNoiseOptions(command, options->import.noise);
  AddOutput(command, *options);
}

void AddG2o(Command import, Invocation& call) {
  Command command;
  const auto options = AddCommand<G2oOptions>(
      import, call, "g2o", "A pose graph of the plane, as odometry and landmarks (docs/datasets.md)",
      "cairn import g2o graph.g2o log.h5", ImportG2o, &command);
  command.Add("GRAPH.g2o", options->import.file, "EDGE_SE2 and EDGE_SE2_XY; plain or gzipped").Required();
  command
      .Add("--step-s", options->import.step_s, "Seconds from each pose to the next, as a graph has no times")
      .Within(1e-6, 1e6)
      .ShowDefault();
  AddNoiseOptions(command, options->import.noise);
  AddOutput(command, *options);
}

void AddVectors(Command import, Invocation& call) {
  Command command;
  const auto options = AddCommand<VectorsOptions>(
      import, call, "vectors", "Any sensor's vectors with their poses, a file a run (docs/datasets.md)",
      "cairn import vectors monday.csv tuesday.csv.gz samples.h5", ImportVectors, &command);
  command.PlaceByChecks();  // by their endings: any number of runs, then the one to write
  command
      .Add("RUN.csv", options->import.runs,
           "A run, plain or gzipped: time_s,x_m,y_m[,heading_rad], any other column an input")
      .Required()
      .Check([](const std::string& name) { return name.ends_with(".h5") ? "a run is a CSV file" : ""; });
  AddOutput(command, *options);
}

void AddErrors(Command import, Invocation& call) {
  Command command;
  const auto options = AddCommand<ErrorsOptions>(
      import, call, "errors", "What it costs to take one place for another (docs/datasets.md)",
      "cairn import errors costs.csv errors.h5", ImportErrors, &command);
  command
      .Add("TABLE.csv", options->import.file,
           "A row for each true place: x_m,y_m, then a column for each believed one, in the order of "
           "the rows")
      .Required();
  command.AddFlag("--force", options->force, "Replace OUT.h5 where it is there already");
  command.AddFlag("--json", options->json, "Say what was read as JSON");
  command.Add("OUT.h5", options->out, "The file to write").Required();
}

void AddImages(Command import, Invocation& call) {
  Command command;
  const auto options = AddCommand<ImagesOptions>(
      import, call, "images", "A folder of images with a table of poses (docs/datasets.md)",
      "cairn import images snapshots poses.csv images.h5", ImportImages, &command);
  command.PlaceByChecks();  // by their endings: one table or two, then the file to write
  command.Add("FOLDER", options->import.folder, "PNG, JPEG and PPM images").Required();
  command
      .Add("TABLE.csv", options->tables,
           "Poses: image,time_s,x_m,y_m[,heading_rad][,run], any other column an input; or a track, "
           "with --times. Then, where there are, ranges: time_s[,run], any other column an input")
      .Required()
      .Words(1, 2)
      .Check([](const std::string& name) { return name.ends_with(".h5") ? "a table is a CSV file" : ""; });
  const Argument times = command.Add("--times", options->import.times,
                                     "image,time_s[,run] for images whose poses are those of a track: "
                                     "time_s,x_m,y_m[,heading_rad][,run]");
  command.Add("--smooth-s", options->import.smooth_s, "Take the mean of the track over so many seconds")
      .NotNegative()
      .Needs(times);
  command
      .Add("--most-gap-s", options->import.most_gap_s,
           "How far rows of a track may lie apart, and ranges from an image")
      .NotNegative()
      .ShowDefault();
  command
      .Add("--most-side", options->most_side,
           "Larger images are made smaller by a whole number, so that no side has more pixels")
      .Within(1, 100000)
      .ShowDefault();
  AddOutput(command, *options);
}

template <datasets::ImportReport (*Import)(const datasets::RecordedImportOptions&, Blob*)>
void AddRecorded(Command import, Invocation& call, const char* name, const char* what, const char* example) {
  Command command;
  const auto options =
      AddCommand<RecordedOptions>(import, call, name, what, example, ImportRecorded<Import>, &command);
  command.Add("FOLDER", options->import.folder, "Its files, plain or gzipped").Required();
  command.AddFlag(
      "--scans", options->import.scans,
      "Take the laser's scans, instead of the landmarks that the recording's makers found in them");
  AddNoiseOptions(command, options->import.noise);
  AddOutput(command, *options);
}

}  // namespace

void AddImport(Command app, Invocation& call) {
  Command import = app.AddCommand("import", "Reads real logs into Cairn's format");
  import.NeedsCommand();
  import.Footer(
      "Example:\n  cairn import csv --odometry odometry.csv --observations observations.csv log.h5");
  AddCsv(import, call);
  AddBagImport(import, call);
  AddMrclam(import, call);
  AddG2o(import, call);
  AddVectors(import, call);
  AddImages(import, call);
  AddErrors(import, call);
  AddRecorded<datasets::ImportLegoRobot>(import, call, "lego-robot",
                                         "The LEGO robot among six poles (docs/datasets.md)",
                                         "cairn import lego-robot lego-robot lego.h5");
  AddRecorded<datasets::ImportVictoriaPark>(import, call, "victoria-park",
                                            "Victoria Park, Sydney: a car among trees (docs/datasets.md)",
                                            "cairn import victoria-park victoria-park park.h5");
  AddRangeImports(import, call);
}

}  // namespace cairn::cli
