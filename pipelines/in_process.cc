#include "pipelines/in_process.h"

namespace cairn {
namespace {

class MapInputs : public Inputs {
 public:
  std::map<std::string, BlobPtr> blobs;
  bool Has(const std::string& name) const override { return blobs.contains(name); }
  BlobPtr Get(const std::string& name) const override {
    const auto it = blobs.find(name);
    if (it == blobs.end()) throw InputError("there is no input '" + name + "'");
    return it->second;
  }
};

class VectorPartials : public Partials {
 public:
  std::vector<BlobPtr> blobs;
  std::size_t size() const override { return blobs.size(); }
  BlobPtr Get(std::size_t index) override { return blobs.at(index); }
};

class NoProgress : public Progress {
 public:
  void Tick() override {}
};

using Store = std::map<std::string, BlobPtr>;  // binary hash -> blob

BlobPtr Rows(const BlobPtr& blob, const proto::InputRef& ref) {
  if (ref.row_count() == 0) return blob;
  Blob rows;
  for (const auto& [name, array] : blob->fields())
    rows.Put(name, array.Rows(ref.first_row(), ref.row_count()));
  return std::make_shared<const Blob>(std::move(rows));
}

void Keep(const Step& step, Store& store) {
  for (const BlobPtr& blob : step.blobs) store[blob->ContentHash().Binary()] = blob;
}

}  // namespace

BlobPtr RunInProcess(const Pipeline& pipeline, const std::map<std::string, BlobPtr>& inputs,
                     const std::function<void(const proto::Step&)>& on_step) {
  NoProgress progress;
  Store store;
  MapInputs stage_inputs;
  stage_inputs.blobs = inputs;
  Step step = pipeline.Start(stage_inputs);
  while (true) {
    Keep(step, store);
    if (on_step) on_step(step.plan);
    if (!step.plan.result().empty()) return store.at(step.plan.result());
    VectorPartials partials;
    for (const Task& task : step.plan.tasks()) {
      MapInputs task_inputs;
      for (const proto::InputRef& ref : task.inputs()) {
        const BlobPtr blob = ref.has_task() ? partials.blobs.at(ref.task()) : store.at(ref.blob());
        task_inputs.blobs[ref.name()] = Rows(blob, ref);
      }
      partials.blobs.push_back(std::make_shared<const Blob>(pipeline.Run(task, task_inputs, progress)));
    }
    MapInputs round_inputs = stage_inputs;
    for (const auto& [name, hash] : step.plan.state().blobs()) round_inputs.blobs[name] = store.at(hash);
    step = pipeline.Advance(step.plan.state(), partials, round_inputs);
  }
}

}  // namespace cairn
