// The in-process runner: a loop over a pipeline's three functions, and what it hands them. What a fleet
// computes must equal it bit for bit.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pipelines/pipeline.h"

namespace cairn {

class MapInputs : public Inputs {
 public:
  explicit MapInputs(std::map<std::string, BlobPtr> blobs = {}) : blobs_(std::move(blobs)) {}
  void Put(const std::string& name, BlobPtr blob) { blobs_[name] = std::move(blob); }
  bool Has(const std::string& name) const override { return blobs_.contains(name); }
  BlobPtr Get(const std::string& name) const override;

 private:
  std::map<std::string, BlobPtr> blobs_;
};

class VectorPartials : public Partials {
 public:
  explicit VectorPartials(std::vector<BlobPtr> blobs) : blobs_(std::move(blobs)) {}
  std::size_t size() const override { return blobs_.size(); }
  BlobPtr Get(std::size_t index) override { return blobs_.at(index); }

 private:
  std::vector<BlobPtr> blobs_;
};

class NoProgress : public Progress {
 public:
  void Tick() override {}
};

using BlobsByHash = std::map<std::string, BlobPtr>;  // binary hash -> blob

// What `ref` names: a blob of the round, or an earlier task's partial; whole, or the rows that it asks for.
BlobPtr InputOf(const proto::InputRef& ref, const BlobsByHash& store, const std::vector<BlobPtr>& partials);

// What Advance gets to see: the stage's inputs and the state's blobs.
MapInputs InputsOfRound(const proto::State& state, const BlobsByHash& store,
                        const std::map<std::string, BlobPtr>& stage_inputs);

// Runs a stage to its end and returns its result. `on_step` sees each step's plan (Start's first).
BlobPtr RunInProcess(const Pipeline& pipeline, const std::map<std::string, BlobPtr>& inputs,
                     const std::function<void(const proto::Step&)>& on_step = {});

// The maps that people are shown while it runs (State.so_far), one after the other; each is checked as who
// fetches it does.
std::vector<BlobPtr> MapsSoFar(const Pipeline& pipeline, const std::map<std::string, BlobPtr>& inputs);

}  // namespace cairn
