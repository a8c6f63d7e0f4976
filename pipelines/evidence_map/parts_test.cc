#include "pipelines/evidence_map/parts.h"

#include <gtest/gtest.h>

#include <limits>

#include "pipelines/common/testing_room.h"
#include "schema/blob_part.h"

namespace cairn::evidence_map {
namespace {

PosedScans ScansOfA(const Room& room) { return ReadRangeScans(room.Log(), nullptr, {}); }

const Room kLarge{.scans = 3000, .beams = 180};

// What a task reads of `group`, of a log that is at hand.
std::vector<RangeScans> Handed(const Room& room, const std::vector<Part>& parts, const Group& group,
                               const Step& step) {
  const Blob log = room.Log();
  const std::string name = ScansOfA(room).sensors[0].name;
  proto::Step plan = step.plan;
  AddTask("look", 1, group, parts, log.ContentHash().Binary(), name + kRanges, &plan);
  const Task& task = plan.tasks(plan.tasks_size() - 1);

  class OfTask : public Inputs {
   public:
    bool Has(const std::string& input) const override { return blobs.contains(input); }
    BlobPtr Get(const std::string& input) const override { return blobs.at(input); }
    std::map<std::string, BlobPtr> blobs;
  } inputs;
  std::map<std::string, BlobPtr> shared;
  for (const BlobPtr& blob : step.blobs) shared[blob->ContentHash().Binary()] = blob;
  for (const proto::InputRef& input : task.inputs())
    inputs.blobs[input.name()] =
        input.has_part() ? CutPart(log, input.part()).value() : shared.at(input.blob());
  return ScansOfTask(task, inputs);
}

TEST(Parts, TogetherAreAllScansInTheirOrderAndBeginWhereArraysDo) {
  const PosedScans scans = ScansOfA(kLarge);
  Step step;
  const std::vector<Part> parts = CutParts(scans.sensors, &step);
  EXPECT_GT(parts.size(), 40U);
  std::int64_t next = 0;
  for (const Part& part : parts) {
    EXPECT_EQ(part.first_row, next);
    EXPECT_EQ(part.first_row % 8, 0);
    next += part.rows;
  }
  EXPECT_EQ(next, kLarge.scans);
  const RangeScans all = Joined(Handed(kLarge, parts, {0, parts.size(), 0}, step));
  EXPECT_TRUE(all.range_m == scans.sensors[0].range_m);
  EXPECT_EQ(all.time_s, scans.sensors[0].time_s);
  EXPECT_EQ(all.row, scans.sensors[0].row);
  EXPECT_EQ(all.checked, scans.sensors[0].checked);
}

TEST(Parts, OfASmallLogThereIsOneAndOfManySensorsThereAreNotTooMany) {
  Step step;
  EXPECT_EQ(CutParts(ScansOfA({}).sensors, &step).size(), 1U);
  const std::vector<RangeScans> many(1000, ScansOfA({.scans = 300, .beams = 180}).sensors[0]);
  EXPECT_LE(CutParts(many, &step).size(), 2048U);
}

TEST(Parts, AreGroupedByWeightWithinASensor) {
  std::vector<Part> parts(7);
  for (std::size_t k = 4; k < 7; ++k) parts[k].sensor = 1;
  const std::vector<double> weights{1, 1, 3, 1, 2, 2, 2};
  const std::vector<Group> sensors = OfSensors(parts, weights);
  ASSERT_EQ(sensors.size(), 2U);
  EXPECT_EQ(sensors[0].end, 4U);
  EXPECT_EQ(sensors[1].weight, 6);
  const std::vector<Group> groups = GroupParts(weights, 2, sensors[0]);
  ASSERT_EQ(groups.size(), 3U);
  EXPECT_EQ(groups[0].end, 2U);
  EXPECT_EQ(groups[1].weight, 3);
  EXPECT_EQ(groups[2].end, 4U);
}

TEST(Parts, AreNotGroupedAcrossWhatEndsSomewhere) {
  const std::vector<double> weights{1, 1, 1, 1, 1, 6, 6, 6, 6, 1};
  const std::vector<Group> groups = GroupParts(weights, 12, {1, 10, 29}, {3, 5, 9, 20});
  std::vector<std::pair<std::size_t, std::size_t>> spans;
  for (const Group& group : groups) spans.emplace_back(group.first, group.end);
  const decltype(spans) expected{{1, 3}, {3, 5}, {5, 7}, {7, 9}, {9, 10}};
  EXPECT_EQ(spans, expected);
  EXPECT_EQ(groups[2].weight, 12);
}

TEST(Parts, ComeBackFromABlobAndWhatIsNoneIsRefused) {
  Step step;
  const std::vector<Part> parts = CutParts(ScansOfA(kLarge).sensors, &step);
  const Blob blob = BlobOfParts(parts);
  const std::vector<Part> back = PartsIn(blob, 1);
  ASSERT_EQ(back.size(), parts.size());
  for (std::size_t k = 0; k < parts.size(); ++k) {
    EXPECT_EQ(back[k].blob, parts[k].blob);
    EXPECT_EQ(back[k].first_row, parts[k].first_row);
  }
  EXPECT_THROW(PartsIn(blob, 0), InputError) << "of a sensor that there is not";
  Blob no_hash = blob, fewer = blob;
  no_hash.Put("blob", Array::Texts(std::vector<std::string>(parts.size(), "x")));
  fewer.Put("blob", Array::Texts({parts[0].blob}));
  EXPECT_THROW(PartsIn(no_hash, 1), InputError);
  EXPECT_THROW(PartsIn(fewer, 1), InputError);
}

TEST(Parts, WhatIsSaidOfThemIsHeldWithinBounds) {
  const std::vector<PartFacts> good(2);
  EXPECT_EQ(FactsIn(BlobOfFacts(good), 2).size(), 2U);
  EXPECT_THROW(FactsIn(BlobOfFacts(good), 3), InputError);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), 1e300}) {
    std::vector<PartFacts> facts = good;
    facts[1].x0_m = bad;
    EXPECT_THROW(FactsIn(BlobOfFacts(facts), 2), InputError);
    facts = good;
    facts[1].work = bad;
    EXPECT_THROW(FactsIn(BlobOfFacts(facts), 2), InputError);
  }
  std::vector<PartFacts> facts = good;
  facts[0].readings = -1;
  EXPECT_THROW(FactsIn(BlobOfFacts(facts), 2), InputError);
}

// Whoever plans may lie about where rows begin.
TEST(Parts, RowsThatAreNotThoseOfTheScansAreRefused) {
  const PosedScans scans = ScansOfA(kLarge);
  Step step;
  std::vector<Part> parts = CutParts(scans.sensors, &step);
  parts[1].rows -= 1;
  EXPECT_THROW(Handed(kLarge, parts, {1, 2, 0}, step), InputError);
}

}  // namespace
}  // namespace cairn::evidence_map
