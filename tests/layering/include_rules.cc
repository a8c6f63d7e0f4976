#include "tests/layering/include_rules.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <regex>
#include <string_view>

namespace cairn::layering {
namespace {

namespace fs = std::filesystem;

// Headers of the operating system that a folder may use unless it is pure.
constexpr std::string_view kSystem =
    "dirent.h fcntl.h fnmatch.h glob.h stdlib.h string.h grp.h malloc.h poll.h pthread.h pwd.h sched.h "
    "signal.h "
    "spawn.h sysexits.h termios.h "
    "time.h "
    "unistd.h "
    "immintrin.h xmmintrin.h pmmintrin.h cpuid.h arm_neon.h gnu/libc-version.h ";

constexpr std::array<std::string_view, 18> kImpure = {
    "atomic",       "chrono",     "condition_variable", "csignal", "cstdio", "ctime",  "filesystem",
    "fstream",      "future",     "iostream",           "mutex",   "print",  "random", "semaphore",
    "shared_mutex", "stop_token", "syncstream",         "thread"};

bool IsStandard(const std::string& include) {
  return include.find('.') == std::string::npos && include.find('/') == std::string::npos;
}

bool IsSystem(const std::string& include) {
  if (include.starts_with("sys/") || include.starts_with("linux/")) return true;
  return kSystem.find(include + " ") != std::string_view::npos;
}

bool Matches(const std::string& pattern, const std::string& include) {
  if (pattern.ends_with("/*")) {
    const std::size_t length = pattern.size() - 1;
    return include.compare(0, length, pattern, 0, length) == 0 &&
           include.find('/', length) == std::string::npos;
  }
  return pattern.ends_with('/') ? include.starts_with(pattern) : include == pattern;
}

// Each with rules for the folders in it.
constexpr std::array<std::string_view, 6> kTopFolders = {"schema", "pipelines",   "datasets",
                                                         "worker", "coordinator", "coordinator/cli"};

std::string_view TopFolderOf(const std::string& file) {
  std::string_view best;
  for (const std::string_view folder : kTopFolders) {
    if (file.starts_with(std::string(folder) + "/") && folder.size() > best.size()) best = folder;
  }
  return best;
}

// Of a method's folder that has no rule of its own: it includes no other's. `pipelines`: the rule of those
// above.
const Rule* RuleOfMethod(const std::string& file, const Rule* pipelines) {
  static std::map<std::string, Rule> rules;
  const std::string folder = fs::path(file).parent_path().string();
  if (folder == "pipelines") return pipelines;
  const auto [rule, is_new] = rules.try_emplace(folder);
  if (is_new)
    rule->second = {folder,
                    {"schema/*", "schema/kinds/", "pipelines/pipeline.h", "pipelines/common/", folder + "/"},
                    true};
  return &rule->second;
}

// The rule of the longest folder that holds `file`; none: null.
const Rule* RuleOf(const std::string& file) {
  const Rule* best = nullptr;
  for (const Rule& rule : Rules()) {
    if (!file.starts_with(rule.folder + "/")) continue;
    if (best == nullptr || rule.folder.size() > best->folder.size()) best = &rule;
  }
  return best != nullptr && best->folder == "pipelines" ? RuleOfMethod(file, best) : best;
}

bool AnyMatches(const Rule& rule, const std::string& include) {
  return std::ranges::any_of(rule.allowed, [&](const std::string& p) { return Matches(p, include); });
}

// Whether any folder of the test's top folder may.
bool ATestMay(const std::string& file, const std::string& include) {
  return std::ranges::any_of(Rules(), [&](const Rule& rule) {
    return TopFolderOf(rule.folder + "/") == TopFolderOf(file) && AnyMatches(rule, include);
  });
}

std::string Complaint(const Rule& rule, const std::string& file, const std::string& include) {
  // The in-process runner is the reference that every fleet must equal.
  const bool of_tests = include.starts_with("gtest/") || include == "pipelines/testing/in_process.h";
  if (IsTest(file) && (of_tests || IsStandard(include) || IsSystem(include))) return {};
  if (IsStandard(include) || IsSystem(include)) {
    const bool impure = IsSystem(include) || std::ranges::find(kImpure, include) != kImpure.end();
    const bool vector_unit = include.ends_with("mmintrin.h") || include == "arm_neon.h";
    if (!rule.pure || !impure || vector_unit || include == "cstdio") return {};
    return rule.folder + "/ does no input or output, and knows no clock or thread";
  }
  if (include.starts_with("fmt/")) return {};  // texts, as the standard library will have them: everybody's
  if (!IsTest(file) && IsTest(include)) return "that is for tests";
  if (AnyMatches(rule, include) || (IsTest(file) && ATestMay(file, include))) return {};
  return "not in the table for " + rule.folder + "/ (tests/layering/include_rules.cc)";
}

void ReadFile(const fs::path& root, const std::string& file, std::vector<Finding>& findings) {
  const Rule* rule = RuleOf(file);
  if (rule == nullptr) return;
  static const std::regex kInclude(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"].*)");
  std::ifstream in(root / file);
  std::string text;
  for (int line = 1; std::getline(in, text); ++line) {
    std::smatch match;
    if (!std::regex_match(text, match, kInclude)) continue;
    const std::string why = Complaint(*rule, file, match[1]);
    if (!why.empty()) findings.push_back({file, line, match[1], why});
  }
}

}  // namespace

const std::vector<Rule>& Rules() {
  static const std::vector<Rule> kRules = {
      {"schema", {"schema/*", "schema/kinds/", "Eigen/", "google/protobuf/", "xxhash.h"}, false},
      {"schema/command_line", {"schema/command_line/", "CLI/"}, false},
      {"schema/store", {"schema/*", "schema/kinds/", "schema/store/", "hdf5.h", "hdf5_hl.h"}, false},
      {"schema/wire",
       {"schema/*", "schema/kinds/", "schema/wire/", "zmq.h", "zmq.hpp", "netinet/in.h", "arpa/inet.h",
        "google/protobuf/"},
       false},
      {"pipelines", {"schema/*", "schema/kinds/", "pipelines/"}, true},
      {"pipelines/common",
       {"schema/*", "schema/kinds/", "pipelines/pipeline.h", "pipelines/common/", "lz4.h"},
       true},
      {"pipelines/landmark_learning",
       {"schema/*", "schema/kinds/", "pipelines/pipeline.h", "pipelines/common/",
        "pipelines/landmark_learning/", "Eigen/Eigenvalues"},
       true},
      {"pipelines/landmark_learning/error_sum",
       {"schema/*", "schema/kinds/", "pipelines/landmark_learning/error_sum/"},
       true},
      {"pipelines/landmark_learning/networks",
       {"schema/*", "schema/kinds/", "pipelines/pipeline.h", "pipelines/landmark_learning/error_sum/",
        "pipelines/landmark_learning/networks/"},
       true},
      {"pipelines/landmark_learning/data",
       {"schema/*", "schema/kinds/", "pipelines/pipeline.h", "pipelines/landmark_learning/error_sum/",
        "pipelines/landmark_learning/networks/", "pipelines/landmark_learning/data/"},
       true},
      {"pipelines/landmark_learning/optimizer",
       {"schema/*", "schema/kinds/", "pipelines/pipeline.h", "pipelines/landmark_learning/error_sum/",
        "pipelines/landmark_learning/networks/", "pipelines/landmark_learning/optimizer/"},
       true},
      {"pipelines/landmark_learning/state",
       {"schema/*", "schema/kinds/", "pipelines/pipeline.h", "pipelines/common/",
        "pipelines/landmark_learning/error_sum/", "pipelines/landmark_learning/networks/",
        "pipelines/landmark_learning/data/", "pipelines/landmark_learning/optimizer/",
        "pipelines/landmark_learning/state/"},
       true},
      {"pipelines/landmark_learning/tasks",
       {"schema/*", "schema/kinds/", "pipelines/pipeline.h", "pipelines/common/",
        "pipelines/landmark_learning/error_sum/", "pipelines/landmark_learning/networks/",
        "pipelines/landmark_learning/data/", "pipelines/landmark_learning/optimizer/",
        "pipelines/landmark_learning/state/", "pipelines/landmark_learning/tasks/"},
       true},
      {"pipelines/landmark_map",
       {"schema/*", "schema/kinds/", "pipelines/pipeline.h", "pipelines/common/", "pipelines/landmark_map/",
        "Eigen/"},
       true},
      {"pipelines/landmark_map/model",
       {"schema/*", "schema/kinds/", "pipelines/pipeline.h", "pipelines/common/",
        "pipelines/landmark_map/model/"},
       true},
      {"pipelines/landmark_map/state",
       {"schema/*", "schema/kinds/", "pipelines/pipeline.h", "pipelines/common/",
        "pipelines/landmark_map/model/", "pipelines/landmark_map/landmarks/",
        "pipelines/landmark_map/state/"},
       true},
      {"pipelines/landmark_map/refinement",
       {"schema/*", "schema/kinds/", "pipelines/pipeline.h", "pipelines/common/",
        "pipelines/landmark_map/model/", "pipelines/landmark_map/landmarks/", "pipelines/landmark_map/state/",
        "pipelines/landmark_map/refinement/", "Eigen/"},
       true},
      {"pipelines/landmark_map/landmarks",
       {"schema/*", "schema/kinds/", "pipelines/common/", "pipelines/landmark_map/model/",
        "pipelines/landmark_map/landmarks/", "Eigen/"},
       true},
      {"pipelines/local_map/grids",
       {"schema/*", "schema/kinds/", "pipelines/common/", "pipelines/local_map/grids/"},
       true},
      {"pipelines/local_map/traces",
       {"schema/*", "schema/kinds/", "pipelines/common/", "pipelines/local_map/grids/",
        "pipelines/local_map/traces/"},
       true},
      {"pipelines/local_map/path",
       {"schema/*", "schema/kinds/", "pipelines/pipeline.h", "pipelines/common/",
        "pipelines/local_map/grids/", "pipelines/local_map/traces/", "pipelines/local_map/path/", "Eigen/"},
       true},
      {"pipelines/local_map/tasks",
       {"schema/*", "schema/kinds/", "pipelines/pipeline.h", "pipelines/common/",
        "pipelines/local_map/grids/", "pipelines/local_map/traces/", "pipelines/local_map/path/",
        "pipelines/local_map/tasks/"},
       true},
      // It localises by what landmark_learning has learned.
      {"pipelines/localization",
       {"schema/*", "schema/kinds/", "pipelines/pipeline.h", "pipelines/common/",
        "pipelines/landmark_learning/", "pipelines/localization/"},
       true},
      {"datasets", {"schema/*", "schema/kinds/", "datasets/*"}, false},
      {"datasets/common",
       {"schema/*", "schema/kinds/", "schema/store/", "datasets/common/", "Eigen/", "zlib.h"},
       false},
      {"datasets/verdicts",
       {"schema/*", "schema/kinds/", "datasets/common/", "datasets/verdicts/", "Eigen/"},
       false},
      {"datasets/inspect",
       {"schema/*", "schema/kinds/", "schema/store/", "datasets/common/", "datasets/verdicts/",
        "datasets/inspect/", "nlohmann/"},
       false},
      {"datasets/import",
       {"schema/*", "schema/kinds/", "schema/store/", "datasets/common/", "datasets/import/*", "zlib.h"},
       false},
      {"datasets/import/recorded",
       {"schema/*", "schema/kinds/", "schema/store/", "datasets/common/", "datasets/import/"},
       false},
      {"datasets/bag",
       {"schema/*", "schema/kinds/", "schema/store/", "datasets/common/", "datasets/detect/",
        "datasets/import/", "datasets/bag/", "Eigen/Core", "bzlib.h", "lz4frame.h", "sqlite3.h", "yaml-cpp/",
        "zlib.h", "zstd.h"},
       false},
      {"datasets/detect",
       {"schema/*", "schema/kinds/", "datasets/import/", "datasets/detect/", "Eigen/"},
       false},
      {"datasets/simulate", {"schema/*", "schema/kinds/", "datasets/common/", "datasets/simulate/*"}, false},
      // Its camera hands out what image_features makes of its images, by the same function.
      {"datasets/simulate/corridor",
       {"schema/*", "schema/kinds/", "datasets/common/", "datasets/simulate/*", "datasets/simulate/corridor/",
        "pipelines/image_features/band_features.h"},
       false},
      {"datasets/simulate/hall",
       {"schema/*", "schema/kinds/", "datasets/common/", "datasets/simulate/*", "datasets/simulate/hall/"},
       false},
      {"datasets/simulate/office",
       {"schema/*", "schema/kinds/", "datasets/common/", "datasets/simulate/*", "datasets/simulate/office/"},
       false},
      {"datasets/evaluate",
       {"schema/*", "schema/kinds/", "datasets/common/", "datasets/verdicts/", "datasets/evaluate/*",
        "datasets/evaluate/matching/", "datasets/evaluate/maps/", "Eigen/", "nlohmann/"},
       false},
      {"datasets/evaluate/matching",
       {"schema/*", "schema/kinds/", "datasets/common/", "datasets/evaluate/matching/"},
       false},
      {"datasets/evaluate/maps",
       {"schema/*", "schema/kinds/", "datasets/common/", "datasets/evaluate/matching/",
        "datasets/evaluate/maps/"},
       false},
      {"datasets/evaluate/learning",
       {"schema/*", "schema/kinds/", "datasets/common/", "datasets/evaluate/*", "datasets/evaluate/matching/",
        "datasets/evaluate/learning/"},
       false},
      {"datasets/evaluate/testing",
       {"schema/*", "schema/kinds/", "datasets/common/", "datasets/evaluate/*", "datasets/evaluate/testing/"},
       false},
      {"datasets/report/drawing",
       {"schema/*", "datasets/common/", "datasets/report/drawing/", "opencv2/core.hpp",
        "opencv2/imgproc.hpp"},
       false},
      {"datasets/report",
       {"schema/*", "schema/kinds/", "schema/store/", "datasets/common/", "datasets/evaluate/*",
        "datasets/evaluate/matching/", "datasets/evaluate/maps/", "datasets/report/*",
        "datasets/report/drawing/"},
       false},
      {"datasets/report/pages",
       {"schema/*", "schema/kinds/", "datasets/common/", "datasets/verdicts/", "datasets/evaluate/",
        "datasets/report/"},
       false},
      {"datasets/kinds",
       {"schema/*", "schema/kinds/", "datasets/common/", "datasets/verdicts/", "datasets/evaluate/",
        "datasets/report/", "datasets/kinds/"},
       false},
      {"datasets/export",
       {"schema/*", "schema/kinds/", "schema/store/", "datasets/common/", "datasets/evaluate/maps/",
        "datasets/report/", "datasets/export/", "Eigen/", "google/protobuf/", "nlohmann/", "zlib.h",
        "zstd.h"},
       false},
      {"datasets/reproduce",
       {"schema/*", "schema/kinds/", "datasets/common/", "datasets/evaluate/", "datasets/report/",
        "datasets/simulate/", "datasets/reproduce/*"},
       false},
      {"datasets/reproduce/landmarks",
       {"schema/*", "schema/kinds/", "datasets/common/", "datasets/evaluate/", "datasets/report/",
        "datasets/simulate/", "datasets/reproduce/*", "datasets/reproduce/landmarks/"},
       false},
      {"datasets/reproduce/ball",
       {"schema/*", "schema/kinds/", "datasets/common/", "datasets/evaluate/", "datasets/report/",
        "datasets/simulate/", "datasets/reproduce/*", "datasets/reproduce/ball/"},
       false},
      {"datasets/reproduce/occupancy",
       {"schema/*", "schema/kinds/", "datasets/common/", "datasets/evaluate/", "datasets/report/",
        "datasets/simulate/", "datasets/reproduce/*", "datasets/reproduce/occupancy/"},
       false},
      {"datasets/reproduce/local",
       {"schema/*", "schema/kinds/", "datasets/common/", "datasets/evaluate/", "datasets/report/",
        "datasets/simulate/", "datasets/reproduce/*", "datasets/reproduce/occupancy/",
        "datasets/reproduce/local/"},
       false},
      {"datasets/images",
       {"schema/*", "schema/kinds/", "datasets/import/", "datasets/images/", "opencv2/"},
       false},
      {"datasets/tags",
       {"datasets/images/", "datasets/tags/", "datasets/detect/", "apriltag/", "opencv2/", "Eigen/"},
       false},
      {"worker",
       {"schema/", "worker/", "pipelines/pipeline.h", "pipelines/registry.h", "CLI/", "spdlog/", "nlohmann/",
        "google/protobuf/"},
       false},
      // The client asks a service; the folders are the service, each built on those before it.
      {"coordinator", {"schema/*", "schema/kinds/", "schema/wire/", "coordinator/*"}, false},
      {"coordinator/core",
       {"schema/*", "schema/kinds/", "schema/wire/refusal.h", "coordinator/core/", "google/protobuf/"},
       true},
      {"coordinator/store", {"schema/", "coordinator/core/", "coordinator/store/", "sqlite3.h"}, false},
      {"coordinator/http",
       {"schema/*", "schema/wire/system_calls.h", "coordinator/http/", "microhttpd.h", "netdb.h",
        "netinet/in.h"},
       false},
      {"coordinator/server",
       {"schema/", "coordinator/core/", "coordinator/store/", "coordinator/http/", "coordinator/server/"},
       false},
      {"coordinator/local",
       {"schema/", "coordinator/core/", "coordinator/store/", "coordinator/server/", "coordinator/local/"},
       false},
      // A client in a browser: it knows the service by client.h alone.
      {"coordinator/page",
       {"schema/", "coordinator/*", "coordinator/http/", "coordinator/cli/common/", "coordinator/page/",
        "CLI/", "nlohmann/"},
       false},
      {"coordinator/scale", {"schema/*", "coordinator/store/log.h", "coordinator/scale/*"}, true},
      {"coordinator/scale/engines",
       {"schema/*", "coordinator/store/log.h", "coordinator/scale/*", "coordinator/scale/engines/",
        "nlohmann/", "yaml-cpp/"},
       false},
      {"coordinator/cli", {"schema/", "coordinator/cli/", "CLI/"}, false},
      {"coordinator/cli/common", {"schema/", "coordinator/cli/common/"}, false},
      {"coordinator/cli/job_file",
       {"schema/", "coordinator/*", "coordinator/core/", "coordinator/cli/common/",
        "coordinator/cli/job_file/", "datasets/common/", "yaml-cpp/", "nlohmann/", "google/protobuf/"},
       false},
      {"coordinator/cli/output",
       {"schema/", "coordinator/*", "coordinator/store/", "coordinator/cli/common/",
        "coordinator/cli/job_file/", "coordinator/cli/output/", "spdlog/", "nlohmann/"},
       false},
      {"coordinator/cli/commands",
       {"schema/", "coordinator/*", "coordinator/core/", "coordinator/store/", "coordinator/server/",
        "coordinator/local/", "coordinator/scale/", "coordinator/cli/common/", "coordinator/cli/job_file/",
        "coordinator/cli/output/", "coordinator/cli/commands/*", "datasets/", "nlohmann/"},
       false},
      {"coordinator/cli/commands/import",
       {"schema/", "coordinator/cli/common/", "coordinator/cli/job_file/", "coordinator/cli/output/",
        "coordinator/cli/commands/import/", "datasets/bag/", "datasets/common/", "datasets/detect/",
        "datasets/import/", "nlohmann/"},
       false},
      {"coordinator/cli/reproduce",
       {"schema/", "coordinator/local/", "coordinator/cli/common/", "coordinator/cli/output/",
        "coordinator/cli/program.h", "coordinator/cli/reproduce/", "datasets/reproduce/",
        "datasets/simulate/", "nlohmann/"},
       false},
      {"coordinator/cli/commands/simulate",
       {"schema/", "coordinator/cli/common/", "coordinator/cli/output/", "coordinator/cli/commands/simulate/",
        "datasets/bag/", "datasets/simulate/", "nlohmann/"},
       false},
  };
  return kRules;
}

std::string ToText(const Finding& finding) {
  return finding.file + ":" + std::to_string(finding.line) + ": may not include " + finding.include + ": " +
         finding.why;
}

bool IsTest(const std::string& file) {
  const std::string stem = fs::path(file).stem().string();
  return stem.ends_with("_test") || stem.ends_with("testing") || stem.starts_with("testing_") ||
         file.find("/testing/") != std::string::npos;
}

std::vector<std::string> SourcesBelow(const fs::path& root) {
  std::vector<std::string> files;
  for (const char* top : {"schema", "pipelines", "datasets", "worker", "coordinator"}) {
    if (!fs::exists(root / top)) continue;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / top)) {
      const fs::path extension = entry.path().extension();
      if (extension == ".h" || extension == ".cc")
        files.push_back(entry.path().lexically_relative(root).string());
    }
  }
  std::ranges::sort(files);
  return files;
}

std::vector<Finding> FindWrongIncludes(const fs::path& root, int* files_read) {
  const std::vector<std::string> files = SourcesBelow(root);
  *files_read = static_cast<int>(files.size());
  std::vector<Finding> findings;
  for (const std::string& file : files) ReadFile(root, file, findings);
  return findings;
}

}  // namespace cairn::layering
