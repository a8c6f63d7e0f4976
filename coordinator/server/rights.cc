#include "coordinator/server/rights.h"

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
    JobAction{"inputs", Right::kSubmit, std::nullopt},
    JobAction{"so_far", Right::kView, std::nullopt},
    JobAction{"logs", Right::kView, std::nullopt},
    JobAction{"pause", Right::kSubmit, JobCommand::kPause},
    JobAction{"resume", Right::kSubmit, JobCommand::kResume},
    JobAction{"cancel", Right::kSubmit, JobCommand::kCancel},
    JobAction{"retry", Right::kSubmit, JobCommand::kRetry},
    JobAction{"delete", Right::kSubmit, JobCommand::kDelete},
    JobAction{"priority", Right::kSubmit, JobCommand::kPrioritize},
};

struct WorkerAction {
  const char* name;
  Right needed;
};

const std::array kWorkerActions = {
    WorkerAction{"status", Right::kView},
    WorkerAction{"drain", Right::kSubmit},
};

// No name asks for the first, `status`.
template <class Actions>
auto Find(const Actions& actions, const std::string& name) -> decltype(actions.data()) {
  for (const auto& action : actions)
    if (name == action.name || (name.empty() && &action == actions.data())) return &action;
  return nullptr;
}

template <class Actions>
std::optional<Right> RightOf(const Actions& actions, const std::string& name) {
  const auto* action = Find(actions, name);
  return action == nullptr ? std::nullopt : std::optional(action->needed);
}

template <class Actions>
std::string Names(const Actions& actions) {
  std::string names;
  for (const auto& action : actions) names += (names.empty() ? "" : ", ") + std::string(action.name);
  return names;
}

}  // namespace

std::optional<Right> RightNeeded(const wire::Envelope& envelope) {
  switch (envelope.body_case()) {
    case wire::Envelope::kHello:
    case wire::Envelope::kHeartbeat:
    case wire::Envelope::kLeave:
    case wire::Envelope::kDrain:
    case wire::Envelope::kDone:
    case wire::Envelope::kFailed:
    case wire::Envelope::kFetch:
      return Right::kWork;
    case wire::Envelope::kHave:
    case wire::Envelope::kSubmit:
    case wire::Envelope::kOffer:
    case wire::Envelope::kPiece:
    case wire::Envelope::kClean:
      return Right::kSubmit;
    case wire::Envelope::kQuery:
      return RightOf(kJobActions, envelope.query().action());
    case wire::Envelope::kWorkers:
      return RightOf(kWorkerActions, envelope.workers().action());
    default:
      return std::nullopt;
  }
}

std::optional<JobCommand> CommandOf(const std::string& action) {
  const JobAction* found = Find(kJobActions, action);
  return found == nullptr ? std::nullopt : found->command;
}

std::string JobActions() { return Names(kJobActions); }

std::string WorkerActions() { return Names(kWorkerActions); }

}  // namespace cairn::coordinator
