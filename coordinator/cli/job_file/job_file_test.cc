#include "coordinator/cli/job_file/job_file.h"

#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "coordinator/cli/job_file/arguments.h"
#include "coordinator/cli/job_file/inputs.h"
#include "coordinator/cli/output/pipeline_text.h"
#include "coordinator/store/job_yaml.h"
#include "schema/error.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

constexpr char kDescription[] = R"({"pipelines": [
  {"name": "landmark_map", "summary": "landmarks", "inputs": ["log"], "options": [
    {"name": "cell_m", "type": "real", "unit": "m", "help": "edge", "low": 0.01, "high": 10, "default": 1},
    {"name": "iterations", "type": "integer", "unit": "", "help": "most", "low": 1, "high": 100, "default": 10},
    {"name": "blur", "type": "boolean", "unit": "", "help": "", "low": 0, "high": 0, "default": true},
    {"name": "mode", "type": "text", "unit": "", "help": "", "low": 0, "high": 0, "choices": ["local", "global"],
     "default": "local"}]},
  {"name": "forward_map", "summary": "grids", "inputs": ["log", "poses?"], "options": []}]})";

// A folder with museum.h5 and the job file job.yaml of the text that a test gives it.
class JobFile : public testing::Test {
 protected:
  JobFile() : folder_(fs::path(testing::TempDir()) / ("cairn_job_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "museum.h5") << "x";
  }
  ~JobFile() override { fs::remove_all(folder_); }

  ParsedJob Read(const std::string& text) {
    std::ofstream(Path()) << text;
    return ReadJobFile(Path(), catalog_);
  }
  std::string Path() const { return (folder_ / "job.yaml").string(); }

  // What it says about a bad job, without the folder.
  std::string Complaint(const std::string& text) {
    try {
      Read(text);
    } catch (const InputError& error) {
      std::string what = error.what();
      for (std::size_t at; (at = what.find(folder_.string() + "/")) != std::string::npos;) {
        what.erase(at, folder_.string().size() + 1);
      }
      return what;
    }
    return "accepted";
  }

  fs::path folder_;
  Catalog catalog_ = Catalog::FromJson(kDescription);
};

// A good job; a test spoils one of its lines.
constexpr char kGood[] =
    "name: museum\n"
    "seed: 7\n"
    "inputs: {log: museum.h5}\n"
    "stages:\n"
    "  - name: landmarks\n"
    "    pipeline: landmark_map\n"
    "    log: log\n"
    "    options:\n"
    "      cell_m: 0.25\n"
    "      iterations: 5\n"
    "      blur: false\n"
    "      mode: global\n"
    "  - {name: grid, pipeline: forward_map, log: log, poses: landmarks}\n";

std::string Spoiled(const std::string& from, const std::string& to) {
  std::string text = kGood;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST_F(JobFile, MapsEveryField) {
  const ParsedJob parsed = Read(kGood);
  EXPECT_EQ(parsed.job.name(), "museum");
  EXPECT_EQ(parsed.job.seed(), 7u);
  EXPECT_EQ(parsed.job.inputs().at("log"), "museum.h5");
  EXPECT_EQ(parsed.inputs.at("log").path, (folder_ / "museum.h5").string());
  ASSERT_EQ(parsed.job.stages_size(), 2);
  const proto::Stage& stage = parsed.job.stages(0);
  EXPECT_EQ(stage.name(), "landmarks");
  EXPECT_EQ(stage.pipeline(), "landmark_map");
  EXPECT_EQ(stage.inputs().at("log"), "log");
  EXPECT_EQ(stage.options().at("cell_m").d(), 0.25);
  EXPECT_EQ(stage.options().at("iterations").i(), 5);
  EXPECT_EQ(stage.options().at("blur").kind_case(), proto::Value::kB);
  EXPECT_EQ(stage.options().at("mode").s(), "global");
  EXPECT_EQ(parsed.job.stages(1).inputs().at("poses"), "landmarks");
}

TEST_F(JobFile, MayGiveAPriority) {
  EXPECT_EQ(Read(kGood).job.priority(), 0);
  EXPECT_EQ(Read(Spoiled("seed: 7", "priority: -10")).job.priority(), -10);
  EXPECT_EQ(Read(kGood).job.task_time_s(), 0) << "no limit";
  EXPECT_EQ(Read(Spoiled("seed: 7", "task_time_s: 2.5")).job.task_time_s(), 2.5);
  EXPECT_EQ(Read(kGood).job.task_memory_mb(), 0u) << "no limit";
  EXPECT_EQ(Read(Spoiled("seed: 7", "task_memory_mb: 2000")).job.task_memory_mb(), 2000u);
}

TEST_F(JobFile, TakesAWholeNumberForARealAndStoresAReal) {
  const ParsedJob parsed = Read(Spoiled("cell_m: 0.25", "cell_m: 1"));
  EXPECT_EQ(parsed.job.stages(0).options().at("cell_m").kind_case(), proto::Value::kD);
}

TEST_F(JobFile, TakesItsNameFromTheFileWhereNoneIsGiven) {
  EXPECT_EQ(Read(Spoiled("name: museum\n", "")).job.name(), "job");
}

struct Bad {
  const char* what;
  const char* from;
  const char* to;
  const char* complaint;  // as it begins
};

constexpr Bad kBad[] = {
    {"UnknownKey", "seed: 7", "sede: 7", "job.yaml:2: unknown key 'sede'; did you mean 'seed'?"},
    {"NulInAText", "name: museum", "name: \"mus\\0eum\"",
     "job.yaml:1: name: has a NUL, at which a file's name would end"},
    {"KeyTwice", "seed: 7", "seed: 7\nseed: 8", "job.yaml:3: 'seed' was given already, at line 2"},
    {"SeedOfAnotherType", "seed: 7", "seed: seven", "job.yaml:2: seed: a whole number from 0"},
    {"SeedInQuotes", "seed: 7", "seed: '7'", "job.yaml:2: seed: a whole number from 0"},
    {"SeedNegative", "seed: 7", "seed: -1", "job.yaml:2: seed: a whole number from 0"},
    {"PriorityTooHigh", "seed: 7", "priority: 11", "job.yaml:2: priority: a whole number from -10 to 10"},
    {"TaskTimeNegative", "seed: 7", "task_time_s: -1", "job.yaml:2: task_time_s: a time in seconds, above 0"},
    {"TaskTimeNotANumber", "seed: 7", "task_time_s: nan",
     "job.yaml:2: task_time_s: a time in seconds, above 0"},
    {"TaskMemoryNegative", "seed: 7", "task_memory_mb: -1",
     "job.yaml:2: task_memory_mb: a whole number of megabytes, above 0"},
    {"TaskMemoryAFraction", "seed: 7", "task_memory_mb: 0.5",
     "job.yaml:2: task_memory_mb: a whole number of megabytes, above 0"},
    {"TaskMemoryTooMuch", "seed: 7", "task_memory_mb: 9223372036854775808",
     "job.yaml:2: task_memory_mb: a whole number of megabytes, above 0"},
    {"PriorityInQuotes", "seed: 7", "priority: '1'", "job.yaml:2: priority: a whole number from -10 to 10"},
    {"PriorityAFraction", "seed: 7", "priority: 1.5", "job.yaml:2: priority: a whole number from -10 to 10"},
    {"SeedIsAMap", "seed: 7", "seed: {a: 1}", "job.yaml:2: seed: a whole number from 0"},
    {"NameIsANumber", "name: museum", "name: 7", "job.yaml:1: name: a text is needed; write '7' in quotes"},
    {"NameIsAPath", "name: museum", "name: ../x", "job.yaml:1: name: '../x' is no name"},
    {"NoInputs", "inputs: {log: museum.h5}\n", "", "job.yaml:1: 'inputs' is missing"},
    {"InputsAreAList", "{log: museum.h5}", "[museum.h5]", "job.yaml:3: inputs: a map"},
    {"InputsAreEmpty", "{log: museum.h5}", "", "job.yaml:3: inputs: a map"},
    {"MissingFile", "museum.h5}", "muesum.h5}", "job.yaml:3: input 'log': there is no file 'muesum.h5'"},
    {"UnusedInput", "{log: museum.h5}", "{log: museum.h5, other: museum.h5}",
     "job.yaml:3: input 'other' is used by no stage"},
    {"StageWithoutName", "  - name: landmarks\n    pipeline", "  - pipeline",
     "job.yaml:5: a stage without 'name'"},
    {"StageWithoutPipeline", "    pipeline: landmark_map\n", "", "job.yaml:5: a stage without 'pipeline'"},
    {"StageWithAMistypedName", "name: landmarks", "nmae: landmarks",
     "job.yaml:5: unknown key 'nmae'; did you mean 'name'?; known: name, pipeline, options, log, poses"},
    {"StageWithAMistypedPipeline", "pipeline: landmark_map", "pipelin: landmark_map",
     "job.yaml:6: unknown key 'pipelin'; did you mean 'pipeline'?; known: name, pipeline, options, log, "
     "poses"},
    {"StageTwice", "name: grid", "name: landmarks",
     "job.yaml:13: stage 'landmarks' was named already, at line 5"},
    {"StageNamedAsAnInput", "name: grid", "name: log", "job.yaml:13: stage 'log' has the name of an input"},
    {"UnknownPipeline", "landmark_map", "landmarkmap",
     "job.yaml:6: there is no pipeline 'landmarkmap'; did you mean 'landmark_map'?"},
    {"UnknownRole", "    log: log", "    lag: log", "job.yaml:7: unknown key 'lag'; did you mean 'log'?"},
    {"MissingRole", "    log: log\n", "", "job.yaml:5: stage 'landmarks': landmark_map needs `log: NAME`"},
    {"UnknownSource", "poses: landmarks", "poses: landmark",
     "job.yaml:13: poses: there is no input or earlier stage 'landmark'; did you mean 'landmarks'?"},
    {"StageOfItself", "poses: landmarks", "poses: grid",
     "job.yaml:13: poses: stage 'grid' is no earlier one (line 13)"},
    {"LaterStage", "    log: log\n", "    log: grid\n",
     "job.yaml:7: log: stage 'grid' is no earlier one (line 13)"},
    {"UnknownOption", "cell_m", "ceil_m",
     "job.yaml:9: unknown option 'ceil_m' of landmark_map; did you mean 'cell_m'?"},
    {"OptionTwice", "iterations: 5", "cell_m: 5", "job.yaml:10: 'cell_m' was given already, at line 9"},
    {"RealIsAText", "0.25", "wide",
     "job.yaml:9: cell_m: 'wide' is not allowed; allowed: a number from 0.01 to 10 m"},
    {"RealInQuotes", "0.25", "\"0.25\"", "job.yaml:9: cell_m: '\"0.25\"' is not allowed; allowed: a number"},
    {"RealOutOfRange", "0.25", "11",
     "job.yaml:9: cell_m: '11' is not allowed; allowed: a number from 0.01 to 10 m"},
    {"RealIsNaN", "0.25", ".nan", "job.yaml:9: cell_m: '.nan' is not allowed"},
    {"RealIsNan", "0.25", "nan", "job.yaml:9: cell_m: 'nan' is not allowed"},
    {"RealWithUnit", "0.25", "0.25m", "job.yaml:9: cell_m: '0.25m' is not allowed"},
    {"RealIsAList", "0.25", "[0.25]", "job.yaml:9: cell_m: allowed: a number from 0.01 to 10 m"},
    {"IntegerIsReal", "iterations: 5", "iterations: 5.5",
     "job.yaml:10: iterations: '5.5' is not allowed; allowed: a whole number from 1 to 100"},
    {"IntegerOutOfRange", "iterations: 5", "iterations: 0", "job.yaml:10: iterations: '0' is not allowed"},
    {"BooleanIsANumber", "blur: false", "blur: 0",
     "job.yaml:11: blur: '0' is not allowed; allowed: true or false"},
    {"BooleanInQuotes", "blur: false", "blur: 'false'", "job.yaml:11: blur: '\"false\"' is not allowed"},
    {"TextIsNoChoice", "mode: global", "mode: globe",
     "job.yaml:12: mode: 'globe' is not allowed; allowed: one of local, global"},
    {"TextIsABoolean", "mode: global", "mode: true", "job.yaml:12: mode: 'true' is not allowed"},
    {"NotYaml", "{log: museum.h5}", "{log: museum.h5", "job.yaml:"},
    {"TwoDocuments", "name: museum", "name: museum\n---\nname: other", "job.yaml:"},
};

class BadJob : public JobFile, public testing::WithParamInterface<Bad> {};

TEST_P(BadJob, IsRefusedWithFileLineAndWhatIsAllowed) {
  const std::string complaint = Complaint(Spoiled(GetParam().from, GetParam().to));
  EXPECT_TRUE(complaint.starts_with(GetParam().complaint)) << complaint;
}

INSTANTIATE_TEST_SUITE_P(Lines, BadJob, testing::ValuesIn(kBad),
                         [](const testing::TestParamInfo<Bad>& bad) { return bad.param.what; });

TEST_F(JobFile, ThatIsNotThereOrEmptyIsRefused) {
  EXPECT_THROW(ReadJobFile((folder_ / "none.yaml").string(), catalog_), InputError);
  EXPECT_NE(Complaint(""), "accepted");
  EXPECT_EQ(Complaint("just a text\n"), "job.yaml:1: the job: a map of `key: value` is needed");
}

TEST_F(JobFile, StagesMustBeAListThatIsNotEmpty) {
  const std::string head = "inputs: {log: museum.h5}\n";
  EXPECT_EQ(Complaint(head + "stages: {a: 1}\n"),
            "job.yaml:2: stages: a list is needed, its items after '- '");
  EXPECT_EQ(Complaint(head + "stages: []\n"), "job.yaml:2: 'stages' is empty: a job has at least one");
  EXPECT_EQ(Complaint(head + "stages:\n  - 7\n"), "job.yaml:3: a stage: a map of `key: value` is needed");
}

// What is taken is a job whose own YAML gives it again; what is not taken is refused with the file and a line
// of it.
class DamagedJob : public JobFile {
 protected:
  void ExpectTakenWholeOrRefused(const std::string& text) {
    SCOPED_TRACE(text);
    proto::Job job;
    try {
      job = Read(text).job;
    } catch (const InputError& error) {
      ++refused_;
      const std::string what = error.what();
      ASSERT_TRUE(what.starts_with(Path() + ":")) << what;
      char* rest = nullptr;
      const long line = std::strtol(what.c_str() + Path().size() + 1, &rest, 10);
      EXPECT_TRUE(std::string(rest).starts_with(": ")) << what;
      EXPECT_GE(line, 1) << what;
      EXPECT_LE(line, std::ranges::count(text, '\n') + 1) << what;
      EXPECT_GT(std::string(rest).size(), 10U) << what;
      return;
    }
    ++taken_;
    const proto::Job again = Read(coordinator::JobAsYaml(job)).job;
    EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(job, again)) << again.DebugString();
  }
  int taken_ = 0, refused_ = 0;
};

TEST_F(DamagedJob, WithAFlippedLetterIsTakenWholeOrRefusedWithItsLine) {
  for (std::size_t i = 0; i < std::string(kGood).size(); ++i) {
    std::string text = kGood;
    text[i] = static_cast<char>(text[i] ^ 0x10);
    ExpectTakenWholeOrRefused(text);
  }
  EXPECT_GT(taken_, 5) << "a name with another letter in it";
  EXPECT_GT(refused_, 200);
}

TEST_F(DamagedJob, ThatIsCutOffIsTakenWholeOrRefusedWithItsLine) {
  for (std::size_t i = 1; i < std::string(kGood).size(); ++i)
    ExpectTakenWholeOrRefused(std::string(kGood).substr(0, i));
  EXPECT_GT(taken_, 5) << "after a stage or an option that is whole";
  EXPECT_GT(refused_, 100);
}

TEST_F(JobFile, ArgumentsGiveTheSameOptionsAsAFile) {
  const std::string log = (folder_ / "museum.h5").string();
  const ParsedJob parsed = ResolveJob(
      {"landmark_map", log, {"cell_m=0.25", "iterations=5", "blur=false", "mode=global"}, 7, {}}, catalog_);
  const ParsedJob from_file = Read(kGood);
  ASSERT_EQ(parsed.job.stages_size(), 1);
  for (const auto& [key, value] : from_file.job.stages(0).options()) {
    EXPECT_EQ(parsed.job.stages(0).options().at(key).SerializeAsString(), value.SerializeAsString()) << key;
  }
}

TEST_F(JobFile, AJobOfAPipelineIsCalledAsIsSaid) {
  JobArguments arguments{"landmark_map", (folder_ / "museum.h5").string(), {}, 7, {}};
  EXPECT_EQ(ResolveJob(arguments, catalog_).job.name(), "landmark_map");
  arguments.name = "hall";
  EXPECT_EQ(ResolveJob(arguments, catalog_).job.name(), "hall");
  EXPECT_EQ(ResolveJob(arguments, catalog_).job.stages(0).name(), "landmark_map");
  arguments.name = "a\nb";
  EXPECT_THROW(ResolveJob(arguments, catalog_), InputError);
  std::ofstream(folder_ / "job.yaml") << kGood;
  EXPECT_THROW(ResolveJob({(folder_ / "job.yaml").string(), "", {}, 0, {}, false, "hall"}, catalog_),
               InputError);
}

TEST_F(JobFile, HostileTextsAreRefusedAtOnce) {
  EXPECT_EQ(Complaint("!,o"), "job.yaml:1: the job: a map of `key: value` is needed");
  EXPECT_EQ(Complaint("name: !!python/object:os.system x\n"),
            "job.yaml:1: a tag, 'tag:yaml.org,2002:python/object:os.system': a job file has none");
  EXPECT_EQ(Complaint(std::string(2 << 20, ' ')), "job.yaml: larger than 1 MB: this is no job file");
  EXPECT_EQ(Complaint("a: 1\n---\nb: 2\n"), "job.yaml:2: a second document: a file holds one job");
  EXPECT_EQ(Complaint("---\n"), "job.yaml:1: the file is empty");
  EXPECT_EQ(Complaint(std::string(100000, '[')), "job.yaml:1: nested too deep for a job file");
  std::string bomb = "a: &a x\nb:\n";
  for (int i = 0; i < 101; ++i) bomb += "  - *a\n";
  EXPECT_EQ(Complaint(bomb), "job.yaml:103: more than 100 aliases");
}

TEST_F(JobFile, BadArgumentsAreRefused) {
  const std::string log = (folder_ / "museum.h5").string();
  const auto complaint = [&](const std::string& pipeline, const std::vector<std::string>& settings,
                             const std::vector<std::string>& inputs = {}) -> std::string {
    try {
      ResolveJob({pipeline, log, settings, 0, inputs}, catalog_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_TRUE(complaint("landmark_mpa", {}).starts_with("there is no pipeline 'landmark_mpa'; did you mean"));
  EXPECT_EQ(complaint("log.h5", {}), "there is no pipeline 'log.h5'; `cairn map log.h5` chooses one");
  EXPECT_TRUE(complaint("landmark_map", {"cell_m"}).starts_with("--set cell_m: write key=value"));
  EXPECT_TRUE(
      complaint("landmark_map", {"cel_m=1"}).starts_with("--set cel_m=1: unknown option; did you mean"));
  EXPECT_TRUE(complaint("landmark_map", {"cell_m=1", "cell_m=2"}).ends_with("was given already"));
  EXPECT_TRUE(complaint("landmark_map", {"cell_m=99"}).starts_with("--set cell_m=99: '99' is not allowed"));
  EXPECT_THROW(ResolveJob({"landmark_map", log + "x", {}, 0, {}}, catalog_), InputError);
  EXPECT_TRUE(complaint("forward_map", {}, {"poses"}).starts_with("--input poses: write name=FILE"));
  EXPECT_TRUE(complaint("forward_map", {}, {"pose=" + log}).find("did you mean 'poses'?") !=
              std::string::npos);
  EXPECT_TRUE(complaint("forward_map", {}, {"log=" + log}).ends_with("'log' was given already"));
  EXPECT_TRUE(complaint("forward_map", {}, {"poses=" + log + "x"}).starts_with("there is no file"));
}

TEST_F(JobFile, AFileThatStandsAloneIsThePipelinesFirstInput) {
  const Catalog catalog = Catalog::FromJson(
      R"({"pipelines": [{"name": "landmark_learning", "inputs": ["samples", "log?"], "options": []}]})");
  const std::string file = (folder_ / "museum.h5").string();
  const ParsedJob parsed = ResolveJob({"landmark_learning", file, {}, 0, {}}, catalog);
  EXPECT_EQ(parsed.job.stages(0).inputs().at("samples"), "samples");
  EXPECT_FALSE(parsed.job.stages(0).inputs().contains("log"));
  EXPECT_EQ(parsed.job.inputs().at("samples"), file);
  EXPECT_EQ(parsed.inputs.at("samples").path, file);
  EXPECT_EQ(parsed.inputs.at("samples").where, "the samples");
  try {
    ResolveJob({"landmark_learning", "", {}, 0, {}}, catalog);
    FAIL() << "a job without samples was accepted";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "which samples? The file comes after the pipeline: landmark_learning FILE.h5");
  }
}

TEST_F(JobFile, InputsOfAnotherKindAreRefused) {
  const Catalog catalog = Catalog::FromJson(R"({"pipelines": [
      {"name": "landmark_learning", "inputs": ["samples"], "options": []},
      {"name": "landmark_map", "inputs": ["log"], "options": []}]})");
  const auto complaint = [&](const std::string& pipeline, const std::string& kind) -> std::string {
    const std::string file = (folder_ / (kind + ".h5")).string();
    Blob blob;
    blob.PutScalar<double>("a_m", 1);
    EXPECT_TRUE(WriteBlobFile(file, kind, blob).ok());
    ParsedJob parsed = ResolveJob({pipeline, file, {}, 0, {}}, catalog);
    try {
      ReadJobInputs(parsed, false);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(complaint("landmark_learning", "samples"), "accepted");
  EXPECT_EQ(complaint("landmark_map", "log"), "accepted");
  EXPECT_TRUE(complaint("landmark_learning", "log").ends_with("log.h5: a log, where samples are needed"));
  EXPECT_TRUE(complaint("landmark_map", "samples").ends_with("samples.h5: samples, where a log is needed"));
}

TEST_F(JobFile, ALogOfWhatNoRobotDoesIsRefusedUnlessSomebodyInsists) {
  const Catalog catalog =
      Catalog::FromJson(R"({"pipelines": [{"name": "landmark_map", "inputs": ["log"], "options": []}]})");
  Blob log;
  log.Put("robots", Array::Texts({"anna"}));
  log.PutVector("robot/0/odometry/time_s", std::vector{0.0, 1.0});
  log.PutVector("robot/0/odometry/turn_rad", std::vector{0.0, 0.0});
  log.PutVector("robot/0/odometry/forward_m", std::vector{0.0, 518.0});
  const std::string file = (folder_ / "fast.h5").string();
  ASSERT_TRUE(WriteBlobFile(file, "log", log).ok());
  ParsedJob parsed = ResolveJob({"landmark_map", file, {}, 0, {}}, catalog);
  try {
    ReadJobInputs(parsed, false);
    FAIL() << "518 m/s were accepted";
  } catch (const InputError& error) {
    const std::string said = error.what();
    EXPECT_NE(said.find("fast.h5: robot 'anna', row 2 of its odometry (1 s): it goes 518 m within 1 s"),
              std::string::npos)
        << said;
    EXPECT_NE(said.find("are distances in millimetres?"), std::string::npos) << said;
    EXPECT_NE(said.find("--units-are-right"), std::string::npos) << said;
  }
  EXPECT_EQ(ReadJobInputs(parsed, true).size(), 1U);
}

TEST_F(JobFile, APipelinesOptionsAreShownWithUnitRangeAndDefault) {
  const std::string text = PipelineText(catalog_.At("landmark_map"));
  for (const char* part : {"  log: FILE.h5\n", "  cell_m=1 m\n      edge; a number from 0.01 to 10 m\n",
                           "  iterations=10\n      most; a whole number from 1 to 100\n",
                           "  blur=true\n      true or false\n", "one of local, global"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " is not in\n" << text;
  const std::string list = PipelineList(catalog_.pipelines());
  EXPECT_NE(list.find("forward_map   log, [poses]  grids\n"), std::string::npos) << list;
  EXPECT_NE(PipelinesJson(catalog_.pipelines()).find("\"high\": 10.0"), std::string::npos);
}

// `tests/end_to_end/help_test.sh` runs those of all pipelines.
TEST_F(JobFile, AnExampleSaysNoOptionWithoutAValue) {
  PipelineSpec pipeline = catalog_.At("forward_map");
  EXPECT_EQ(PipelineText(pipeline).find("=.h5"), std::string::npos);
  pipeline.options = {catalog_.At("landmark_map").options.front(),
                      catalog_.At("landmark_map").options.front()};
  EXPECT_NE(PipelineText(pipeline).find("\n  cairn run forward_map log.h5 --set cell_m=1 --out result\n"),
            std::string::npos)
      << PipelineText(pipeline);
  // A pipeline chooses where it is 0; nobody says so.
  pipeline.options.front().name = "chosen_m";
  pipeline.options.front().default_text = "0.0";
  EXPECT_EQ(PipelineText(pipeline).find("--set chosen_m"), std::string::npos);
  pipeline.options.front().name = "runs";
  pipeline.options.front().default_text.clear();
  EXPECT_NE(PipelineText(pipeline).find(
                "\n  cairn run forward_map log.h5 --input poses=poses.h5 --set cell_m=1 --out result\n"),
            std::string::npos)
      << PipelineText(pipeline);
}

TEST_F(JobFile, InputsBesideTheLogReachTheStage) {
  const std::string log = (folder_ / "museum.h5").string();
  const ParsedJob parsed = ResolveJob({"forward_map", log, {}, 0, {"poses=" + log}}, catalog_);
  EXPECT_EQ(parsed.job.stages(0).inputs().at("poses"), "poses");
  EXPECT_EQ(parsed.job.inputs().at("poses"), log);
  EXPECT_EQ(parsed.inputs.at("poses").path, log);
}

}  // namespace
}  // namespace cairn::cli
