#include "pipelines/testing/in_process.h"

#include <stdexcept>

#include "schema/blob_part.h"
#include "schema/kinds/kind.h"

namespace cairn {

BlobPtr MapInputs::Get(const std::string& name) const {
  const auto it = blobs_.find(name);
  if (it == blobs_.end()) throw InputError("there is no input '" + name + "'");
  return it->second;
}

BlobPtr InputOf(const proto::InputRef& ref, const BlobsByHash& store, const std::vector<BlobPtr>& partials) {
  const BlobPtr whole = ref.has_task() ? partials.at(ref.task()) : store.at(ref.blob());
  if (ref.has_part()) {
    const Result<BlobPtr> part = CutPart(*whole, ref.part());
    if (!part.ok()) throw std::runtime_error(part.status().message());
    return part.value();
  }
  if (ref.row_count() == 0) return whole;
  Blob rows;
  for (const auto& [name, array] : whole->fields())
    rows.Put(name, array.Rows(ref.first_row(), ref.row_count()));
  return std::make_shared<const Blob>(std::move(rows));
}

MapInputs InputsOfRound(const proto::State& state, const BlobsByHash& store,
                        const std::map<std::string, BlobPtr>& stage_inputs) {
  MapInputs inputs(stage_inputs);
  for (const auto& [name, hash] : state.blobs()) inputs.Put(name, store.at(hash));
  return inputs;
}

BlobPtr RunInProcess(const Pipeline& pipeline, const std::map<std::string, BlobPtr>& inputs,
                     const std::function<void(const proto::Step&)>& on_step) {
  NoProgress progress;
  BlobsByHash store;  // tasks may name the stage's inputs too
  for (const auto& [name, blob] : inputs) {
    CheckInput(*blob, name);  // as a worker does
    store[blob->ContentHash().Binary()] = blob;
  }
  Step step = pipeline.Start(MapInputs(inputs));
  while (true) {
    for (const BlobPtr& blob : step.blobs) store[blob->ContentHash().Binary()] = blob;
    if (on_step) on_step(step.plan);
    if (!step.plan.result().empty()) return store.at(step.plan.result());
    std::vector<BlobPtr> done;
    for (const Task& task : step.plan.tasks()) {
      MapInputs task_inputs;
      for (const proto::InputRef& ref : task.inputs()) task_inputs.Put(ref.name(), InputOf(ref, store, done));
      done.push_back(std::make_shared<const Blob>(pipeline.Run(task, task_inputs, progress)));
    }
    VectorPartials partials(std::move(done));
    step = pipeline.Advance(step.plan.state(), partials, InputsOfRound(step.plan.state(), store, inputs));
  }
}

namespace {

class ShownMaps : public Pipeline {
 public:
  explicit ShownMaps(const Pipeline& of) : of_(of) {}
  Step Start(const Inputs& inputs) const override { return Seen(of_.Start(inputs)); }
  Blob Run(const Task& task, const Inputs& inputs, Progress& progress) const override {
    return of_.Run(task, inputs, progress);
  }
  Step Advance(const State& state, Partials& partials, const Inputs& inputs) const override {
    return Seen(of_.Advance(state, partials, inputs));
  }
  std::vector<BlobPtr> maps() const { return maps_; }

 private:
  Step Seen(Step step) const {
    for (const BlobPtr& blob : step.blobs)
      if (blob->ContentHash().Binary() == step.plan.state().so_far()) maps_.push_back(blob);
    return step;
  }

  const Pipeline& of_;
  mutable std::vector<BlobPtr> maps_;
};

}  // namespace

std::vector<BlobPtr> MapsSoFar(const Pipeline& pipeline, const std::map<std::string, BlobPtr>& inputs) {
  const ShownMaps shown(pipeline);
  RunInProcess(shown, inputs);
  for (const BlobPtr& map : shown.maps()) {
    if (KindOf(*map) != "map_so_far") throw InputError("what is shown is " + WithArticle(KindOf(*map)));
    CheckKind(*map, "map_so_far");
  }
  return shown.maps();
}

}  // namespace cairn
