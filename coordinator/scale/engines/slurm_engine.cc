#include "coordinator/scale/engines/slurm_engine.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <utility>

#include "schema/text.h"

namespace cairn::coordinator {
namespace {

std::vector<std::string> Split(const std::string& line, char at) {
  std::vector<std::string> parts;
  std::istringstream text(line);
  for (std::string part; std::getline(text, part, at);) parts.push_back(part);
  return parts;
}

// False where it is no number.
bool ReadNumber(const std::string& text, std::uint64_t& number) {
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  return !text.empty() && read.ec == std::errc() && read.ptr == text.data() + text.size();
}

// Of "Key=Value Key=Value".
std::string ValueOf(const std::string& shown, const std::string& key) {
  const std::size_t at = (" " + shown).find(" " + key + "=");
  if (at == std::string::npos) return "";
  const std::size_t from = at + key.size() + 1;
  return shown.substr(from, shown.find_first_of(" \n", from) - from);
}

bool IsOver(const std::string& state) {
  for (const char* over :
       {"PENDING", "RUNNING", "CONFIGURING", "SUSPENDED", "REQUEUED", "RESIZING", "SIGNALING", "STOPPED"})
    if (state == over) return false;
  return true;
}

}  // namespace

std::string SlurmFailure(const ProgramOutput& output) {
  const auto says = [&output](const char* what) { return output.failure.find(what) != std::string::npos; };
  if (output.exit_code < 0 && says("No such file or directory"))
    return output.failure +
           ": Slurm's commands are not here; run this on a machine from which jobs are submitted";
  if (says("configuration source"))
    return output.failure +
           ": this machine belongs to no Slurm cluster; run this on one from which jobs are submitted, or "
           "name "
           "the cluster's slurm.conf in SLURM_CONF";
  return output.failure;
}

std::string SlurmFileName(const std::string& path) {
  std::string text;
  for (const char c : path) text += c == '%' ? "%%" : std::string(1, c);
  return text;
}

std::string SlurmJobNumber(const std::string& printed) {
  std::uint64_t number = 0;
  std::string text = printed.substr(0, printed.find_first_of(";\n"));
  return ReadNumber(text, number) ? text : "";
}

std::string ArrayScript(const SlurmOptions& options, std::uint64_t first) {
  std::string script = "#!/bin/sh\numask 077\nname=" + ShellWord(options.prefix) + "$((" +
                       std::to_string(first) + " + SLURM_ARRAY_TASK_ID))\nexec " + ShellWord(options.worker) +
                       " --name \"$name\"";
  for (const std::string& word : options.options) script += " " + ShellWord(word);
  if (options.keyed) {
    const std::string keys = options.folder + "/keys/";
    script +=
        " --key " + ShellWord(keys) + "\"$name\".key --server-key " + ShellWord(keys + "coordinator.pub");
  }
  return script + "\n";
}

std::vector<EngineWorker> ReadQueue(const std::string& prefix, const std::string& printed,
                                    std::map<std::string, std::string>* ids) {
  std::vector<EngineWorker> workers;
  for (const std::string& line : Split(printed, '\n')) {
    const std::vector<std::string> parts = Split(line, '|');
    std::uint64_t first = 0, element = 0;
    if (parts.size() != 6 || !parts[0].starts_with(prefix)) continue;
    if (!ReadNumber(parts[0].substr(prefix.size()), first) || !ReadNumber(parts[1], element)) continue;
    EngineWorker worker{.name = prefix + std::to_string(first + element), .where = parts[3]};
    const std::string& state = parts[2];
    // CG: it has ended, and its node is tidied up.
    if (state == "CG") continue;
    if (state == "PD" || state == "CF" || state == "RQ" || state == "S") {
      worker.state = EngineWorker::State::kWaiting;
      worker.why = parts[4];
    }
    (*ids)[worker.name] = parts[5];
    workers.push_back(std::move(worker));
  }
  return workers;
}

std::string WhyEnded(const std::string& shown) {
  const std::string state = ValueOf(shown, "JobState"), reason = ValueOf(shown, "Reason");
  if (state == "COMPLETED" || state.empty()) return "";
  std::string why = "Slurm says " + state;
  if (!reason.empty() && reason != "None") why += " (" + reason + ")";
  if (state == "FAILED")
    why += ", exit code " + ValueOf(shown, "ExitCode").substr(0, ValueOf(shown, "ExitCode").find(':'));
  return Printable(why, 200);
}

SlurmEngine::SlurmEngine(SlurmOptions options, Runner run)
    : options_(std::move(options)),
      run_(run ? std::move(run) : [limit_s = options_.limit_s](const Program& program) {
        return RunPrograms({program}, limit_s)[0];
      }) {}

Result<std::vector<EngineWorker>> SlurmEngine::List() {
  const ProgramOutput queue = run_({{"squeue", "-h", "-r", "--me", "-o", "%j|%K|%t|%N|%r|%i"}, ""});
  if (queue.exit_code != 0) return Status(Code::kIo, SlurmFailure(queue));
  std::map<std::string, std::string> ids;
  std::vector<EngineWorker> workers = ReadQueue(options_.prefix, queue.out, &ids);
  // A queue that is short of some is believed where Slurm says of each that it is over.
  for (const auto& [name, id] : ids_) {
    if (ids.contains(name)) continue;
    const ProgramOutput shown = run_({{"scontrol", "-o", "show", "job", id}, ""});
    const bool known = shown.exit_code == 0;
    // A controller that cannot be reached knows nothing of any job.
    if (shown.exit_code < 0 || shown.failure.find("contact") != std::string::npos)
      return Status(Code::kIo, SlurmFailure(shown));
    const std::string where = known ? ValueOf(shown.out, "BatchHost") : "";
    if (known && !IsOver(ValueOf(shown.out, "JobState"))) {
      ids[name] = id;
      workers.push_back({.name = name, .where = where});
      continue;
    }
    ended_[name] = {.name = name,
                    .state = EngineWorker::State::kEnded,
                    .where = where,
                    .why = known ? WhyEnded(shown.out) : ""};
  }
  ids_ = std::move(ids);
  for (const auto& [name, worker] : ended_) workers.push_back(worker);
  return workers;
}

// An array for all: their numbers follow each other.
Engine::Started SlurmEngine::Start(const std::vector<std::string>& names) {
  std::uint64_t first = 0;
  if (names.empty() || !ReadNumber(names[0].substr(options_.prefix.size()), first)) return {};
  std::error_code error;
  std::filesystem::create_directories(options_.folder + "/logs", error);
  Program program{
      {"sbatch", "--parsable", "--job-name=" + names[0], "--array=0-" + std::to_string(names.size() - 1),
       "--no-requeue", "--ntasks=1", "--signal=B:TERM@" + std::to_string(options_.drain_s + 30),
       "--output=" + SlurmFileName(options_.folder + "/logs/" + options_.prefix) + "%A_%a.log",
       "--open-mode=append"},
      ArrayScript(options_, first)};
  program.words.insert(program.words.end(), options_.sbatch.begin(), options_.sbatch.end());
  const ProgramOutput output = run_(program);
  if (output.exit_code != 0) return {{}, {Code::kRefused, SlurmFailure(output)}};
  const std::string id = SlurmJobNumber(output.out);
  if (id.empty())
    return {{}, {Code::kIo, "sbatch said no number of a job, but '" + Printable(output.out, 100) + "'"}};
  for (std::size_t i = 0; i < names.size(); ++i) ids_[names[i]] = id + "_" + std::to_string(i);
  return {names, Status::Ok()};
}

Status SlurmEngine::Stop(const std::vector<std::string>& names) {
  Program program{{"scancel"}, ""};
  for (const std::string& name : names)
    if (const auto id = ids_.find(name); id != ids_.end()) program.words.push_back(id->second);
  if (program.words.size() == 1) return Status::Ok();
  const ProgramOutput output = run_(program);
  return output.exit_code == 0 ? Status::Ok() : Status(Code::kIo, SlurmFailure(output));
}

void SlurmEngine::Forget(const std::vector<std::string>& names) {
  for (const std::string& name : names) ended_.erase(name);
}

}  // namespace cairn::coordinator
