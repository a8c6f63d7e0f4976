// What a task makes of what other tasks handed over, where that cannot be true.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"
#include "pipelines/testing/in_process.h"

namespace cairn::landmark_map {
namespace {

// The first round of a log in several slices; the first `forward` task's partial.
struct HandedRound {
  HandedRound() {
    const Blob log = SquareLog{.laps = 6, .side_m = 20.0}.Make();
    step = pipeline.Start(MapInputs({{"log", std::make_shared<const Blob>(log)}}));
    for (const BlobPtr& blob : step.blobs) store[blob->ContentHash().Binary()] = blob;
    partials.assign(static_cast<std::size_t>(step.plan.tasks_size()), nullptr);
    partials[0] = std::make_shared<const Blob>(Answer(0));
  }
  MapInputs InputsOf(int task) const {
    MapInputs inputs;
    for (const proto::InputRef& ref : step.plan.tasks(task).inputs())
      inputs.Put(ref.name(), InputOf(ref, store, partials));
    return inputs;
  }
  Blob Answer(int task) const { return Run(task, InputsOf(task)); }
  Blob Run(int task, const Inputs& inputs) const {
    NoProgress progress;
    return pipeline.Run(step.plan.tasks(task), inputs, progress);
  }
  // What the second task says where "before" is `before`.
  std::string Complaint(const Blob& before) const {
    MapInputs inputs = InputsOf(1);
    inputs.Put("before", std::make_shared<const Blob>(before));
    try {
      Run(1, inputs);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }

  LandmarkMap pipeline{Options{.cell_m = 0.5, .slice_mcells = 0.5}};
  Step step;
  BlobsByHash store;
  std::vector<BlobPtr> partials;
};

TEST(HandedOver, WhatTheTaskBeforeGaveIsTaken) {
  const HandedRound round;
  ASSERT_GT(round.step.plan.tasks_size(), 3);
  EXPECT_EQ(round.Complaint(*round.partials[0]), "");
}

TEST(HandedOver, AnotherNumberOfHeadingsIsRefused) {
  const HandedRound round;
  Blob before = *round.partials[0];
  LayeredGrid alpha = LayeredGrid::LoadSparse("alpha/", before);
  alpha.layers.pop_back();
  alpha.StoreSparse("alpha/", &before);
  EXPECT_NE(round.Complaint(before).find("the input 'before' has 71 layers where the grid has 72 headings"),
            std::string::npos)
      << round.Complaint(before);
}

TEST(HandedOver, StepsThatAreNoneAreRefused) {
  const HandedRound round;
  for (const std::int32_t end : {-1, 1000000}) {
    Blob before = *round.partials[0];
    before.PutScalar<std::int32_t>("end", end);
    EXPECT_NE(round.Complaint(before).find("which are none"), std::string::npos) << end;
  }
}

TEST(HandedOver, ABetaThatDoesNotLieWhereAlphaDoesIsRefused) {
  const HandedRound round;
  // Of the first slice as a `backward` task: its alphas end where the `forward` task ended.
  const LayeredGrid alpha = LayeredGrid::LoadSparse("alpha/", *round.partials[0]);
  LayeredGrid beta;
  for (const Layer& layer : alpha.layers) {
    beta.layers.emplace_back(layer.box.empty() ? Box{0, 0, 1, 1} : layer.box.Shifted(1, 0));
    beta.layers.back().values.assign(beta.layers.back().values.size(), 1.0);
  }
  Blob later;
  later.PutScalar<std::int32_t>("first", round.partials[0]->Scalar<std::int32_t>("end"));
  beta.StoreSparse("beta/", &later);
  proto::Task backward = round.step.plan.tasks(0);
  backward.set_kind("backward");
  MapInputs inputs = round.InputsOf(0);
  inputs.Put("beta", std::make_shared<const Blob>(later));
  NoProgress progress;
  try {
    round.pipeline.Run(backward, inputs, progress);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("does not lie where alpha does"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace cairn::landmark_map
