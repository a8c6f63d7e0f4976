#include "coordinator/scale/engines/pod_template.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <utility>

namespace cairn::coordinator {
namespace {

using nlohmann::json;

template <class T>
bool ReadWhole(const std::string& text, T& value) {
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  return !text.empty() && read.ec == std::errc() && read.ptr == text.data() + text.size();
}

// As YAML 1.2 reads a plain word; what is in quotes is a text.
json ToScalar(const YAML::Node& node) {
  const std::string& text = node.Scalar();
  if (node.Tag() == "!") return text;
  if (text == "true" || text == "false") return text == "true";
  if (text.empty() || text == "null" || text == "~") return nullptr;
  std::int64_t whole = 0;
  if (ReadWhole(text, whole)) return whole;
  double real = 0;
  const bool number = text.find_first_not_of("0123456789+-.eE") == std::string::npos;
  if (number && ReadWhole(text, real)) return real;
  return text;
}

json ToJson(const YAML::Node& node) {
  if (node.IsScalar()) return ToScalar(node);
  if (node.IsSequence()) {
    json list = json::array();
    for (const YAML::Node& item : node) list.push_back(ToJson(item));
    return list;
  }
  if (!node.IsMap()) return nullptr;
  json map = json::object();
  for (const auto& entry : node) map[entry.first.Scalar()] = ToJson(entry.second);
  return map;
}

// The one of that name in the list behind `key`; null where there is none.
json* Named(json& spec, const char* key, const char* name) {
  const auto list = spec.find(key);
  if (list == spec.end() || !list->is_array()) return nullptr;
  const auto found = std::ranges::find_if(
      *list, [&](const json& one) { return one.is_object() && one.value("name", json()) == name; });
  return found == list->end() ? nullptr : &*found;
}

std::string WhatIsMissing(json& pod) {
  if (!pod.is_object() || pod.value("kind", json()) != "Pod") return "is no template of a Pod";
  const auto spec = pod.find("spec");
  if (spec == pod.end() || !spec->is_object()) return "has no spec";
  if (Named(*spec, "containers", kWorkerContainer) == nullptr)
    return std::string("has no container '") + kWorkerContainer + "'";
  const json* volume = Named(*spec, "volumes", kSecretVolume);
  if (volume == nullptr || !volume->contains("secret"))
    return std::string("has no volume '") + kSecretVolume + "' of a Secret";
  return "";
}

// The worker's own image is that of all containers which had it in the template: what copies its key has no
// other.
void SetImage(json& spec, const std::string& image) {
  const json before = Named(spec, "containers", kWorkerContainer)->value("image", json());
  for (const char* key : {"initContainers", "containers"}) {
    if (!spec.contains(key)) continue;
    for (json& container : spec[key])
      if (container.value("image", json()) == before) container["image"] = image;
  }
}

}  // namespace

Result<json> ReadPodTemplate(const std::string& text, const std::string& file) {
  json pod;
  try {
    pod = ToJson(YAML::Load(text));
    if (const std::string missing = WhatIsMissing(pod); !missing.empty())
      return Status(Code::kRefused, file + ": " + missing);
  } catch (const YAML::Exception& error) {
    return Status(Code::kRefused, file + ": line " + std::to_string(std::max(1, error.mark.line + 1)) +
                                      ": not YAML: " + error.msg);
  } catch (const json::exception&) {
    return Status(Code::kRefused, file + ": is no template of a Pod");
  }
  return pod;
}

json MakePod(const json& pod_template, const PodOptions& options, const std::string& name) {
  json pod = pod_template;
  pod["metadata"]["name"] = name;
  pod["metadata"]["labels"][kScaleLabel] = options.label;
  json& spec = pod["spec"];
  // One that ends is not begun again there: it would come back under a name that is given up.
  spec["restartPolicy"] = "Never";
  spec["terminationGracePeriodSeconds"] = options.drain_s + kGrace_s;
  if (!options.image.empty()) SetImage(spec, options.image);
  json& worker = *Named(spec, "containers", kWorkerContainer);
  if (!options.worker.empty()) worker["command"] = {options.worker};
  json& args = worker["args"];
  if (!args.is_array()) args = json::array();
  for (const std::string& word : options.options) args.push_back(word);
  args.push_back("--name");
  args.push_back(name);
  if (options.keyed) {
    const std::string keys = kPodKeys;
    for (const std::string& word :
         {std::string("--key"), keys + "/worker.key", std::string("--server-key"), keys + "/coordinator.pub"})
      args.push_back(word);
    (*Named(spec, "volumes", kSecretVolume))["secret"]["secretName"] = name;
  }
  return pod;
}

json MakeSecret(const std::string& label, const std::string& name, const std::string& pod_uid,
                const std::map<std::string, std::string>& files) {
  const json owner = {{"apiVersion", "v1"}, {"kind", "Pod"}, {"name", name}, {"uid", pod_uid}};
  return {{"apiVersion", "v1"},
          {"kind", "Secret"},
          {"metadata",
           {{"name", name}, {"labels", {{kScaleLabel, label}}}, {"ownerReferences", json::array({owner})}}},
          {"type", "Opaque"},
          {"stringData", files}};
}

}  // namespace cairn::coordinator
