#include "coordinator/cli/app.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/home.h"
#include "coordinator/cli/common/programs.h"
#include "coordinator/cli/job_file/arguments.h"
#include "coordinator/cli/output/pipeline_text.h"
#include "coordinator/cli/program.h"

namespace cairn::cli {
namespace {

void AddCommands(Command app, Invocation& call) {
  AddMap(app, call);
  AddRun(app, call);
  AddCoordinator(app, call);
  AddSimulate(app, call);
  AddImport(app, call);
  AddLandmarks(app, call);
  AddPipelines(app, call);
  AddInspect(app, call);
  AddEvaluate(app, call);
  AddReport(app, call);
  AddExport(app, call);
  AddDiff(app, call);
  AddWorker(app, call);
  AddPage(app, call);
  AddSubmit(app, call);
  AddJobs(app, call);
  AddWatch(app, call);
  AddLogs(app, call);
  AddJobCommands(app, call);
  AddScale(app, call);
  AddDrain(app, call);
  AddClean(app, call);
  AddCheck(app, call);
  AddBackup(app, call);
  AddKeys(app, call);
}

// Over TCP the keys are those in the folder of keys, where nobody says otherwise.
void AddKeyArguments(std::vector<std::string>& words, const char* key) {
  const auto any = [&words](const char* what) {
    return std::ranges::any_of(words, [what](const std::string& word) { return word.starts_with(what); });
  };
  const bool tcp =
      std::ranges::any_of(words, [](const std::string& w) { return w.find("tcp://") != std::string::npos; });
  if (tcp && !any("--key")) words.push_back("--key=" + DefaultKey(key));
  if (tcp && !any("--server-key")) words.push_back("--server-key=" + DefaultKey("coordinator.pub"));
}

// `cairn worker …` becomes cairn-worker: the science stays out of this process; and `cairn page …`
// cairn-page, HTTP does. Without --connect it looks for the coordinator where `cairn coordinator` listens
// when nobody says otherwise.
int Become(const std::string& program, const char* key, int argc, char** argv) {
  std::vector<std::string> words = {program};
  for (int i = 2; i < argc; ++i) words.emplace_back(argv[i]);
  const bool elsewhere = std::ranges::any_of(words, [](const std::string& word) {
    return word.starts_with("--connect") || word == "--help" || word == "-h" || word == "--describe" ||
           word == "--version";
  });
  if (!elsewhere) words.push_back("--connect=" + DefaultEndpoint());
  AddKeyArguments(words, key);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(pointers[0], pointers.data());
  throw WorldError(words[0] + " cannot be run");
}

// The pipeline that `cairn run PIPELINE --help` asks about; empty where it asks about the command.
std::string PipelineAskedAbout(int argc, char** argv) {
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i)
    if (const std::string_view word = argv[i]; word != "--help" && word != "-h") words.emplace_back(word);
  const bool runs = words.size() > 1 && (words[0] == "run" || words[0] == "submit");
  return runs && !words[1].starts_with('-') && !IsJobFile(words[1]) ? words[1] : "";
}

std::function<int()> Instead(int argc, char** argv) {
  const std::vector<std::string_view> words(argv + 1, argv + argc);
  if (!words.empty() && words[0] == "worker")
    return [argc, argv] { return Become(WorkerProgram(), "worker.key", argc, argv); };
  if (!words.empty() && words[0] == "page")
    return [argc, argv] { return Become(PageProgramPath(), "client.key", argc, argv); };
  const bool help =
      std::ranges::find(words, "--help") != words.end() || std::ranges::find(words, "-h") != words.end();
  const std::string pipeline = help ? PipelineAskedAbout(argc, argv) : "";
  if (pipeline.empty()) return {};
  return [pipeline] {
    std::fputs(PipelineText(LoadCatalog().At(pipeline)).c_str(), stdout);
    return kExitDone;
  };
}

}  // namespace

int Main(int argc, char** argv) {
  return RunProgram(
      {.name = "cairn",
       .purpose =
           "Cairn turns robot logs into maps and learned landmarks, the same bits on a laptop or a cluster.",
       .example = "cairn simulate loop log.h5 && cairn map log.h5 --out result",
       .add_commands = AddCommands,
       .instead = Instead},
      argc, argv);
}

}  // namespace cairn::cli
