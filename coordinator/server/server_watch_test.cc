// What a server says of itself.
#include <filesystem>

#include "coordinator/server/testing/hub_fixture.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

TEST(ServerWatch, MetricsCountWhatAJobDid) {
  ServerFixture fixture;
  EXPECT_EQ(fixture.server->TakeMetrics().last_checkpoint_utc_s, 0);
  fixture.transport.ComeWorker("w");
  fixture.Submit();
  fixture.Until([&] { return fixture.State() == "done"; });
  Metrics metrics = fixture.server->TakeMetrics();
  EXPECT_EQ(metrics.census.jobs["done"], 1u);
  EXPECT_EQ(metrics.census.workers["idle"], 1u);
  EXPECT_EQ(metrics.tally.tasks_done, 3u * 2 + 1 + 3) << "of three rounds, their START, their ADVANCEs";
  EXPECT_GT(metrics.tally.checkpoints, 0u);
  EXPECT_GT(metrics.last_checkpoint_utc_s, 1.7e9);
  EXPECT_GT(metrics.turns.sum_s, 0);
  EXPECT_TRUE(metrics.store_writable);
  fixture.transport.door = {{wire::RefusalKind::kKey, "a stranger", 3}};
  fixture.server->Step(0);
  EXPECT_EQ(fixture.server->TakeMetrics().refused["key"], 3u);
}

TEST(ServerWatch, WhereASaveFailsTheStoreIsProbedAndUsersAreToldUntilItCanBeWrittenAgain) {
  ServerFixture fixture;
  const fs::path store = fixture.temp.path() / "store", aside = fixture.temp.path() / "aside";
  fs::rename(store, aside);
  fixture.Submit();
  fixture.Until([&] { return !fixture.server->store_trouble().empty(); });
  EXPECT_FALSE(fixture.server->TakeMetrics().store_writable);
  EXPECT_LT(fixture.server->core().served_s(), 60) << "sooner than it is probed anyway";
  wire::Message query;
  query.envelope.mutable_query();
  const wire::Reply reply = fixture.Ask(query);
  EXPECT_TRUE(reply.warning().starts_with("the store cannot be written: ")) << reply.warning();
  EXPECT_TRUE(reply.store_fails());
  fs::rename(aside, store);
  fixture.Until([&] { return fixture.server->store_trouble().empty(); });
  EXPECT_TRUE(fixture.server->TakeMetrics().store_writable);
  EXPECT_FALSE(fixture.Ask(query).store_fails());
}

// Lists, which are long enough, have none.
TEST(ServerWatch, WithTheLogOfAJobComeItsStagesAndWhatEachTakes) {
  ServerFixture fixture;
  proto::Job job = fixture.MakeJob(3);
  (*job.mutable_stages(2)->mutable_inputs())["map"] = "stage0";
  (*job.mutable_stages(2)->mutable_inputs())["poses"] = "stage1";
  EXPECT_EQ(fixture.Ask(fixture.Submission(job, true)).jobs(0).id(), "1-toy");
  wire::Message query;
  query.envelope.mutable_query()->set_job("1-toy");
  query.envelope.mutable_query()->set_action("logs");
  const wire::Reply reply = fixture.Ask(query);
  ASSERT_EQ(reply.jobs(0).plan_size(), 3);
  EXPECT_EQ(reply.jobs(0).plan(1).name(), "stage1");
  EXPECT_EQ(reply.jobs(0).plan(1).pipeline(), "toy");
  EXPECT_EQ(reply.jobs(0).plan(1).after_size(), 0) << "the log is no stage";
  ASSERT_EQ(reply.jobs(0).plan(2).after_size(), 2);
  EXPECT_EQ(reply.jobs(0).plan(2).after(1), 1u);
  wire::Message list;
  list.envelope.mutable_query();
  EXPECT_EQ(fixture.Ask(list).jobs(0).plan_size(), 0);
}

}  // namespace
}  // namespace cairn::coordinator
