#include "coordinator/scale/engines/kubernetes_engine.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "schema/text.h"

namespace cairn::coordinator {
namespace {

using nlohmann::json;

constexpr std::size_t kMostWhy = 300;

// What the system says where kubectl is missing helps nobody.
std::string KubectlFailure(const ProgramOutput& output) {
  if (output.exit_code >= 0 || output.failure.find("No such file or directory") == std::string::npos)
    return output.failure;
  return output.failure +
         ": it is not here; install it (Debian: kubernetes-client) and give it a cluster (KUBECONFIG)";
}

// Discarded also where it is deeper or more than any list of pods: 16 MB of `[` would take a gigabyte.
json ParseAnswer(const std::string& text) {
  constexpr int kMostDeep = 64;
  constexpr std::size_t kMostValues = 1'000'000;
  std::size_t values = 0;
  const auto look = [&](int depth, json::parse_event_t, const json&) {
    if (depth > kMostDeep || ++values > kMostValues) throw std::length_error("too much");
    return true;
  };
  try {
    return json::parse(text, look, false);
  } catch (const std::length_error&) {
    return json(json::value_t::discarded);
  }
}

// These must be objects and texts, says Kubernetes; whatever else they are counts as nothing.
const json& At(const json& from, const char* key) {
  static const json kNothing;
  const auto found = from.is_object() ? from.find(key) : from.end();
  return from.is_object() && found != from.end() ? *found : kNothing;
}
std::string TextAt(const json& from, const char* key) {
  const json& text = At(from, key);
  return text.is_string() ? text.get<std::string>() : "";
}
std::string Joined(const std::string& reason, const std::string& message) {
  if (reason.empty() || message.empty()) return reason + message;
  return reason + ": " + message;
}

// Of all containers: those that prepare, then the worker.
std::vector<json> Containers(const json& status) {
  std::vector<json> all;
  for (const char* key : {"initContainerStatuses", "containerStatuses"})
    for (const json& one : At(status, key)) all.push_back(one);
  return all;
}

// The cluster would try such a one for ever.
bool IsHopeless(const std::string& reason) {
  for (const char* one : {"ImagePullBackOff", "InvalidImageName", "ErrImageNeverPull",
                          "CreateContainerConfigError", "CreateContainerError"})
    if (reason == one) return true;
  return false;
}

void ReadWaiting(const json& status, EngineWorker* worker) {
  worker->state = EngineWorker::State::kWaiting;
  for (const json& one : At(status, "conditions"))
    if (TextAt(one, "type") == "PodScheduled" && TextAt(one, "status") == "False")
      worker->why = Joined(TextAt(one, "reason"), TextAt(one, "message"));
  for (const json& container : Containers(status)) {
    const json& waiting = At(At(container, "state"), "waiting");
    const std::string reason = TextAt(waiting, "reason");
    if (reason.empty() || reason == "PodInitializing") continue;
    worker->why = Joined(reason, TextAt(waiting, "message"));
    if (!IsHopeless(reason)) continue;
    worker->state = EngineWorker::State::kEnded;
    return;
  }
}

std::string WhyFailed(const json& status) {
  std::string why = Joined(TextAt(status, "reason"), TextAt(status, "message"));
  for (const json& container : Containers(status)) {
    const json& ended = At(At(container, "state"), "terminated");
    const json& code = At(ended, "exitCode");
    if (!code.is_number_integer() || code == 0) continue;
    if (!why.empty()) why += "; ";
    const std::string reason = TextAt(ended, "reason");
    if (reason == "OOMKilled")
      why += "OOMKilled: it took more memory than its container may (limits.memory of the pod template)";
    else
      why += (reason.empty() || reason == "Error" ? "" : reason + ", ") + "exit code " + code.dump();
    // The last line that it wrote says it best.
    std::string said = TextAt(ended, "message");
    while (!said.empty() && said.back() == '\n') said.pop_back();
    if (!said.empty()) why += ": " + said.substr(said.rfind('\n') + 1);
    break;
  }
  return why.empty() ? "it failed, and the cluster does not say why" : why;
}

Result<std::string> ReadKeyFile(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file || text.str().empty()) return Status(Code::kIo, path + ": cannot be read");
  return text.str();
}

std::unique_ptr<const json> TakeTemplate(const KubernetesOptions& options) {
  Result<json> read = ReadPodTemplate(options.pod_template, options.template_file);
  if (!read.ok()) throw InputError(read.status().message());
  return std::make_unique<const json>(std::move(read).value());
}

std::string ListOf(json items) {
  const json list = {{"apiVersion", "v1"}, {"kind", "List"}, {"items", std::move(items)}};
  return list.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace

bool ReadPod(const json& pod, EngineWorker* worker) {
  const json& status = At(pod, "status");
  const std::string phase = TextAt(status, "phase");
  worker->name = TextAt(At(pod, "metadata"), "name");
  worker->where = TextAt(At(pod, "spec"), "nodeName");
  if (phase == "Pending") ReadWaiting(status, worker);
  // Unknown: its node says nothing. Whether it is lost is seen by who waits for its worker.
  if (phase == "Succeeded" || phase == "Failed") worker->state = EngineWorker::State::kEnded;
  if (phase == "Failed") worker->why = WhyFailed(status);
  worker->why = Printable(worker->why, kMostWhy);
  return !worker->name.empty();
}

KubernetesEngine::KubernetesEngine(KubernetesOptions options, Runner run)
    : options_(std::move(options)),
      run_(run ? std::move(run)
               : [limit_s = options_.limit_s](
                     const Program& program) { return RunPrograms({program}, limit_s)[0]; }),
      template_(TakeTemplate(options_)) {}

KubernetesEngine::~KubernetesEngine() { static_cast<void>(DropForgotten()); }

ProgramOutput KubernetesEngine::Kubectl(const std::vector<std::string>& words,
                                        const std::string& input) const {
  Program program{options_.kubectl, input};
  program.words.insert(program.words.end(), words.begin(), words.end());
  return run_(program);
}

Result<std::vector<EngineWorker>> KubernetesEngine::List() {
  if (const Status dropped = DropForgotten(); !dropped.ok()) return dropped;
  const ProgramOutput shown = Kubectl(
      {"get", "pods", std::string("--selector=") + kScaleLabel + "=" + options_.pod.label, "-o", "json"});
  if (shown.exit_code != 0) return Status(Code::kIo, KubectlFailure(shown));
  const json list = ParseAnswer(shown.out);
  if (!At(list, "items").is_array()) return Status(Code::kIo, "kubectl: what it shows is no list of pods");
  std::vector<EngineWorker> workers;
  std::set<std::string> there, still_there;
  for (const json& pod : At(list, "items")) {
    EngineWorker worker;
    if (!ReadPod(pod, &worker)) continue;
    if (deleted_.contains(worker.name)) {
      still_there.insert(worker.name);
      continue;
    }
    there.insert(worker.name);
    workers.push_back(std::move(worker));
  }
  for (const std::string& name : there_) {
    if (there.contains(name)) continue;
    ended_[name] = {.name = name,
                    .state = EngineWorker::State::kEnded,
                    .why = stopped_.contains(name) ? "" : "its pod was deleted, not from here"};
    stopped_.erase(name);
  }
  there_ = std::move(there);
  deleted_ = std::move(still_there);
  for (const auto& [name, worker] : ended_) workers.push_back(worker);
  return workers;
}

// First the pods, which wait for their Secrets; then those, each its pod's.
Engine::Started KubernetesEngine::Start(const std::vector<std::string>& names) {
  json pods = json::array();
  for (const std::string& name : names) pods.push_back(MakePod(*template_, options_.pod, name));
  // One that is refused is no reason for kubectl not to begin the others.
  const ProgramOutput created =
      Kubectl({"create", "-f", "-", "-o", R"(jsonpath={.metadata.name} {.metadata.uid}{"\n"})"},
              ListOf(std::move(pods)));
  Status status = created.exit_code == 0 ? Status::Ok() : Status(Code::kRefused, KubectlFailure(created));
  std::map<std::string, std::string> uids;
  std::istringstream lines(created.out);
  for (std::string name, uid; lines >> name >> uid;)
    if (std::ranges::count(names, name) > 0) uids[name] = uid;
  std::vector<std::string> begun;
  for (const std::string& name : names)
    if (uids.contains(name)) begun.push_back(name);
  if (const Status given = GiveKeys(uids); !given.ok()) {
    static_cast<void>(Delete(begun, "pods"));
    return {{}, given};
  }
  there_.insert(begun.begin(), begun.end());
  return {begun, status};
}

Status KubernetesEngine::GiveKeys(const std::map<std::string, std::string>& uids) const {
  if (!options_.pod.keyed || uids.empty()) return Status::Ok();
  const Result<std::string> server = ReadKeyFile(options_.keys + "/coordinator.pub");
  if (!server.ok()) return server.status();
  json secrets = json::array();
  for (const auto& [name, uid] : uids) {
    Result<std::string> key = ReadKeyFile(options_.keys + "/" + name + ".key");
    if (!key.ok()) return key.status();
    secrets.push_back(MakeSecret(options_.pod.label, name, uid,
                                 {{"worker.key", key.value()}, {"coordinator.pub", server.value()}}));
  }
  const ProgramOutput created = Kubectl({"create", "-f", "-", "-o", "name"}, ListOf(std::move(secrets)));
  return created.exit_code == 0 ? Status::Ok() : Status(Code::kRefused, KubectlFailure(created));
}

Status KubernetesEngine::Delete(const std::vector<std::string>& names, const char* what) const {
  if (names.empty()) return Status::Ok();
  std::vector<std::string> words = {"delete", what, "--ignore-not-found", "--wait=false", "-o", "name"};
  words.insert(words.end(), names.begin(), names.end());
  const ProgramOutput deleted = Kubectl(words);
  return deleted.exit_code == 0 ? Status::Ok() : Status(Code::kIo, KubectlFailure(deleted));
}

Status KubernetesEngine::Stop(const std::vector<std::string>& names) {
  stopped_.insert(names.begin(), names.end());
  return Delete(names, "pods");
}

// All that end at a time go by one command, at the next look.
void KubernetesEngine::Forget(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    ended_.erase(name);
    stopped_.erase(name);
    there_.erase(name);
    forgotten_.insert(name);
  }
}

Status KubernetesEngine::DropForgotten() {
  const Status dropped = Delete({forgotten_.begin(), forgotten_.end()}, "pods,secrets");
  if (dropped.ok()) deleted_.merge(std::exchange(forgotten_, {}));
  return dropped;
}

}  // namespace cairn::coordinator
