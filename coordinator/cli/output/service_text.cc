#include "coordinator/cli/output/service_text.h"

#include <map>
#include <nlohmann/json.hpp>

#include "coordinator/cli/output/job_text.h"
#include "coordinator/cli/output/progress_line.h"
#include "coordinator/cli/output/text_table.h"

namespace cairn::cli {
namespace {

using Json = nlohmann::ordered_json;

template <class Infos>
std::map<std::string, std::size_t> ByState(const Infos& infos) {
  std::map<std::string, std::size_t> counts;
  for (const auto& info : infos) ++counts[info.state()];
  return counts;
}

// "2 done, 1 running"
std::string CountsText(const std::map<std::string, std::size_t>& counts) {
  std::string text;
  for (const auto& [state, count] : counts)
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + state;
  return text.empty() ? "none" : text;
}

std::string WorkersTable(const std::vector<wire::WorkerInfo>& workers) {
  std::vector<std::vector<std::string>> rows = {
      {"worker", "host", "process", "state", "assigned", "for", "silent", "task"}};
  for (const wire::WorkerInfo& worker : workers)
    rows.push_back({std::to_string(worker.number()), worker.host(), std::to_string(worker.pid()),
                    worker.state(), std::to_string(worker.assigned()),
                    worker.assigned() == 0 ? "" : Duration(worker.task_s()), Duration(worker.silent_s()),
                    worker.task()});
  return TextTable(rows);
}

Json ToJson(const wire::WorkerInfo& worker) {
  return {{"number", worker.number()},     {"host", worker.host()},
          {"pid", worker.pid()},           {"state", worker.state()},
          {"slots", worker.slots()},       {"assigned", worker.assigned()},
          {"task", worker.task()},         {"task_s", worker.task_s()},
          {"silent_s", worker.silent_s()}, {"name", worker.name()},
          {"joined_s", worker.joined_s()}, {"failures", worker.failures()},
          {"load", worker.load()},         {"memory_bytes", worker.memory_bytes()}};
}

}  // namespace

std::string ServiceText(const coordinator::JobList& list, const std::vector<wire::WorkerInfo>& workers) {
  std::string text = WarningText(list.warning) + "jobs     " + CountsText(ByState(list.jobs)) + "\n";
  text +=
      "workers  " + (workers.empty() ? "none (start 'cairn worker')" : CountsText(ByState(workers))) + "\n";
  text += list.refused.empty() ? "refused  nothing\n" : RefusedText(list.refused);
  text += StoreText(list.store);
  return workers.empty() ? text : text + "\n" + WorkersTable(workers);
}

std::string ServiceJson(const coordinator::JobList& list, const std::vector<wire::WorkerInfo>& workers) {
  Json json = {{"jobs", ByState(list.jobs)},
               {"refused", list.refused},
               {"warning", list.warning},
               {"store", {{"bytes", list.store.bytes}, {"limit_bytes", list.store.limit_bytes}}},
               {"workers", Json::array()}};
  for (const wire::WorkerInfo& worker : workers) json["workers"].push_back(ToJson(worker));
  return Dump(json);
}

std::string WorkersJson(const std::vector<wire::WorkerInfo>& workers) {
  Json json = Json::array();
  for (const wire::WorkerInfo& worker : workers) json.push_back(ToJson(worker));
  return Dump(json);
}

}  // namespace cairn::cli
