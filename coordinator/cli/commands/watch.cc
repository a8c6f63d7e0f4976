// cairn watch: follows jobs to their ends.
#include <chrono>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "coordinator/cli/commands/client_arguments.h"
#include "coordinator/cli/commands/report.h"
#include "coordinator/cli/commands/run_summary.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/same_job.h"
#include "coordinator/cli/common/stop_signal.h"
#include "coordinator/cli/output/console.h"
#include "coordinator/cli/output/job_text.h"
#include "schema/kinds/kind.h"

namespace cairn::cli {
namespace {

constexpr std::chrono::milliseconds kLookAtJobsAgain(200);

struct WatchArguments {
  ClientArguments client;
  std::vector<std::string> jobs;
  bool json = false;
};

// Where none is named: all that are not over, or else the last, which may have ended just now.
std::vector<std::string> JobsToWatch(const WatchArguments& options, coordinator::Client& client) {
  if (!options.jobs.empty()) return options.jobs;
  const std::vector<wire::JobInfo> jobs = Take(client.List()).jobs;
  if (jobs.empty()) throw InputError("there are no jobs");
  std::vector<std::string> ids;
  for (const wire::JobInfo& job : jobs)
    if (!IsOver(job)) ids.push_back(job.id());
  return ids.empty() ? std::vector{jobs.back().id()} : ids;
}

// Says what is new of a job, beside its progress.
class News {
 public:
  explicit News(Console& console) : console_(console) {}

  void Tell(const wire::JobInfo& info, const std::string& waits) {
    if (info.reason() != last_reason_ && !info.reason().empty())
      console_.Log(Console::Level::kWarning, info.state() + ": " + info.reason());
    last_reason_ = info.reason();
    if (waits != last_waits_ && !waits.empty()) console_.Log(Console::Level::kWarning, waits);
    last_waits_ = waits;
    if (info.retries() > last_retries_ && info.failures_size() > 0)
      console_.Log(Console::Level::kWarning, *info.failures().rbegin() + "; it is tried again");
    last_retries_ = info.retries();
  }

