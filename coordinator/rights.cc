#include "coordinator/rights.h"

#include <array>

namespace cairn::coordinator {
namespace {

struct JobAction {
  const char* name;
  Right needed;
  std::optional<JobCommand> command;
};

const std::array kJobActions = {
    JobAction{"status", Right::kView, std::nullopt},
    JobAction{"results", Right::kView, std::nullopt},
    JobAction{"pause", Right::kSubmit, JobCommand::kPause},
    JobAction{"resume", Right::kSubmit, JobCommand::kResume},
    JobAction{"cancel", Right::kSubmit, JobCommand::kCancel},
    JobAction{"retry", Right::kSubmit, JobCommand::kRetry},
    JobAction{"delete", Right::kSubmit, JobCommand::kDelete},
    JobAction{"priority", Right::kSubmit, JobCommand::kPrioritize},
};

const JobAction* Find(const std::string& name) {
  for (const JobAction& action : kJobActions)
    if (name == action.name || (name.empty() && &action == &kJobActions[0])) return &action;
  return nullptr;
}

}  // namespace

std::optional<Right> RightNeeded(const wire::Envelope& envelope) {
  switch (envelope.body_case()) {
    case wire::Envelope::kHello:
    case wire::Envelope::kBeat:
    case wire::Envelope::kBye:
    case wire::Envelope::kDrain:
    case wire::Envelope::kDone:
    case wire::Envelope::kFailed:
    case wire::Envelope::kFetch:
      return Right::kWork;
    case wire::Envelope::kHave:
    case wire::Envelope::kSubmit:
      return Right::kSubmit;
    case wire::Envelope::kQuery: {
      const JobAction* action = Find(envelope.query().action());
      return action == nullptr ? std::nullopt : std::optional(action->needed);
    }
    default:
      return std::nullopt;
  }
}

std::optional<JobCommand> CommandOf(const std::string& action) {
  const JobAction* found = Find(action);
  return found == nullptr ? std::nullopt : found->command;
}

std::string JobActions() {
  std::string names;
  for (const JobAction& action : kJobActions) names += (names.empty() ? "" : ", ") + std::string(action.name);
  return names;
}

}  // namespace cairn::coordinator
