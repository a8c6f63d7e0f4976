#include "datasets/import/recognize.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <ranges>
#include <string_view>
#include <vector>

#include "datasets/common/text_file.h"
#include "datasets/import/csv_reader.h"
#include "schema/text.h"

namespace cairn::datasets {
namespace {

namespace fs = std::filesystem;

struct GzipClose {
  void operator()(gzFile_s* file) const { gzclose(file); }
};

// The first few lines, gunzipped where need be.
std::string ReadHead(const std::string& path) {
  const std::unique_ptr<gzFile_s, GzipClose> file(gzopen(path.c_str(), "rb"));
  if (!file) return {};
  std::array<char, 1 << 16> text{};
  const int count = gzread(file.get(), text.data(), text.size());
  return count > 0 ? std::string(text.data(), static_cast<std::size_t>(count)) : "";
}

constexpr std::size_t kMostLooked = 50;           // files of a folder
constexpr const char* kJobTable = "jobs.sqlite";  // of Cairn's own store: no bag, though it is SQLite
constexpr const char* kRelations = "relations of the SLAM benchmark";
constexpr const char *kOdometry = "a table of odometry", *kObservations = "a table of observations";

bool HasColumns(std::string_view header, std::initializer_list<const char*> columns) {
  return std::ranges::all_of(columns, [&](const char* column) { return header.find(column) != header.npos; });
}

// Columns that are counted, as beams are: "time_s,r0,r1,r2".
bool LooksLikeScans(std::string_view header) {
  const auto counted = [](auto column) {
    return std::ranges::any_of(column, [](unsigned char c) { return std::isdigit(c) != 0; });
  };
  const auto separator = std::ranges::find_if(header, [](char c) { return c == ';' || c == '\t'; });
  return std::ranges::count_if(header | std::views::split(separator == header.end() ? ',' : *separator),
                               counted) >= 2;
}

std::optional<Recognized> RecognizeTable(const std::string& path, std::string_view header) {
  const std::string file = ShellWord(path);
  const bool pose = HasColumns(header, {"x_", "y_", "time_"});
  if (HasColumns(header, {"time_", "landmark", "range_"}))
    return Recognized{kObservations,
                      "cairn import csv --odometry ODOMETRY.csv --observations " + file + " log.h5"};
  if (HasColumns(header, {"time_", "turn_", "forward_"}) || HasColumns(header, {"time_", "v_", "omega_"}))
    return Recognized{kOdometry,
                      "cairn import csv --odometry " + file + " --observations OBSERVATIONS.csv log.h5"};
  if (pose && HasColumns(header, {"image"}))
    return Recognized{"a table of images and where they were taken",
                      "cairn import images FOLDER " + file + " images.h5"};
  if (!pose && LooksLikeScans(header))
    return Recognized{"a table of scans",
                      "cairn import carmen SCANS.log log.h5, once its rows are lines of a CARMEN log "
                      "(docs/my-own-log.md)"};
  if (!pose) return std::nullopt;
  return Recognized{"a table of poses", "cairn import vectors " + file +
                                            " samples.h5 where other columns are sensor readings, or "
                                            "cairn import csv --odometry " +
                                            file + " log.h5 where it is odometry"};
}

// The numbers of a line, where it has `count` and nothing else; else none.
std::vector<double> NumbersOf(std::string_view line, std::size_t count) {
  std::vector<double> numbers;
  while (!(line = Trim(line)).empty()) {
    const std::string_view word = line.substr(0, line.find_first_of(" \t"));
    const char* reason = "";
    const auto number = ParseNumber(word, &reason);
    if (!number) return {};
    numbers.push_back(*number);
    line.remove_prefix(word.size());
  }
  return numbers.size() == count ? numbers : std::vector<double>{};
}

std::optional<Recognized> RecognizeFile(const std::string& path) {
  const std::string text = ReadHead(path), file = ShellWord(path);
  if (const auto bag = BagName(text)) return Recognized{*bag, "cairn import bag " + file + " log.h5"};
  Lines lines(text);
  while (lines.Next()) {
    const std::string_view line = lines.text(), word = line.substr(0, line.find(' '));
    if (Trim(line).empty() || line.starts_with('#') || line.starts_with("sep=")) continue;
    const std::string header = InSmallLetters(line);  // as the importers read it
    if (header.find("time_") != header.npos) return RecognizeTable(path, header);
    if (HasColumns(header, {"x_", "y_"}) && line.find_first_of(",;\t") != line.npos)
      return Recognized{"a table of what it costs to take one place for another",
                        "cairn import errors " + file + " errors.h5"};
    constexpr std::array kCarmen = {"PARAM", "ODOM",      "FLASER",      "RLASER", "ROBOTLASER1",
                                    "SYNC",  "RAWLASER1", "ROBOTLASER2", "TRUEPOS"};
    if (std::ranges::find(kCarmen, word) != kCarmen.end())
      return Recognized{"a CARMEN log", "cairn import carmen " + file + " log.h5"};
    if (word == "Odometry" || word == "Laser")
      return Recognized{"a laser log of DP-SLAM", "cairn import dpslam " + file + " log.h5"};
    if (word == "O" || word == "L")
      return Recognized{"a laser log of Wean Hall", "cairn import wean " + file + " log.h5"};
    if (word.starts_with("VERTEX_SE2") || word.starts_with("EDGE_SE2"))
      return Recognized{"a pose graph of g2o", "cairn import g2o " + file + " log.h5"};
    if (!NumbersOf(line, 12).empty())
      return Recognized{"a trajectory of KITTI's format",
                        "cairn import kitti " + file + " --times TIMES poses.h5"};
    if (!NumbersOf(line, 4).empty())
      return Recognized{"a trajectory of times and poses in the plane",
                        "cairn import tum " + file + " poses.h5"};
    const std::vector<double> numbers = NumbersOf(line, 8);
    if (numbers.empty()) return std::nullopt;
    // The last four are a quaternion, or z, roll, pitch and yaw of a motion.
    const double length = std::hypot(std::hypot(numbers[4], numbers[5]), std::hypot(numbers[6], numbers[7]));
    if (std::abs(length - 1) < 0.01)
      return Recognized{"a trajectory of the TUM format", "cairn import tum " + file + " poses.h5"};
    return Recognized{kRelations, "cairn evaluate RESULT --relations " + file};
  }
  return std::nullopt;
}

bool IsImageName(const fs::path& path) {
  const std::string ending = path.extension().string();
  constexpr std::array kImages = {".png", ".jpg", ".jpeg", ".ppm"};
  return std::ranges::find(kImages, ending) != kImages.end();
}

// Of these files or folders the first that is a log, else the first that is anything; `more`: how many others
// are something too.
std::optional<Recognized> FirstOf(std::vector<std::string> paths,
                                  std::optional<Recognized> (*recognize)(const std::string&),
                                  std::size_t* more) {
  std::ranges::sort(paths);
  *more = 0;
  std::optional<Recognized> first;
  std::size_t known = 0;
  for (std::size_t i = 0; i < std::min(kMostLooked, paths.size()); ++i) {
    auto found = recognize(paths[i]);
    if (!found || found->what == kRelations) continue;
    ++known;
    found->what += ", " + fs::path(paths[i]).filename().string();
    const auto is_log = [](const Recognized& one) { return one.command.ends_with(" log.h5"); };
    if (!first || (is_log(*found) && !is_log(*first))) first = std::move(found);
  }
  *more = known > 0 ? known - 1 : 0;
  return first;
}

// Tables of both, whatever they are called, where there is one of each.
std::optional<Recognized> RecognizeTables(const std::vector<std::string>& files) {
  std::vector<std::string> odometry, observations;
  for (const std::string& file : files) {
    const auto found = RecognizeFile(file);
    if (found && found->what == kOdometry) odometry.push_back(file);
    if (found && found->what == kObservations) observations.push_back(file);
  }
  if (odometry.size() != 1 || observations.size() != 1) return std::nullopt;
  return Recognized{"a folder of CSV tables", "cairn import csv --odometry " + ShellWord(odometry[0]) +
                                                  " --observations " + ShellWord(observations[0]) +
                                                  " log.h5"};
}

std::optional<Recognized> RecognizeOneFolder(const std::string& path) {
  const std::string folder = ShellWord(path);
  const auto has = [&](const char* name) { return !FindFile(path, name).empty(); };
  if (has("Barcodes.dat"))
    return Recognized{"a folder of MR.CLAM logs", "cairn import mrclam " + folder + " log.h5"};
  if (has("od.txt") && has("sonar.txt"))
    return Recognized{"a run of the Pioneer robot", "cairn import pioneer " + folder + " log.h5"};
  if (has("robot4_motors.txt"))
    return Recognized{"the LEGO robot's logs", "cairn import lego-robot " + folder + " log.h5"};
  if (has("trees/time.txt"))
    return Recognized{"the Victoria Park dataset", "cairn import victoria-park " + folder + " log.h5"};
  if (has("odometry.csv"))
    return Recognized{
        "a folder of CSV tables",
        "cairn import csv --odometry " + ShellWord(FindFile(path, "odometry.csv")) +
            (has("observations.csv") ? " --observations " + ShellWord(FindFile(path, "observations.csv"))
                                     : "") +
            " log.h5"};
  if (has("metadata.yaml")) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(path, ignored))
      if (const std::string ending = entry.path().extension(); ending == ".db3" || ending == ".mcap")
        return Recognized{"a folder of rosbag2", "cairn import bag " + folder + " log.h5"};
  }
  std::vector<std::string> files;
  std::error_code error;
  std::size_t images = 0;
  for (fs::directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error)) {
    if (IsImageName(entry->path())) ++images;
    if (entry->is_regular_file(error) && entry->path().filename() != kJobTable)
      files.push_back(entry->path().string());
  }
  if (images > 1)
    return Recognized{"a folder of " + std::to_string(images) + " images",
                      "cairn import images " + folder + " POSES.csv images.h5"};
  if (files.size() <= kMostLooked)
    if (auto tables = RecognizeTables(files)) return tables;
  std::size_t more = 0;
  auto found = FirstOf(std::move(files), RecognizeFile, &more);
  if (found) found->what = "a folder with " + found->what;
  return found;
}

