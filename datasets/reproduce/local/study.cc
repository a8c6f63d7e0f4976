#include "datasets/reproduce/local/study.h"

#include "datasets/reproduce/study_inputs.h"
#include "datasets/simulate/office/office.h"

namespace cairn::datasets {

LocalStudy MakeLocalStudy(std::uint64_t seed, int seeds) {
  LocalStudy study;
  study.job.set_name("reproduce-local");
  study.job.set_seed(seed);
  study.kinds = {{"as it stands", {}}, {"furniture moves", {}}, {"a room turned", {}}};
  const std::vector<std::string> names{"office_", "moved_", "turned_"};
  for (std::size_t kind = 0; kind < study.kinds.size(); ++kind) {
    for (int i = 0; i < seeds; ++i) {
      SimulateOfficeOptions options;
      options.seed = seed + static_cast<std::uint64_t>(i);
      options.moved = kind == 1;
      options.turned = kind == 2;
      const std::string name = names[kind] + std::to_string(options.seed);
      study.inputs[name] = SimulateOffice(options);
      proto::Stage& stage = *study.job.add_stages();
      stage.set_name(name + "_map");
      stage.set_pipeline("local_map");
      (*stage.mutable_inputs())["log"] = name;
      study.kinds[kind].logs.push_back(name);
    }
  }
  NameInputs(study.inputs, &study.job);
  return study;
}

}  // namespace cairn::datasets