 private:
  Console& console_;
  std::string last_reason_, last_waits_;
  std::uint64_t last_retries_ = ~0ull;  // those before are not news
};

std::string WaitsFor(coordinator::Client& client, const wire::JobInfo& info) {
  const Result<coordinator::JobList> list = client.List();
  return list.ok() ? WaitText(info, list.value().workers) : "";
}

// What the service says; none where it does not answer: one that is started again does so soon.
template <class Answer>
const Answer* AnswerOf(const Result<Answer>& answer, Console& console) {
  if (answer.ok()) return &answer.value();
  if (answer.status().code() != Code::kIo) Throw(answer.status());
  console.Log(Console::Level::kWarning, answer.status().message());
  return nullptr;
}

// How far to trust what a job has found: of each stage that can be trusted or not, by its name. The service
// knows no kind of result, so they are fetched for it. None where they do not come.
std::vector<std::pair<std::string, datasets::Verdict>> VerdictsOf(const std::string& job,
                                                                  coordinator::Client& client,
                                                                  Console& console) {
  const Result<std::map<std::string, BlobPtr>> results = client.Results(job);
  if (!results.ok()) {
    console.Log(Console::Level::kWarning,
                "how far to trust the results is not known: " + results.status().message());
    return {};
  }
  std::vector<ScoredStage> stages;
  for (const auto& [stage, blob] : results.value())
    stages.push_back({.name = stage, .kind = KindOf(*blob), .result = blob});
  SortByJob(&stages);
  std::vector<std::pair<std::string, datasets::Verdict>> verdicts;
  for (const ScoredStage& stage : stages) {
    const datasets::ResultKind* row = datasets::FindResultKind(stage.kind);
    if (row != nullptr && row->verdict != nullptr)
      verdicts.emplace_back(stage.name, row->verdict(*stage.result));
  }
  return verdicts;
}

// The verdict is the first thing that is said of a job that is done.
std::string EndOf(const wire::JobInfo& info, bool json, coordinator::Client& client, Console& console) {
  if (info.state() != "done") return json ? JobJson(info) : JobText(info);
  const auto verdicts = VerdictsOf(info.id(), client, console);
  if (!json) {
    std::string text;
    for (const auto& [stage, verdict] : verdicts)
      text += "verdict  " + (verdicts.size() > 1 ? stage + ": " : "") + verdict.Text() + "\n";
    return text + JobText(info);
  }
  auto facts = nlohmann::ordered_json::parse(JobJson(info));
  facts["verdicts"] = nlohmann::ordered_json::array();
  for (const auto& [stage, verdict] : verdicts) {
    nlohmann::ordered_json of_stage = {{"stage", stage}};
    of_stage.update(VerdictJson(verdict));
    facts["verdicts"].push_back(of_stage);
  }
  return Dump(facts);
}

int WatchOne(const WatchArguments& options, coordinator::Client& client, const std::string& job,
             Console& console) {
  News news(console);
  SameJob same;
  for (const std::atomic<bool>& stop = StopOnSignals(); !stop;) {
    const Result<wire::JobInfo> answer = client.Info(job);
    const wire::JobInfo* info = AnswerOf(answer, console);
    if (info == nullptr) continue;
    same.Check(*info);
    if (IsOver(*info)) {
      console.Clear();
      std::fputs(EndOf(*info, options.json, client, console).c_str(), stdout);
      return ExitCodeOf(*info);
    }
    news.Tell(*info, WaitsFor(client, *info));
    console.Progress(*info);
    std::this_thread::sleep_for(kLookAtJobsAgain);
  }
  return kExitStopped;
}

int ExitCodeOfAll(const std::vector<wire::JobInfo>& jobs) {
  for (const wire::JobInfo& job : jobs)
    if (const int code = ExitCodeOf(job); code != kExitDone) return code;
  return kExitDone;
}

// Says of each how it ended, when it has. Ends as the first that was not done, where there is one.
int WatchMany(const WatchArguments& options, coordinator::Client& client, const std::vector<std::string>& ids,
              Console& console) {
  std::map<std::string, wire::JobInfo> over;
  std::map<std::string, News> news;
  std::map<std::string, SameJob> same;
  for (const std::atomic<bool>& stop = StopOnSignals(); !stop;) {
    const Result<coordinator::JobList> answer = client.List();
    const coordinator::JobList* list = AnswerOf(answer, console);
    if (list == nullptr) continue;
    std::map<std::string, wire::JobInfo> known;
    for (const wire::JobInfo& info : list->jobs) known[info.id()] = info;
    for (const std::string& id : ids) {
      if (!known.contains(id)) throw InputError("there is no job '" + id + "'");
      const wire::JobInfo& info = known.at(id);
      same[id].Check(info);
      if (!IsOver(info)) {
        news.try_emplace(id, console).first->second.Tell(info, "");
      } else if (over.emplace(id, info).second && !options.json) {
        std::printf("%s\t%s\t%zu of %zu\t%s\n", id.c_str(), info.state().c_str(), over.size(), ids.size(),
                    info.reason().c_str());
        std::fflush(stdout);
      }
    }
    if (over.size() == ids.size()) {
      coordinator::JobList ended = *list;
      ended.jobs.clear();
      for (const std::string& id : ids) ended.jobs.push_back(over.at(id));
      if (options.json) std::fputs(JobsJson(ended).c_str(), stdout);
      return ExitCodeOfAll(ended.jobs);
    }
    std::this_thread::sleep_for(kLookAtJobsAgain);
  }
  return kExitStopped;
}

int Watch(const WatchArguments& options, const Invocation& call) {
  coordinator::Client client = ConnectClient(options.client);
  Console console(call);
  const std::vector<std::string> ids = JobsToWatch(options, client);
  return ids.size() == 1 ? WatchOne(options, client, ids[0], console)
                         : WatchMany(options, client, ids, console);
}

}  // namespace

void AddWatch(Command app, Invocation& call) {
  Command command;
  const auto options =
      AddCommand<WatchArguments>(app, call, "watch", "Follows jobs to their ends, and ends as they do",
                                 "cairn watch 1-museum", Watch, &command);
  AddClientArguments(command, options->client);
  command.Add("JOB", options->jobs, "Ids (all that are not over; where none is, the last)");
  command.AddFlag("--json", options->json, "How they ended, as JSON");
}

}  // namespace cairn::cli
