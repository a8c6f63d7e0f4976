// What a job's owner tells it: pause, resume, cancel, retry, delete, priority.
#include <cstdio>
#include <map>
#include <set>

#include "coordinator/cli/commands/client_arguments.h"
#include "coordinator/cli/commands/job_choice.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/output/job_text.h"

namespace cairn::cli {
namespace {

struct JobCommandsArguments {
  ClientArguments client;
  std::string action;
  std::vector<std::string> jobs;
  JobChoice choice;  // those that are not named
  int priority = 0;
  bool json = false;
};

// The states in which a job may be told so.
bool MayBeTold(const std::string& action, const std::string& state) {
  static const std::map<std::string, std::set<std::string>> kStates = {
      {"pause", {"queued", "running"}},
      {"resume", {"paused"}},
      {"cancel", {"queued", "running", "paused", "failed"}},
      {"retry", {"failed"}},
      {"delete", {"done", "failed", "cancelled"}},
  };
  return kStates.at(action).contains(state);
}

// By a pattern those alone that can do it, and are his who asks: to cancel all of a fleet is no error where
// some are done.
std::vector<std::string> JobsToTell(const JobCommandsArguments& options, coordinator::Client& client) {
  const bool by_choice = !options.choice.name.empty() || !options.choice.state.empty();
  if (by_choice == !options.jobs.empty())
    throw InputError("name the jobs by their ids, or say --name PATTERN, --state STATE or both");
  if (!by_choice) return options.jobs;
  std::vector<std::string> ids;
  for (const wire::JobInfo& job : Chosen(options.choice, Take(client.List()).jobs))
    if (MayBeTold(options.action, job.state()) && !job.foreign()) ids.push_back(job.id());
  if (ids.empty()) throw InputError("there is no such job, or none that you can " + options.action);
  return ids;
}

// All are told, whatever one of them answers; then the first refusal is the command's.
int Tell(const JobCommandsArguments& options, const Invocation&) {
  coordinator::Client client = ConnectClient(options.client);
  cairn::Status refused;
  for (const std::string& job : JobsToTell(options, client)) {
    const Result<wire::JobInfo> info = client.Command(job, options.action, options.priority);
    if (!info.ok()) {
      if (refused.ok()) refused = info.status();
    } else if (options.json) {
      std::fputs(JobJson(info.value()).c_str(), stdout);
    } else {
      const std::string &state = info.value().state(), &reason = info.value().reason();
      const bool says_more = !reason.empty() && reason != state;
      std::printf("%s is %s%s\n", job.c_str(), state.c_str(), says_more ? (": " + reason).c_str() : "");
    }
  }
  Check(refused);
  return kExitDone;
}

std::shared_ptr<JobCommandsArguments> AddTelling(Command app, Invocation& call, const char* name,
                                                 const char* summary, const char* example, Command* command) {
  auto options = AddCommand<JobCommandsArguments>(app, call, name, summary, example, Tell, command);
  options->action = name;
  AddClientArguments(*command, options->client);
  command->AddFlag("--json", options->json, "As JSON");
  return options;
}

}  // namespace

void AddJobCommands(Command app, Invocation& call) {
  struct OfJobs {
    const char* name;
    const char* summary;
    const char* example;
  };
  Command command;
  for (const OfJobs& of : {
           OfJobs{"pause", "Hands out no more tasks of a job, until resume", "cairn pause 1-museum"},
           OfJobs{"resume", "Goes on with a job that is paused", "cairn resume 1-museum"},
           OfJobs{"cancel", "Ends a job for good; the results of stages that are done stay",
                  "cairn cancel 1-museum"},
           OfJobs{"retry", "Goes on with a job that has failed, from its last checkpoint",
                  "cairn retry 1-museum"},
           OfJobs{"delete", "Forgets jobs that have ended, their results and logs", "cairn delete 1-museum"},
       }) {
    const auto options = AddTelling(app, call, of.name, of.summary, of.example, &command);
    command.Add("JOB", options->jobs, "Ids, as submit and list say them");
    command.Add("--name", options->choice.name, "All whose name matches this pattern, and that can");
    command.Add("--state", options->choice.state, "All of this state, and that can")
        .OneOf({"queued", "running", "paused", "done", "failed", "cancelled"});
  }
  const auto options = AddTelling(
      app, call, "priority", "Gives a job a larger or smaller share of the workers; each step doubles it",
      "cairn priority 1-museum 2", &command);
  command
      .AddTaking<std::string>(
          "JOB", [options](const std::string& job) { options->jobs = {job}; },
          "Its id, as submit and list say it")
      .Required();
  command.Add("N", options->priority, "-10 to 10; jobs begin with 0").Required().Within(-10, 10);
}

}  // namespace cairn::cli
