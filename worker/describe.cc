#include "worker/describe.h"

#include <nlohmann/json.hpp>

namespace cairn::worker {
namespace {

using Json = nlohmann::ordered_json;

Json ValueOf(const proto::Value& value) {
  switch (value.kind_case()) {
    case proto::Value::kI:
      return value.i();
    case proto::Value::kD:
      return value.d();
    case proto::Value::kB:
      return value.b();
    case proto::Value::kS:
      return value.s();
    default:
      return nullptr;
  }
}

Json OptionOf(const OptionInfo& option) {
  Json json = {{"name", option.name}, {"type", option.type}, {"unit", option.unit}, {"help", option.help}};
  json["default"] = ValueOf(option.default_value);
  if (option.type == "real" || option.type == "integer") {
    json["low"] = option.low;
    json["high"] = option.high;
  }
  if (!option.choices.empty()) json["choices"] = option.choices;
  return json;
}

}  // namespace

std::string DescribePipelines(const std::vector<PipelineInfo>& pipelines) {
  Json list = Json::array();
  for (const PipelineInfo& info : pipelines) {
    Json json = {{"name", info.name}, {"summary", info.summary}};
    json["inputs"] = info.inputs;
    json["options"] = Json::array();
    for (const OptionInfo& option : info.options) json["options"].push_back(OptionOf(option));
    list.push_back(std::move(json));
  }
  return Json{{"version", CAIRN_VERSION}, {"pipelines", std::move(list)}}.dump(2);
}

}  // namespace cairn::worker
