#include <chrono>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "coordinator/cli/commands/client_arguments.h"
#include "coordinator/cli/commands/folder_jobs.h"
#include "coordinator/cli/commands/job_choice.h"
#include "coordinator/cli/commands/report.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/folder_lock.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/stop_signal.h"
#include "coordinator/cli/output/console.h"
#include "coordinator/cli/output/job_text.h"
#include "coordinator/cli/output/pages.h"
#include "coordinator/cli/output/service_check.h"
#include "coordinator/cli/output/service_text.h"
#include "schema/kinds/kind.h"
#include "schema/store/atomic_file.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct JobsArguments {
  ClientArguments client;
  std::string job;                // status
  std::vector<std::string> jobs;  // results
  std::string out;                // results
  JobChoice choice;               // list, results: only those
  bool json = false;
  bool check = false;                   // status
  bool force = false;                   // results
  bool so_far = false, inputs = false;  // results
};

int List(const JobsArguments& options, const Invocation&) {
  coordinator::Client client = ConnectClient(options.client);
  coordinator::JobList list = Take(client.List());
  list.jobs = Chosen(options.choice, list.jobs);
  if (options.json) {
    std::fputs(JobsJson(list).c_str(), stdout);
  } else {
    std::printf("%s%u worker%s\n%s%s%s", JobTable(list.jobs).c_str(), list.workers,
                list.workers == 1 ? "" : "s", StoreText(list.store).c_str(),
                RefusedText(list.refused).c_str(), WarningText(list.warning).c_str());
  }
  return kExitDone;
}

// A monitor reads the line and the exit code, whatever is wrong.
int CheckStatus(const JobsArguments& options) {
  ServiceVerdict verdict;
  try {
    coordinator::Client client = ConnectClient(options.client);
    const coordinator::JobList list = Take(client.List());
    verdict = CheckService(list, Take(client.Fleet()).workers);
  } catch (const std::exception& error) {
    verdict = Unanswered(error.what());
  }
  std::printf("%s\n", verdict.line.c_str());
  return verdict.code;
}

int Status(const JobsArguments& options, const Invocation&) {
  if (options.check) return CheckStatus(options);
  coordinator::Client client = ConnectClient(options.client);
  if (options.job.empty()) {
    const coordinator::JobList list = Take(client.List());
    const std::vector<wire::WorkerInfo> workers = Take(client.Fleet()).workers;
    std::fputs((options.json ? ServiceJson(list, workers) : ServiceText(list, workers)).c_str(), stdout);
    return kExitDone;
  }
  const wire::JobInfo info = Take(client.Info(options.job));
  const coordinator::JobList list = Take(client.List());
  if (options.json) {
    std::fputs(JobJson(info, &list.store).c_str(), stdout);
    return kExitDone;
  }
  std::fputs(JobText(info).c_str(), stdout);
  if (const std::string waits = WaitText(info, list.workers); !waits.empty())
    std::printf("%s\n", waits.c_str());
  return kExitDone;
}

// A result as it was fetched before.
bool Holds(const std::string& file, const Blob& result) {
  const Result<BlobFile> there = ReadBlobFile(file, {.only = {}, .without = {"provenance/"}});
  return there.ok() && there.value().blob.ContentHash() == result.Without("provenance/").ContentHash();
}

bool IsCutShort(const wire::JobInfo& job) { return job.state() == "cancelled" || job.state() == "failed"; }

const char* HowItWasCut(const wire::JobInfo& job) {
  return job.state() == "failed" ? "has failed" : "was cancelled";
}

std::string WhyNoResults(const wire::JobInfo& job) {
  if (IsCutShort(job))
    return "job " + job.id() + " " + HowItWasCut(job) + " before a stage of it was done: it has no results" +
           (job.state() == "failed" ? "" : ", and will have none");
  return "job " + job.id() + " has no results yet";
}

// A line a file, or with --json an object a job: {"job", "state", "stages", "files": [{"file", "holds"}]}.
class FetchedText {
 public:
  explicit FetchedText(bool as_json) : as_json_(as_json) {}

