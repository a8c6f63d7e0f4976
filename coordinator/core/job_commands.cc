#include "coordinator/core/job_commands.h"

namespace cairn::coordinator {
namespace {

std::string HowItEnded(const Job& job) {
  if (job.state == proto::JOB_FAILED) return "it has failed";
  return job.state == proto::JOB_DONE ? "it is done" : "it was cancelled";
}

std::string WhyNotRetry(const Job& job) {
  if (!job.Ended())
    return job.state == proto::JOB_PAUSED ? "it has not failed; resume goes on with it" : "it has not failed";
  if (job.state == proto::JOB_FAILED) return CheckJob(job.spec);  // it can never run
  return HowItEnded(job) + " and its checkpoints are gone; submit it again";
}

}  // namespace

std::string WhyNot(const Job& job, JobCommand command) {
  if (job.leaving && command != JobCommand::kDelete) return "it is being deleted";
  switch (command) {
    case JobCommand::kPause:
      if (job.Ended()) return HowItEnded(job);
      return job.AllStagesDone() ? "it is done but for saving its end" : "";
    case JobCommand::kResume:
      if (!job.Ended()) return "";
      return HowItEnded(job) + (job.state == proto::JOB_FAILED ? "; retry goes on with it" : "");
    case JobCommand::kCancel:
      return job.state == proto::JOB_DONE ? "it is done" : "";
    case JobCommand::kRetry:
      return WhyNotRetry(job);
    case JobCommand::kDelete:
      if (!job.Ended()) return "it has not ended; cancel it first";
      return job.pending.empty() ? "" : "what it was told last is not saved yet";
    case JobCommand::kPrioritize:
      return job.Final() ? HowItEnded(job) : "";
  }
  return "";
}

}  // namespace cairn::coordinator
