// Workers as Pods of a Kubernetes cluster, by kubectl: bare ones, for who owns pods together, a Deployment or
// a Job, chooses by itself which of them goes, and here it is one that has nothing to do. A Pod is called as
// its worker; its key is a Secret of the same name, which the Pod owns: it goes with it, whoever deletes it.
//
// A Pod that is deleted or evicted gets SIGTERM: its worker drains. None is begun anew by the cluster: what
// is missing is asked for again.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "coordinator/scale/engine.h"
#include "coordinator/scale/engines/pod_template.h"
#include "coordinator/scale/engines/programs.h"

namespace cairn::coordinator {

struct KubernetesOptions {
  std::vector<std::string> kubectl = {"kubectl"};  // with what leads to the cluster: --context=…
  std::string pod_template;                        // its text, of ReadPodTemplate's kind
  std::string template_file;                       // what it is called where it is found wanting
  PodOptions pod;
  std::string keys;  // folder of NAME.key and coordinator.pub, where pods are keyed
  double limit_s = 60;
};

// Of a Pod, as kubectl shows it in JSON. False: it has no name.
bool ReadPod(const nlohmann::json& pod, EngineWorker* worker);

class KubernetesEngine : public Engine {
 public:
  // The tests' own kubectl stands in for the real one.
  using Runner = std::function<ProgramOutput(const Program&)>;
  // Throws InputError where the template is none.
  explicit KubernetesEngine(KubernetesOptions options, Runner run = {});
  ~KubernetesEngine() override;
  Result<std::vector<EngineWorker>> List() override;
  Started Start(const std::vector<std::string>& names) override;
  Status Stop(const std::vector<std::string>& names) override;
  void Forget(const std::vector<std::string>& names) override;

 private:
  ProgramOutput Kubectl(const std::vector<std::string>& words, const std::string& input = "") const;
  Status GiveKeys(const std::map<std::string, std::string>& uids) const;
  Status Delete(const std::vector<std::string>& names, const char* what) const;
  Status DropForgotten();

  const KubernetesOptions options_;
  const Runner run_;
  const std::unique_ptr<const nlohmann::json> template_;
  std::set<std::string> there_;                // by the last look, and what was begun since
  std::set<std::string> stopped_;              // of those
  std::map<std::string, EngineWorker> ended_;  // whose Pod is gone, and are not forgotten yet
  std::set<std::string> forgotten_;            // what is left of them is not deleted yet
  std::set<std::string> deleted_;              // and may be shown for a while
};

}  // namespace cairn::coordinator