// Itself, or where that is nothing the folders in it: a collection of logs.
std::optional<Recognized> RecognizeFolder(const std::string& path) {
  if (auto found = RecognizeOneFolder(path)) return found;
  std::vector<std::string> folders;
  std::error_code error;
  for (fs::directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error))
    if (entry->is_directory(error) && !entry->path().filename().string().starts_with('.'))
      folders.push_back(entry->path().string());
  std::size_t more = 0;
  auto found = FirstOf(std::move(folders), RecognizeOneFolder, &more);
  if (found)
    found->what = (more > 0 ? "a folder of " + std::to_string(more + 1) + " folders to inspect, such as "
                            : "a folder with ") +
                  found->what;
  return found;
}

}  // namespace

std::optional<std::string> BagName(std::string_view head) {
  if (head.starts_with("#ROSBAG V") || head.starts_with("#ROSRECORD V")) return "a ROS 1 bag";
  if (head.starts_with("\x89MCAP")) return "an MCAP file";
  if (head.starts_with("SQLite format 3")) return "a ROS 2 bag in SQLite";
  return std::nullopt;
}

std::optional<Recognized> Recognize(const std::string& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return RecognizeFolder(path);
  return fs::is_regular_file(path, error) ? RecognizeFile(path) : std::nullopt;
}

}  // namespace cairn::datasets
