#include "datasets/export/export.h"

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "coordinator/cli/commands/folder_jobs.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/result_file.h"
#include "datasets/kinds/result_kinds.h"
#include "schema/kinds/kind.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

struct Format;

struct ExportArguments {
  bool changed = false;
  const Format* format = nullptr;  // set by the subcommand
  std::string from;
  std::string folder;
  std::string log;  // g2o only
  bool landmarks_as_poses = false;
  std::string mode = "trinary";  // ros only
  datasets::GeoOrigin origin;    // geojson only
  bool force = false;
  bool json = false;
};

datasets::RosMode ModeOf(const std::string& mode) {
  if (mode == "scale") return datasets::RosMode::kScale;
  return mode == "raw" ? datasets::RosMode::kRaw : datasets::RosMode::kTrinary;
}

datasets::Written WriteG2o(const ExportArguments& options, const Blob& blob) {
  const auto landmarks =
      options.landmarks_as_poses ? datasets::G2oLandmarks::kPoses : datasets::G2oLandmarks::kPoints;
  if (options.log.empty())
    return datasets::ExportG2o(blob, nullptr, options.folder, options.force, landmarks);
  const Blob log = ReadResult(options.log, "log", options.changed).blob;
  return datasets::ExportG2o(blob, &log, options.folder, options.force, landmarks);
}

template <datasets::Written (*Export)(const Blob&, const std::string&, bool)>
datasets::Written WriteBy(const ExportArguments& options, const Blob& blob) {
  return Export(blob, options.folder, options.force);
}

struct Format {
  const char* name;
  const char* help;
  const char* holds;  // what its files do; empty: as they are called
  datasets::Written (*write)(const ExportArguments& options, const Blob& blob);
  bool is_for_planning = false;
};

// In the order in which people are shown them.
constexpr Format kFormats[] = {
    {"tum", "Trajectories, a file a robot, as TUM's tools and evo read them", "trajectory",
     WriteBy<datasets::ExportTum>},
    {"kitti", "Trajectories as KITTI's: a pose's matrix a line, and times beside them", "trajectory",
     WriteBy<datasets::ExportKitti>},
    {"euroc", "Trajectories as EuRoC's: CSV by nanoseconds", "trajectory", WriteBy<datasets::ExportEuroc>},
    {"g2o", "Poses, landmarks and their edges as a graph", "graph", WriteG2o},
    {"mcap", "Map, landmarks and paths as Foxglove and Rerun show them", "messages",
     WriteBy<datasets::ExportMcap>},
    {"ros", "The map as map_server of ROS reads it: PGM and YAML", "grid",
     [](const ExportArguments& options, const Blob& blob) {
       return datasets::ExportRos(blob, options.folder, options.force, ModeOf(options.mode));
     },
     true},
    {"octomap", "The grid as a layer of an octree, as OctoMap reads it: .bt", "octree",
     WriteBy<datasets::ExportOctomap>, true},
    {"geojson", "Landmarks and paths on the earth, of a map whose place there is said", "map",
     [](const ExportArguments& options, const Blob& blob) {
       return datasets::ExportGeojson(blob, options.origin, options.folder, options.force);
     }},
    {"ply", "Landmarks, occupied cells and paths as points, for MeshLab and its like", "",
     WriteBy<datasets::ExportPly>},
    {"png", "The map as a picture; of a grid map a pixel a cell", "", WriteBy<datasets::ExportPng>},
    {"csv", "Tables: of a log those that `import csv` reads, of a result poses and landmarks", "",
     WriteBy<datasets::ExportCsv>},
};

// Of a folder's results the first that the format knows; maps for planners rather of one that tells what is
// free.
BlobFile ReadSource(const ExportArguments& options) {
  std::vector<std::string> kinds;
  for (const datasets::ResultKind& kind : datasets::ResultKinds()) {
    if (kind.exports.find(options.format->name) == std::string_view::npos) continue;
    const bool first = options.format->is_for_planning && kind.tells_free_space;
    kinds.insert(first ? kinds.begin() : kinds.end(), std::string(kind.name));
  }
  return ReadFirstOf(options.from, kinds, options.changed);
}

// What one of the format's files holds.
std::string HeldBy(const std::string& file, const Format& format) {
  const std::filesystem::path path(file);
  if (*format.holds == '\0') return path.stem().string();
  if (path.extension() == ".times") return "times";
  return path.extension() == ".yaml" ? "settings" : format.holds;
}

