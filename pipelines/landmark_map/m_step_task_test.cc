#include "pipelines/landmark_map/m_step_task.h"

#include <gtest/gtest.h>

#include <memory>

#include "pipelines/in_process.h"
#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

// The first round of a log: what its task `m_step` returns, and the partials that it was made of.
struct Round {
  Round() {
    const Blob log = SquareLog{.laps = 6, .side_m = 20.0}.Make();
    const Step step = pipeline.Start(MapInputs({{"log", std::make_shared<const Blob>(log)}}));
    BlobsByHash store;
    for (const BlobPtr& blob : step.blobs) store[blob->ContentHash().Binary()] = blob;
    NoProgress progress;
    for (const Task& task : step.plan.tasks()) {
      MapInputs inputs;
      for (const proto::InputRef& ref : task.inputs()) inputs.Put(ref.name(), InputOf(ref, store, partials));
      partials.push_back(std::make_shared<const Blob>(pipeline.Run(task, inputs, progress)));
    }
  }

  LandmarkMap pipeline{Options{.cell_m = 0.5, .growth_start = 1.0, .starts = 1, .slice_mcells = 0.5}};
  std::vector<BlobPtr> partials;
};

// What Advance gets to see is what the partials, added up here, say.
TEST(MStepTask, ReturnsTheSumOfThePartialsAndTheMapOfIt) {
  const Round round;
  ASSERT_GT(round.partials.size(), 3U);
  const MStep made = MStep::FromBlob(*round.partials.back(), 1);
  LayeredGrid none;
  none.layers.resize(made.sum.counts().layers.size());
  RoundSum sum(std::move(none), 1);
  for (std::size_t i = 0; i + 1 < round.partials.size(); ++i) sum.Add(*round.partials[i]);
  EXPECT_EQ(made.sum.ToBlob().ContentHash(), sum.ToBlob().ContentHash());
  EXPECT_NEAR(made.sum.counts().Sum(), 6 * 4.0, 1e-6);  // a contact detection at each corner
  EXPECT_FALSE(made.landmarks.empty());
  EXPECT_FALSE(made.perception.likelihood.layers.empty());
}

TEST(MStepTask, ASumOfOtherRobotsIsRefused) {
  const Round round;
  EXPECT_THROW(MStep::FromBlob(*round.partials.back(), 2), InputError);
  EXPECT_THROW(MStep::FromBlob(round.partials.back()->Without("sum/counts/"), 1), InputError);
}

}  // namespace
}  // namespace cairn::landmark_map
