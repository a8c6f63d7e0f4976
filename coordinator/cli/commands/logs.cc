// cairn logs: what happened to a job.
#include <chrono>
#include <cstdio>
#include <thread>

#include "coordinator/cli/commands/client_arguments.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/same_job.h"
#include "coordinator/cli/common/stop_signal.h"
#include "coordinator/cli/output/console.h"
#include "coordinator/cli/output/job_text.h"
#include "coordinator/cli/output/log_text.h"

namespace cairn::cli {
namespace {

constexpr std::chrono::milliseconds kLookAgain(300);

struct LogsArguments {
  ClientArguments client;
  std::string job;
  bool follow = false;
  bool json = false;
};

// False where nobody reads any more.
bool Print(const LogsArguments& options, const std::vector<wire::LogLine>& lines, std::uint64_t& last) {
  for (const wire::LogLine& line : lines) {
    if (last == 0 && !options.json) std::fputs(GoneText(line).c_str(), stdout);
    std::fputs((options.json ? LineJson(line) : LineText(line)).c_str(), stdout);
    last = line.number();
  }
  return std::fflush(stdout) == 0;
}

int Logs(const LogsArguments& options, const Invocation& call) {
  coordinator::Client client = ConnectClient(options.client);
  Console console(call);
  const std::atomic<bool>& stop = StopOnSignals();
  std::uint64_t last = 0;
  SameJob same;
  while (!stop) {
    const Result<coordinator::LogPart> answer = client.Log(options.job, last);
    // A coordinator that is started again answers soon.
    if (options.follow && last > 0 && !answer.ok() && answer.status().code() == Code::kIo) {
      console.Log(Console::Level::kWarning, answer.status().message());
      continue;
    }
    const coordinator::LogPart part = Take(answer);
    same.Check(part.job);
    if (!Print(options, part.lines, last) || !options.follow || IsOver(part.job)) return kExitDone;
    std::this_thread::sleep_for(kLookAgain);
  }
  return kExitStopped;
}

}  // namespace

void AddLogs(Command app, Invocation& call) {
  Command command;
  auto options = AddCommand<LogsArguments>(
      app, call, "logs", "What happened to a job: rounds, failed attempts and why, lost workers, commands",
      "cairn logs 1-museum\n  cairn logs 1-museum --follow --json", Logs, &command);
  AddClientArguments(command, options->client);
  command.Add("JOB", options->job, "Its id, as submit and list say it").Required();
  command.AddFlag("-f,--follow", options->follow, "Goes on with what happens, until the job has ended");
  command.AddFlag("--json", options->json, "A line of JSON each");
}

}  // namespace cairn::cli
