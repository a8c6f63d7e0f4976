#include "worker/worker.h"

#include <gtest/gtest.h>

#include <new>
#include <stdexcept>

#include "pipelines/testing/in_process.h"
#include "schema/blob_part.h"
#include "worker/testing/rig.h"
#include "worker/testing/toy_pipeline.h"

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace cairn::worker {
namespace {

TEST(Worker, ComputesATaskAndSaysWhatCameOfIt) {
  Rig rig(AddIndex);
  rig.Begin();
  rig.Assign(RunTask(3, {{"a", rig.Keep(Number(0.5))}}));
  const wire::Message done = rig.Serve();
  ASSERT_TRUE(done.envelope.has_done());
  EXPECT_EQ(done.envelope.done().key().task(), 3u);
  EXPECT_EQ(done.envelope.done().key().attempt(), 1u);
  ASSERT_EQ(done.blobs.size(), 1u);
  EXPECT_EQ(done.blobs[0].blob->Scalar<double>("v"), 3.5);
  EXPECT_EQ(done.envelope.done().partial(), Number(3.5).ContentHash().Binary());
  EXPECT_EQ(rig.fetches, 1);
}

TEST(Worker, AWholeStageEqualsTheInProcessRunner) {
  proto::Stage stage;
  stage.set_name("s");
  stage.set_pipeline("toy");
  stage.mutable_options()->operator[]("slices").set_i(40);  // more partials than are fetched ahead
  const auto log = std::make_shared<const Blob>(testing::ToyLog(100));
  const BlobPtr expected = RunInProcess(*testing::MakeToy(stage, 5), {{"log", log}});

  Rig rig(testing::MakeToy);
  rig.Begin();
  wire::Assign assign;
  *assign.mutable_stage() = stage;
  assign.set_seed(5);
  (*assign.mutable_inputs())["log"] = rig.Keep(*log).Binary();
  assign.mutable_key()->set_kind(wire::TaskKey::START);
  rig.Assign(assign);
  while (true) {
    const wire::Message planned = rig.Serve();
    ASSERT_TRUE(planned.envelope.has_done()) << planned.envelope.DebugString();
    for (const wire::NamedBlob& named : planned.blobs) rig.store[named.hash] = named.blob;
    const proto::Step& step = planned.envelope.done().step();
    if (!step.result().empty()) {
      EXPECT_EQ(rig.store.at(Hash::FromBinary(step.result()).value())->fields(), expected->fields());
      return;
    }
    assign.mutable_key()->set_kind(wire::TaskKey::ADVANCE);
    *assign.mutable_state() = step.state();
    assign.clear_partials();
    for (const proto::Task& task : step.tasks()) {
      wire::Assign run;
      *run.mutable_stage() = stage;
      run.set_seed(5);
      *run.mutable_task() = task;
      for (proto::InputRef& ref : *run.mutable_task()->mutable_inputs()) {
        if (ref.has_task()) ref.set_blob(assign.partials(static_cast<int>(ref.task())));
      }
      rig.Assign(run);
      const wire::Message done = rig.Serve();
      ASSERT_TRUE(done.envelope.has_done()) << done.envelope.DebugString();
      assign.add_partials(done.envelope.done().partial());
    }
    rig.Assign(assign);
  }
}

// A stage that reads its log, or its head alone, and then its map.
class Reader : public LambdaPipeline {
 public:
  explicit Reader(bool head) : LambdaPipeline(nullptr), head_(head) {}
  Step Start(const Inputs& inputs) const override {
    const BlobPtr log = head_ ? inputs.GetHead("log", "turn_rad") : inputs.Get("log");
    Step step;
    step.plan.set_note(std::to_string(log->ByteCount()));
    if (inputs.Has("map")) inputs.Get("map");
    return step;
  }

 private:
  const bool head_;
};

// By the name that the pipeline gives it, or else by the kind that it is of (schema/kinds/kind.h).
TEST(Worker, ChecksTheFormOfWhatAStageReads) {
  bool head = false;
  Rig rig([&head](const proto::Stage&, std::uint64_t) { return std::make_unique<Reader>(head); });
  rig.Begin();
  wire::Assign assign;
  assign.mutable_key()->set_kind(wire::TaskKey::START);
  Blob bad = testing::ToyLog(3), map;
  bad.Put("robots", Array::Texts({"anna"}));
  bad.PutVector<double>("robot/0/odometry/time_s", {0, 1, 2});
  bad.PutVector<double>("robot/0/odometry/turn_rad", {0, 1});
  map.PutVector<double>("map/landmark_x_m", {0, 2e9});
  const Hash good = rig.Keep(testing::ToyLog(3)), bad_log = rig.Keep(bad), far = rig.Keep(map);
  const auto failure = [&](const Hash& log, const Hash& of_map) {
    (*assign.mutable_inputs())["log"] = log.Binary();
    (*assign.mutable_inputs())["map"] = of_map.Binary();
    rig.Assign(assign);
    const wire::Message answer = rig.Serve();
    EXPECT_EQ(answer.envelope.has_done(), !answer.envelope.has_failed());
    EXPECT_EQ(answer.envelope.failed().input_error(), answer.envelope.has_failed());
    return answer.envelope.failed().message();
  };
  for (const bool of_head : {false, true}) {
    head = of_head;
    assign.set_seed(head ? 1 : 0);  // another pipeline
    EXPECT_EQ(failure(good, good), "");
    EXPECT_EQ(failure(bad_log, good),
              "input 'log': 'robot/0/odometry/turn_rad' has the shape [2], where [C] is needed: C is 3 by "
              "'robot/0/odometry/time_s'");
  }
  EXPECT_EQ(failure(good, far),
            "input 'map': 'map/landmark_x_m', entry 1: 2000000000, where -1e+09 to 1e+09 is needed");
}

TEST(Worker, KeepsInputsAndItsOwnPartials) {
  Rig rig(AddIndex);
  rig.Begin();
  const Hash a = rig.Keep(Number(1));
  Hash last = a;
  for (const std::uint32_t i : {1u, 2u, 3u}) {
    rig.Assign(RunTask(i, {{"a", last}, {"b", a}}));
    const wire::Message done = rig.Serve();
    ASSERT_TRUE(done.envelope.has_done());
    last = Hash::FromBinary(done.envelope.done().partial()).value();
  }
  EXPECT_EQ(last, Number(7).ContentHash());
  EXPECT_EQ(rig.fetches, 1);
}

TEST(Worker, SaysWhichTaskFailedAndWhy) {
  Rig rig([](const Task& task, const Inputs&, Progress&) -> Blob {
    switch (task.index()) {
      case 0:
        throw InputError("robot 2, step 17: no mass is left");
      case 1:
        throw std::bad_alloc();
      case 2:
        throw std::runtime_error("odd");
      case 3:
        throw 3;  // NOLINT
      case 4:
        throw Cancelled{};
      case 5:
        Array::Vector<double>({1, 2}).Rows(1, 2);  // which demands that there are such rows
        return Number(1);
      default:
        return Number(1);
    }
  });
  rig.Begin();
  const std::vector<std::pair<bool, std::string>> expected = {
      {true, "robot 2, step 17: no mass is left"},
      {false, "out of memory"},
      {false, "odd"},
      {false, "an exception of an unknown type"},
      {false, "it gave up though nobody had cancelled it"}};
  for (std::uint32_t i = 0; i < expected.size(); ++i) {
    rig.Assign(RunTask(i));
    const wire::Message answer = rig.Serve();
    ASSERT_TRUE(answer.envelope.has_failed());
    EXPECT_EQ(answer.envelope.failed().key().task(), i);
    EXPECT_EQ(answer.envelope.failed().input_error(), expected[i].first);
    EXPECT_EQ(answer.envelope.failed().message(), expected[i].second);
  }
  rig.Assign(RunTask(5));
  const wire::Message bug = rig.Serve();
  EXPECT_FALSE(bug.envelope.failed().input_error());
  EXPECT_NE(bug.envelope.failed().message().find("a bug"), std::string::npos);
  rig.Assign(RunTask(9));
  EXPECT_TRUE(rig.Serve().envelope.has_done()) << "a failure ends the task, not the worker";
}

TEST(Worker, ABlobThatNobodyHasIsNotTheInputsFault) {
  Rig rig(AddIndex);
  rig.Begin();
  rig.Assign(RunTask(0, {{"a", Number(1).ContentHash()}}));
  const wire::Message answer = rig.Serve();
  ASSERT_TRUE(answer.envelope.has_failed());
  EXPECT_FALSE(answer.envelope.failed().input_error());
  EXPECT_NE(answer.envelope.failed().message().find(Number(1).ContentHash().Hex()), std::string::npos);
}

TEST(Worker, GivesATaskTheRowsThatItAsksForAndNoOthers) {
  Rig rig([](const Task&, const Inputs& inputs, Progress&) {
    return Number(inputs.Get("a")->Get<double>("v")[0] +
                  10 * static_cast<double>(inputs.Get("a")->at("v").size()));
  });
  rig.Begin();
  Blob rows;
  rows.PutVector<double>("v", {1, 2, 3, 4});
  wire::Assign assign = RunTask(0, {{"a", rig.Keep(std::move(rows))}});
  proto::InputRef& ref = *assign.mutable_task()->mutable_inputs(0);
  ref.set_first_row(1);
  ref.set_row_count(3);
  rig.Assign(assign);
  EXPECT_EQ(rig.Serve().blobs.at(0).blob->Scalar<double>("v"), 32);
  ref.set_row_count(4);
  rig.Assign(assign);
  const wire::Message beyond = rig.Serve();
  ASSERT_TRUE(beyond.envelope.has_failed());
  EXPECT_FALSE(beyond.envelope.failed().input_error()) << "the plan's fault, not the user's";
}

wire::Assign ReadsRows(std::uint32_t index, const Hash& blob, std::int64_t first, std::int64_t count) {
  wire::Assign assign = RunTask(index, {{"a", blob}});
  *assign.mutable_task()->mutable_inputs(0)->mutable_part() = RowsPart("v", first, count);
  return assign;
}

Blob SumOfRows(const Task&, const Inputs& inputs, Progress&) {
  double sum = 0;
  for (const double v : inputs.Get("a")->Get<double>("v")) sum += v;
  return Number(sum);
}

TEST(Worker, FetchesNoMoreThanThePartThatATaskNamesAndKeepsIt) {
  Rig rig(SumOfRows);
  rig.Begin();
  Blob all;
  all.PutVector<double>("v", {1, 2, 4, 8});
  const Hash blob = rig.Keep(std::move(all));
  rig.Assign(ReadsRows(0, blob, 1, 2));
  const wire::Message fetch = rig.transport.Take();
  ASSERT_TRUE(fetch.envelope.has_fetch());
  EXPECT_EQ(fetch.envelope.fetch().part().row_count(), 2);
  rig.Answer(fetch.envelope.fetch());
  EXPECT_EQ(rig.Serve().blobs.at(0).blob->Scalar<double>("v"), 6);
  for (const auto& [first, sum] : {std::pair{1, 6.0}, {2, 12.0}}) {
    rig.Assign(ReadsRows(1, blob, first, 2));
    EXPECT_EQ(rig.Serve().blobs.at(0).blob->Scalar<double>("v"), sum);
  }
  EXPECT_EQ(rig.fetches, 1) << "of the part that it did not have";
}

TEST(Worker, CutsPartsOfABlobThatItHas) {
  Blob all;
  all.PutVector<double>("v", {1, 2, 4, 8});
  const wire::NamedBlob given = wire::NameBlob(std::make_shared<const Blob>(std::move(all)));
  Rig rig(SumOfRows, [&given](WorkerOptions& options) { options.session.given = {given}; });
  rig.Begin();
  rig.Assign(ReadsRows(0, given.hash, 2, 2));
  EXPECT_EQ(rig.Serve().blobs.at(0).blob->Scalar<double>("v"), 12);
  rig.Assign(ReadsRows(1, given.hash, 2, 3));
  EXPECT_NE(rig.Serve().envelope.failed().message().find("3 rows from row 2 on of 'v', which has 4"),
            std::string::npos);
  EXPECT_EQ(rig.fetches, 0);
}

TEST(Worker, APartThatIsNotThereOrIsAnotherIsAFailureThatSaysSo) {
  Rig rig(SumOfRows);
  rig.Begin();
  Blob all;
  all.PutVector<double>("v", {1, 2, 4, 8});
  const Hash blob = rig.Keep(std::move(all));
  rig.Assign(ReadsRows(0, blob, 3, 2));
  const wire::Message missing = rig.Serve();
  ASSERT_TRUE(missing.envelope.has_failed());
  EXPECT_FALSE(missing.envelope.failed().input_error()) << "the plan's fault, not the user's";
  EXPECT_NE(missing.envelope.failed().message().find("2 rows from row 3 on of 'v', which has 4"),
            std::string::npos);
  rig.Assign(ReadsRows(1, blob, 0, 2));
  ASSERT_TRUE(rig.transport.Take().envelope.has_fetch());
  wire::Message other;  // says that it is what was asked for
  wire::BlobData& data = *other.envelope.mutable_blob();
  data.set_of(blob.Binary());
  *data.mutable_part() = RowsPart("v", 0, 2);
  other.blobs = {wire::NameBlob(rig.store.at(blob))};
  rig.Give(other);
  EXPECT_NE(rig.Serve().envelope.failed().message().find("another part"), std::string::npos);
}

TEST(Worker, AStageFetchesWhatItReadsOfItsInputs) {
  Rig rig([](const proto::Stage&, std::uint64_t) { return std::make_unique<Reader>(true); });
  rig.Begin();
  wire::Assign assign;
  assign.mutable_key()->set_kind(wire::TaskKey::START);
  const Blob log = testing::ToyLog(1000);
  (*assign.mutable_inputs())["log"] = rig.Keep(log).Binary();
  (*assign.mutable_inputs())["other"] = Number(3).ContentHash().Binary();  // nobody has it, nobody reads it
  rig.Assign(assign);
  const wire::Message planned = rig.Serve();
  ASSERT_TRUE(planned.envelope.has_done()) << planned.envelope.DebugString();
  EXPECT_EQ(planned.envelope.done().step().note(), std::to_string(log.ByteCount() - 8000));
  EXPECT_EQ(rig.fetches, 1);
}

TEST(Worker, AnAnswerWithoutItsElementsIsABugOfThePipeline) {
  Rig rig([](const Task&, const Inputs& inputs, Progress&) { return *inputs.GetHead("a", "v"); });
  rig.Begin();
  rig.Assign(RunTask(0, {{"a", rig.Keep(Number(1))}}));
  EXPECT_NE(rig.Serve().envelope.failed().message().find("without its elements"), std::string::npos);
}

TEST(Worker, ACancelledTaskMakesRoomForTheNext) {
  Rig rig(SpinUntilCancelled);
  rig.Begin();
  rig.Assign(RunTask(0));
  rig.Assign(RunTask(1));
  rig.Assign(RunTask(2));
  rig.Cancel(RunTask(1).key());
  rig.Cancel(RunTask(0).key());
  EXPECT_EQ(rig.Serve().envelope.done().key().task(), 2u);
}

TEST(Worker, HeartbeatsCarryTheTicksOfAssignedTasks) {
  Rig rig(SpinUntilCancelled);
  rig.Begin(10);
  rig.Assign(RunTask(0));
  rig.Assign(RunTask(1));
  std::uint64_t ticks = 0;
  while (ticks == 0) {
    const wire::Message heartbeat = rig.transport.Take(true);
    ASSERT_TRUE(heartbeat.envelope.has_heartbeat());
    rig.Pass(6);
    if (heartbeat.envelope.heartbeat().tasks_size() == 0) continue;  // before the tasks were read
    ASSERT_EQ(heartbeat.envelope.heartbeat().ticks_size(), heartbeat.envelope.heartbeat().tasks_size());
    EXPECT_EQ(heartbeat.envelope.heartbeat().tasks(0).task(), 0u);
    ticks = heartbeat.envelope.heartbeat().ticks(0);
  }
  rig.Cancel(RunTask(0).key());
  EXPECT_EQ(rig.Serve().envelope.done().key().task(), 1u);
}

#if defined(__x86_64__)
TEST(Worker, ComputesWithSubnormalNumbersWhateverItsParentThreadDoes) {
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040);  // inherited by threads that are made now
  Rig rig([](const Task&, const Inputs& inputs, Progress&) {
    return Number(inputs.Get("a")->Scalar<double>("v") * 0.5);
  });
  _mm_setcsr(before);
  rig.Begin();
  rig.Assign(RunTask(1, {{"a", rig.Keep(Number(1e-310))}}));
  EXPECT_EQ(rig.Serve().blobs.at(0).blob->Scalar<double>("v"), 0.5e-310);
}
#endif

}  // namespace
}  // namespace cairn::worker