void PrintWritten(const ExportArguments& options, const std::string& kind,
                  const std::vector<std::string>& files, const std::vector<std::string>& left_out) {
  nlohmann::ordered_json json = {{"kind", kind},
                                 {"format", options.format->name},
                                 {"files", nlohmann::ordered_json::array()},
                                 {"left_out", left_out}};
  for (const std::string& file : files)
    json["files"].push_back({{"file", file}, {"holds", HeldBy(file, *options.format)}});
  std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
}

int Export(const ExportArguments& options, const Invocation&) {
  const BlobFile source = ReadSource(options);
  WarnOfSeveralJobs(options.from, "it is the " + source.kind + " that is exported");
  const datasets::ResultKind* kind = datasets::FindResultKind(source.kind);
  if (source.kind == "map_so_far")
    throw InputError(options.from + ": " + WithArticle(source.kind) +
                     ", of which nothing is exported; its picture and page are beside it");
  const std::vector<std::string> files = Take(options.format->write(options, source.blob));
  const std::vector<std::string> left = options.format->name == std::string_view("csv")
                                            ? datasets::NotInCsv(source.blob)
                                            : std::vector<std::string>();
  if (options.json) PrintWritten(options, source.kind, files, left);
  for (const std::string& file : files)
    if (!options.json) std::printf("%s\n", file.c_str());
  if (options.format->is_for_planning && kind != nullptr && !kind->tells_free_space) {
    std::fprintf(stderr,
                 "note: a landmark map says nothing of free space: where no landmark is nothing is known. To "
                 "plan ways make a grid map (evidence_map, forward_map)\n");
  }
  if (!left.empty())
    std::fprintf(stderr, "note: left out, for CSV has no place for them: %s\n",
                 Escaped(NameList(left)).c_str());
  return kExitDone;
}

void AddFormat(Command parent, Invocation& call, const Format& format) {
  Command command;
  const std::string name = format.name,
                    example = "cairn export " + name + " result exported" +
                              (name == "geojson" ? " --latitude-deg 48.137 --longitude-deg 11.575" : "");
  const auto options =
      AddCommand<ExportArguments>(parent, call, format.name, format.help, example.c_str(), Export, &command);
  options->format = &format;
  command.Add("RESULT", options->from, "A result file, or the folder given as --out").Required();
  command.Add("FOLDER", options->folder, "Where to write; made where it is missing").Required();
  AddChangedFlag(command, &options->changed);
  command.AddFlag("--force", options->force, "Replace files that are there already");
  command.AddFlag("--json", options->json, "What was written, as JSON");
  if (name == "ros") {
    command
        .Add("--mode", options->mode,
             "trinary: occupied, free or unknown; scale: shades of grey; raw: 0 to 100, unknown 255")
        .OneOf({"trinary", "scale", "raw"})
        .ShowDefault();
  }
  if (name == "geojson") {
    command
        .Add("--latitude-deg", options->origin.latitude_deg,
             "Where the map's (0, 0) lies, north of the equator")
        .Within(-89.9, 89.9)
        .Required();
    command.Add("--longitude-deg", options->origin.longitude_deg, "Where it lies, east of Greenwich")
        .Within(-180.0, 180.0)
        .Required();
    command
        .Add("--x-axis-deg", options->origin.x_axis_deg,
             "By how much the map's x-axis is turned from east, counter-clockwise")
        .Within(-360.0, 360.0)
        .ShowDefault();
  }
  if (name == "g2o") {
    command.Add(
        "--log", options->log,
        "The log that the result was made from: edges are its odometry and observations, or loops, at "
        "which a solver stays. Without it they are the result's own motions, to look at");
    command.AddFlag("--landmarks-as-poses", options->landmarks_as_poses,
                    "Landmarks as poses whose headings count next to nothing, for GTSAM, which leaves out "
                    "EDGE_SE2_XY");
  }
}

}  // namespace

void AddExport(Command app, Invocation& call) {
  Command parent = app.AddCommand("export", "Writes maps and trajectories for other tools");
  parent.NeedsCommand();
  parent.Footer("Example:\n  cairn export tum result exported");
  for (const Format& format : kFormats) AddFormat(parent, call, format);
}

}  // namespace cairn::cli
