#include "coordinator/cli/output/job_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/output/progress_line.h"
#include "coordinator/cli/output/text_table.h"
#include "schema/text.h"
#include "schema/wire/keys.h"

namespace cairn::cli {
namespace {

nlohmann::ordered_json NullIfUnknown(double seconds) {
  return seconds > 0 ? nlohmann::ordered_json(seconds) : nlohmann::ordered_json();
}

nlohmann::ordered_json ToJson(const wire::JobInfo& job) {
  return {{"id", job.id()},
          {"name", job.name()},
          {"owner", job.owner()},
          {"state", job.state()},
          {"reason", job.reason()},
          {"stage", job.stage()},
          {"stages", job.stages()},
          {"stage_name", job.stage_name()},
          {"round", job.round()},
          {"tasks", job.tasks()},
          {"tasks_done", job.tasks_done()},
          {"rounds_left", job.rounds_left()},
          {"workers", job.workers()},
          {"eta_s", NullIfUnknown(job.eta_s())},
          {"eta_least_s", NullIfUnknown(job.eta_least_s())},
          {"eta_most_s", NullIfUnknown(job.eta_most_s())},
          {"note", job.note()},
          {"seconds", job.seconds()},
          {"priority", job.priority()},
          {"retries", job.retries()},
          {"lost", job.lost()},
          {"failures", std::vector<std::string>(job.failures().begin(), job.failures().end())},
          {"input_error", job.input_error()}};
}

nlohmann::ordered_json ToJson(const coordinator::StoreFacts& store) {
  return {{"bytes", store.bytes}, {"limit_bytes", store.limit_bytes}};
}

// "1/2 landmarks"
std::string StageText(const wire::JobInfo& job) {
  const std::string name = job.stage_name().empty() ? "" : " " + job.stage_name();
  return fmt::format("{}/{}{}", std::min(job.stage() + 1, job.stages()), job.stages(), name);
}

// Of the stage under way: nobody knows what the later ones will take.
std::string LeftLine(const wire::JobInfo& job) {
  if (job.state() != "running") return "";
  if (job.eta_s() <= 0) return "unknown";
  const std::uint32_t later = job.stages() - std::min(job.stage() + 1, job.stages());
  if (later == 0) return "about " + LeftText(job);
  return fmt::format("about {} of this stage, and {} stage{} more", LeftText(job), later,
                     later == 1 ? "" : "s");
}

}  // namespace

std::string OwnerText(const wire::JobInfo& job) {
  return wire::IsPublicKey(job.owner()) ? wire::ShortKey(job.owner()) : job.owner();
}

std::string Dump(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

// Owners where there are several.
std::string JobTable(const std::vector<wire::JobInfo>& jobs) {
  std::vector<std::vector<std::string>> rows = {
      {"job", "name", "state", "stage", "round", "tasks", "workers", "time", "left", "note"}};
  for (const wire::JobInfo& job : jobs)
    rows.push_back({job.id(), job.name(), job.state(), StageText(job),
                    IsOver(job) ? "" : std::to_string(job.round()),
                    job.tasks() > 0 ? fmt::format("{}/{}", job.tasks_done(), job.tasks()) : "",
                    std::to_string(job.workers()), Duration(job.seconds()), LeftText(job),
                    job.reason().empty() ? job.note() : job.reason()});
  const bool several = std::ranges::any_of(
      jobs, [&jobs](const wire::JobInfo& job) { return job.owner() != jobs.front().owner(); });
  for (std::size_t row = 0; several && row < rows.size(); ++row)
    rows[row].insert(rows[row].begin() + 2, row == 0 ? "owner" : OwnerText(jobs[row - 1]));
  return TextTable(rows);
}

std::string JobText(const wire::JobInfo& job) {
  std::string text;
  const auto line = [&text](const char* what, const std::string& value) {
    if (!value.empty()) text += fmt::format("{:9}{}\n", what, value);
  };
  line("job", job.id());
  line("name", job.name());
  line("owner", OwnerText(job));
  line("state", job.state());
  line("reason", job.reason());
  line("priority", job.priority() == 0 ? "" : std::to_string(job.priority()));
  line("stage", fmt::format("{} of {}{}", std::min(job.stage() + 1, job.stages()), job.stages(),
                            job.stage_name().empty() ? "" : ", " + job.stage_name()));
  if (!IsOver(job))
    line("round",
         fmt::format("{}{}", job.round(),
                     job.rounds_left() == 0 ? "" : fmt::format(", about {} to do", job.rounds_left())));
  if (job.tasks() > 0) line("tasks", fmt::format("{} of {} in this round", job.tasks_done(), job.tasks()));
  if (!IsOver(job)) line("workers", fmt::format("{} at work on it", job.workers()));
  line("time", Duration(job.seconds()));
  line("left", LeftLine(job));
  line("note", job.note());
  if (job.retries() > 0) line("retries", fmt::format("{} in all, the last:", job.retries()));
  for (const std::string& failure : job.failures()) line("", failure);
  if (job.lost() > 0) line("lost", fmt::format("{} with their machines, which are no failures", job.lost()));
  return text;
}

std::string JobJson(const wire::JobInfo& job, const coordinator::StoreFacts* store) {
  nlohmann::ordered_json json = ToJson(job);
  if (store != nullptr) json["store"] = ToJson(*store);
  return Dump(json);
}

std::string StoreText(const coordinator::StoreFacts& store) {
  const std::string of = store.limit_bytes == 0 ? "" : " of " + BytesText(store.limit_bytes) + " allowed";
  return "store    " + BytesText(store.bytes) + of + "\n";
}

std::string WarningText(const std::string& warning) {
  return warning.empty() ? "" : "warning  " + warning + "\n";
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
                                 {"warning", list.warning},
                                 {"store", ToJson(list.store)},
                                 {"jobs", nlohmann::ordered_json::array()}};
  for (const wire::JobInfo& job : list.jobs) json["jobs"].push_back(ToJson(job));
  return Dump(json);
}

std::string JobsJson(const std::vector<wire::JobInfo>& jobs) {
  auto json = nlohmann::ordered_json::array();
  for (const wire::JobInfo& job : jobs) json.push_back(ToJson(job));
  return Dump(json);
}

std::string WaitText(const wire::JobInfo& job, unsigned workers) {
  if ((job.state() != "queued" && job.state() != "running") || workers > 0) return "";
  return "waiting: no worker is connected (start 'cairn worker')";
}

bool IsOver(const wire::JobInfo& job) {
  return job.state() == "done" || job.state() == "failed" || job.state() == "cancelled";
}

int ExitCodeOf(const wire::JobInfo& job) {
  if (job.state() == "done") return kExitDone;
  return job.input_error() ? kExitBadInput : kExitFailed;
}

}  // namespace cairn::cli