  void AddJob(const wire::JobInfo& job) {
    jobs_.push_back({{"job", job.id()},
                     {"state", job.state()},
                     {"stages", job.stages()},
                     {"files", nlohmann::ordered_json::array()}});
  }
  void AddFile(const std::string& file, const std::string& holds) {
    jobs_.back()["files"].push_back({{"file", file}, {"holds", holds}});
    if (!as_json_) std::printf("%s\n", file.c_str());
  }
  void Print() const {
    if (as_json_)
      std::printf("%s\n", jobs_.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  }
  bool as_json() const { return as_json_; }

 private:
  bool as_json_;
  nlohmann::ordered_json jobs_ = nlohmann::ordered_json::array();
};

// What came of a job that was cut short is said to be a part of it.
void SayWhatIsMissing(const wire::JobInfo& job, std::size_t stages) {
  if (IsCutShort(job) && stages < job.stages())
    std::printf("job %s %s: these are the results of %zu of its %u stages, those that were done\n",
                job.id().c_str(), HowItWasCut(job), stages, job.stages());
}

// What there is to see of a job's stage under way, as files of their own, which may replace earlier ones. A
// worker made it, and nobody has looked at it yet.
std::map<std::string, BlobPtr> TakeSoFar(coordinator::Client& client, const std::string& job,
                                         coordinator::ResultsFacts* facts) {
  std::map<std::string, BlobPtr> named;
  for (const auto& [stage, blob] : Take(client.SoFar(job, facts))) {
    if (KindOf(*blob) != "map_so_far")
      throw InputError("job " + job + ": what its stage '" + stage + "' shows is no map_so_far");
    CheckKind(*blob, "map_so_far");
    auto marked = std::make_shared<Blob>(*blob);
    if (const Result<Hash> job_hash = Hash::FromBinary(facts->job.hash()); job_hash.ok())
      marked->Put("so_far/job", Array::Text(job_hash.value().Hex()));
    named[stage + "-so-far"] = std::move(marked);
  }
  if (!named.empty()) return named;
  if (IsCutShort(facts->job))
    throw InputError("job " + job + " " + HowItWasCut(facts->job) + ": it shows nothing any more");
  throw InputError("job " + job + " shows nothing " +
                   (facts->job.state() == "done" ? "but its results: leave out --so-far"
                                                 : "yet, or its pipeline shows nothing on its way"));
}

std::map<std::string, BlobPtr> TakeInputs(coordinator::Client& client, const std::string& job,
                                          coordinator::ResultsFacts* facts) {
  std::map<std::string, BlobPtr> inputs = Take(client.Inputs(job, facts));
  if (inputs.empty())
    throw InputError("the inputs of job " + job + " are not kept any more: it is " + facts->job.state());
  return inputs;
}

// What there was to see of the same job before, as far as either says its job.
bool IsSoFarOf(const std::string& file, const std::string& job) {
  const Result<BlobFile> there = ReadBlobFile(file, {.only = {"so_far/job"}, .without = {}});
  if (!there.ok() || there.value().kind != "map_so_far") return false;
  const std::string known = JobOf(there.value().blob);
  return known.empty() || job.empty() || known == job;
}

// A file a stage, and the pages of what came: the log, for raw odometry and truth, stays with who has it.
// What is there already and is another is only replaced by force, and else none is written.
void Fetch(coordinator::Client& client, const std::string& job, const fs::path& folder,
           const JobsArguments& options, FetchedText& text) {
  const bool force = options.force;
  coordinator::ResultsFacts facts;
  const std::map<std::string, BlobPtr> results = options.so_far   ? TakeSoFar(client, job, &facts)
                                                 : options.inputs ? TakeInputs(client, job, &facts)
                                                                  : Take(client.Results(job, &facts));
  if (results.empty())
    throw InputError(facts.damaged.empty()
                         ? WhyNoResults(facts.job)
                         : "job " + job + " has no result that can be read: " + facts.damaged);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) Throw(SystemFailure(folder, "cannot make the folder", error.value()));
  const FolderLock lock(folder);  // another job's may be on their way there, too
  RemoveLeftovers(folder);
  for (const auto& [stage, blob] : results) {
    const std::string file = (folder / (stage + ".h5")).string();
    if (!force && fs::exists(fs::symlink_status(file)) && !Holds(file, *blob) &&
        !(options.so_far && IsSoFarOf(file, JobOf(*blob))))
      throw InputError("'" + file + "' is there already, and is not this result (--force replaces it)");
  }
  std::vector<std::string> names;
  for (const auto& [stage, blob] : results) names.push_back(stage);
  if (!force && !options.inputs) CheckPagesAreOurs(folder.string(), names, JobOf(*results.begin()->second));
  std::vector<ScoredStage> stages;
  text.AddJob(facts.job);
  for (const auto& [stage, blob] : results) {
    const std::string file = (folder / (stage + ".h5")).string();
    const std::string kind = KindOf(*blob);
    Check(WriteBlobFile(file, kind, *blob));
    text.AddFile(file, kind);
    stages.push_back({.name = stage, .kind = kind, .result = blob});
  }
  if (options.inputs) return;
  SortByJob(&stages);
  const WrittenPages written = WritePages(folder, stages);
  for (const std::string& picture : written.pictures)
    if (!picture.empty()) text.AddFile(picture, "picture");
  if (!written.report.empty()) text.AddFile(written.report, "report");
  if (!facts.damaged.empty())
    throw InputError("job " + job + ": what can be read is in '" + folder.string() + "'; it lacks " +
                     facts.damaged);
  if (!text.as_json() && !options.so_far) SayWhatIsMissing(facts.job, results.size());
}

