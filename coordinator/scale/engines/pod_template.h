// What a worker is on a Kubernetes cluster: a Pod, made of a template that people may change, and a Secret
// that holds its key.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "schema/error.h"

namespace cairn::coordinator {

struct PodOptions {
  std::string label = {};                 // the value of kScaleLabel: which `cairn scale` it belongs to
  std::string image = {};                 // empty: the template's
  std::string worker = {};                // the program; empty: the template's command
  std::vector<std::string> options = {};  // of the worker, behind those that the template has
  bool keyed = false;                     // it has a Secret of its name
  int drain_s = 60;                       // what a worker gets to finish its task
};

inline constexpr const char* kScaleLabel = "cairn-scale";
inline constexpr const char* kWorkerContainer = "worker";
inline constexpr const char* kSecretVolume = "secret";
// Where a template's Secret is to be found by its worker.
inline constexpr const char* kPodKeys = "/keys/own";
// Between the last that a worker may take to finish and the cluster's kill.
inline constexpr int kGrace_s = 15;

// deploy/kubernetes/worker-pod.yaml.
std::string DefaultPodTemplate();

// Of YAML or JSON: one Pod with a container `worker` and, for keys, a volume `secret`. kRefused, with what is
// missing and in `file`, where it is none.
Result<nlohmann::json> ReadPodTemplate(const std::string& text, const std::string& file);

nlohmann::json MakePod(const nlohmann::json& pod_template, const PodOptions& options,
                       const std::string& name);

// It goes when its Pod goes, whoever deletes it. `files`: by name, their texts.
nlohmann::json MakeSecret(const std::string& label, const std::string& name, const std::string& pod_uid,
                          const std::map<std::string, std::string>& files);

}  // namespace cairn::coordinator
