#include "coordinator/cli/job_text.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "coordinator/cli/invocation.h"
#include "coordinator/cli/progress_line.h"
#include "coordinator/store_use.h"

namespace cairn::cli {
namespace {

nlohmann::ordered_json ToJson(const wire::JobInfo& job) {
  return {{"id", job.id()},
          {"name", job.name()},
          {"state", job.state()},
          {"reason", job.reason()},
          {"stage", job.stage()},
          {"stages", job.stages()},
          {"round", job.round()},
          {"tasks", job.tasks()},
          {"tasks_done", job.tasks_done()},
          {"rounds_left", job.rounds_left()},
          {"note", job.note()},
          {"seconds", job.seconds()},
          {"priority", job.priority()},
          {"retries", job.retries()},
          {"failures", std::vector<std::string>(job.failures().begin(), job.failures().end())},
          {"input_error", job.input_error()}};
}

nlohmann::ordered_json ToJson(const coordinator::StoreFacts& store) {
  return {{"bytes", store.bytes}, {"limit_bytes", store.limit_bytes}};
}

}  // namespace

std::string Dump(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string JobTable(const std::vector<wire::JobInfo>& jobs) {
  char line[256];
  std::snprintf(line, sizeof line, "%-20s %-16s %-10s %6s %8s  %s\n", "job", "name", "state", "stage", "time",
                "note");
  std::string text = line;
  for (const wire::JobInfo& job : jobs) {
    const std::string stage =
        std::to_string(std::min(job.stage() + 1, job.stages())) + "/" + std::to_string(job.stages());
    std::snprintf(line, sizeof line, "%-20s %-16s %-10s %6s %8s  ", job.id().c_str(), job.name().c_str(),
                  job.state().c_str(), stage.c_str(), Duration(job.seconds()).c_str());
    text += line + (job.reason().empty() ? job.note() : job.reason()) + "\n";
  }
  return text;
}

std::string JobText(const wire::JobInfo& job) {
  std::string text = "job      " + job.id() + "\nname     " + job.name() + "\nstate    " + job.state() + "\n";
  if (!job.reason().empty()) text += "reason   " + job.reason() + "\n";
  if (job.priority() != 0) text += "priority " + std::to_string(job.priority()) + "\n";
  text += "stage    " + std::to_string(std::min(job.stage() + 1, job.stages())) + " of " +
          std::to_string(job.stages()) + "\nround    " + std::to_string(job.round()) + "\n";
  if (job.tasks() > 0) {
    text += "tasks    " + std::to_string(job.tasks_done()) + " of " + std::to_string(job.tasks()) +
            " in this round\n";
  }
  text += "time     " + Duration(job.seconds()) + "\n";
  if (!job.note().empty()) text += "note     " + job.note() + "\n";
  if (job.retries() > 0) text += "retries  " + std::to_string(job.retries()) + " in all, the last:\n";
  for (const std::string& failure : job.failures()) text += "         " + failure + "\n";
  return text;
}

std::string JobJson(const wire::JobInfo& job, const coordinator::StoreFacts* store) {
  nlohmann::ordered_json json = ToJson(job);
  if (store != nullptr) json["store"] = ToJson(*store);
  return Dump(json);
}

std::string StoreText(const coordinator::StoreFacts& store) {
  const std::string of =
      store.limit_bytes == 0 ? "" : " of " + coordinator::BytesText(store.limit_bytes) + " allowed";
  return "store " + coordinator::BytesText(store.bytes) + of + "\n";
}

std::string RefusedText(const std::map<std::string, std::uint64_t>& refused) {
  std::string text;
  for (const auto& [kind, count] : refused)
    text += (text.empty() ? "refused  " : ", ") + kind + " " + std::to_string(count);
  return text.empty() ? "" : text + "\n";
}

std::string JobsJson(const coordinator::JobList& list) {
  nlohmann::ordered_json json = {{"workers", list.workers},
                                 {"refused", list.refused},
                                 {"store", ToJson(list.store)},
                                 {"jobs", nlohmann::ordered_json::array()}};
  for (const wire::JobInfo& job : list.jobs) json["jobs"].push_back(ToJson(job));
  return Dump(json);
}

bool IsOver(const wire::JobInfo& job) {
  return job.state() == "done" || job.state() == "failed" || job.state() == "cancelled";
}

int ExitCodeOf(const wire::JobInfo& job) {
  if (job.state() == "done") return kExitDone;
  return job.input_error() ? kExitBadInput : kExitFailed;
}

}  // namespace cairn::cli