// Of one job into --out itself; of many each into a folder of its own there.
int Results(const JobsArguments& options, const Invocation&) {
  coordinator::Client client = ConnectClient(options.client);
  std::vector<std::string> jobs = options.jobs;
  const bool by_name = !options.choice.name.empty();
  if (by_name && (options.so_far || options.inputs))
    throw InputError("--so-far and --inputs are of jobs that are named by their ids");
  if (by_name == !jobs.empty()) throw InputError("name the jobs, or say --name PATTERN");
  if (by_name)
    for (const wire::JobInfo& job : Chosen(options.choice, Take(client.List()).jobs))
      if (job.state() == "done") jobs.push_back(job.id());
  if (jobs.empty()) throw InputError("no job that is done is called '" + options.choice.name + "'");
  FetchedText text(options.json);
  try {
    for (const std::string& job : jobs) {
      const char* const what = options.so_far ? "-so-far" : options.inputs ? "-inputs" : "";
      const fs::path folder = options.out.empty()          ? fs::path(job + what)
                              : by_name || jobs.size() > 1 ? fs::path(options.out) / job
                                                           : fs::path(options.out);
      Fetch(client, job, folder, options, text);
    }
  } catch (...) {
    text.Print();  // what has come all the same
    throw;
  }
  text.Print();
  return kExitDone;
}

std::shared_ptr<JobsArguments> AddClientCommand(Command app, Invocation& call, const char* name,
                                                const char* summary, const char* example,
                                                int (*run)(const JobsArguments&, const Invocation&),
                                                Command* command) {
  auto options = AddCommand<JobsArguments>(app, call, name, summary, example, run, command);
  AddClientArguments(*command, options->client);
  return options;
}

}  // namespace

void AddJobs(Command app, Invocation& call) {
  Command command;
  auto options = AddClientCommand(app, call, "list", "All jobs of a coordinator",
                                  "cairn list --state running --name 'tour-*'", List, &command);
  command.Add("--state", options->choice.state, "Only these")
      .OneOf({"queued", "running", "paused", "done", "failed", "cancelled"});
  command.Add("--name", options->choice.name, "Only those whose name matches this pattern");
  command.AddFlag("--json", options->json, "As JSON");

  options = AddClientCommand(
      app, call, "status", "How a job stands, or the service: jobs, workers, refusals",
      "cairn status\n  cairn status 1-museum --json\n  cairn status --check || echo somebody should look",
      Status, &command);
  const Argument job =
      command.Add("JOB", options->job, "Its id, as submit and list say it (the service as a whole)");
  const Argument json = command.AddFlag("--json", options->json, "As JSON");
  command
      .AddFlag("--check", options->check,
               "The service in a line, for monitors: exit code 0 fine, 1 warning, 2 critical")
      .Excludes(job)
      .Excludes(json);

  options = AddClientCommand(app, call, "results",
                             "Fetches the results of a job, a file a stage, with pictures and a page",
                             "cairn results 1-museum --out museum", Results, &command);
  command.Add("JOB", options->jobs, "Ids; of several each goes into a folder of its own");
  command.Add("--name", options->choice.name, "All that are done whose name matches this pattern");
  const Argument so_far = command.AddFlag(
      "--so-far", options->so_far,
      "In place of results, the map of the stage under way as its last round left it: to look at, "
      "and no result");
  command
      .AddFlag("--inputs", options->inputs,
               "In place of results, what a job of one's own was given, until it is done or cancelled")
      .Excludes(so_far);
  command.Add("--out", options->out, "Folder to write to (the job's id)");
  command.AddFlag("--force", options->force, "Replace files that are there already and hold something else");
  command.AddFlag("--json", options->json, "What was written, as JSON");
}

}  // namespace cairn::cli
