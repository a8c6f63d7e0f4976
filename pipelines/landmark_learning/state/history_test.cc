#include "pipelines/landmark_learning/state/history.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "pipelines/testing/in_process.h"

namespace cairn::landmark_learning {
namespace {

// A million steps would take a test too long; what a State names and what a step makes anew is the same.
TEST(History, NamesFewBlobsHowEverManySteps) {
  constexpr int kSteps = 40'000;
  History history;
  State state;
  BlobsByHash store;
  std::size_t made = 0, most_names = 0;
  for (int s = 0; s < kSteps; ++s) {
    const MapInputs inputs = InputsOfRound(state, store, {});
    history = Read<History>(BlobOf(history));  // what travels
    history.Add(s, s % 3 == 0 ? 0.5 * s : kNone, 2.0 * s);
    Step step;
    history.Share(state, inputs, &step);
    for (const BlobPtr& blob : step.blobs) {
      store[blob->ContentHash().Binary()] = blob;
      made += blob->ByteCount();
    }
    state = step.plan.state();
    most_names = std::max(most_names, static_cast<std::size_t>(state.blobs_size()));
    EXPECT_LT(BlobOf(history).ByteCount(), 4000U);
  }
  EXPECT_LE(most_names, 9U);  // 40,000 / 128 is below 2^9
  EXPECT_LT(made, std::size_t{kSteps} * 3 * 8 * 9);
  const HistoryRows all = history.All(InputsOfRound(state, store, {}));
  ASSERT_EQ(all.size(), std::size_t{kSteps});
  for (std::size_t s = 0; s < all.size(); ++s) {
    const auto step = static_cast<double>(s);
    ASSERT_EQ(all.error[s], step);
    ASSERT_EQ(all.norm[s], 2.0 * step);
    if (s % 3 == 0)
      ASSERT_EQ(all.validation[s], 0.5 * step);
    else
      ASSERT_TRUE(std::isnan(all.validation[s]));
  }
}

}  // namespace
}  // namespace cairn::landmark_learning
