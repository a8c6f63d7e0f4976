// The worker's side of the conversation: what it says when, and what it makes of what it is told.
#include "worker/session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "worker/testing/rig.h"

namespace cairn::worker {
namespace {

wire::Message Plain(void (*set)(wire::Envelope&)) {
  wire::Message message;
  set(message.envelope);
  return message;
}
const auto kLeave = [](wire::Envelope& e) { e.mutable_leave(); };
const auto kUnknownWorker = [](wire::Envelope& e) { e.mutable_unknown_worker(); };

TEST(Conversation, ALostConnectionDropsTheTasksAndKeepsTheCache) {
  Rig rig([](const Task& task, const Inputs& inputs, Progress& progress) {
    while (task.index() == 0) progress.Tick();
    return AddIndex(task, inputs, progress);
  });
  rig.Begin();
  const Hash a = rig.Keep(Number(1));
  rig.Assign(RunTask(5, {{"a", a}}));
  EXPECT_TRUE(rig.Serve().envelope.has_done());
  rig.Assign(RunTask(0, {{"a", a}}));
  rig.Assign(RunTask(1, {{"a", a}}));
  rig.Give(Event::kDisconnected);
  rig.Begin();
  rig.Assign(RunTask(2, {{"a", a}}));
  EXPECT_EQ(rig.Serve().envelope.done().key().task(), 2u);
  EXPECT_EQ(rig.fetches, 1);
}

TEST(Conversation, WhatItWasGivenItNeverFetchesWhateverTheCacheHolds) {
  const wire::NamedBlob given = wire::NameBlob(std::make_shared<const Blob>(Number(1)));
  Rig rig(LambdaPipeline::RunFunction(AddIndex), [&](WorkerOptions& options) {
    options.session.given = {given};
    options.session.cache_bytes = 0;
  });
  rig.Begin();
  const Hash other = rig.Keep(Number(2));
  rig.Assign(RunTask(5, {{"a", given.hash}}));
  EXPECT_TRUE(rig.Serve().envelope.has_done());
  EXPECT_EQ(rig.fetches, 0);
  rig.Assign(RunTask(6, {{"a", other}}));
  EXPECT_TRUE(rig.Serve().envelope.has_done());
  EXPECT_EQ(rig.fetches, 1);
  rig.Give(Event::kDisconnected);
  rig.Begin();
  rig.Assign(RunTask(7, {{"a", given.hash}}));
  EXPECT_TRUE(rig.Serve().envelope.has_done());
  EXPECT_EQ(rig.fetches, 1);
}

TEST(Conversation, SaysHelloAgainToACoordinatorThatDoesNotKnowIt) {
  Rig rig(AddIndex);
  rig.Begin();
  rig.Give(Plain(kUnknownWorker));
  EXPECT_TRUE(rig.Serve().envelope.has_hello());
  // A second one that was on its way before that Hello; and a task of the time before.
  rig.Give(Plain(kUnknownWorker));
  rig.Assign(RunTask(1, {{"a", rig.Keep(Number(1))}}));
  wire::Message welcome;
  welcome.envelope.mutable_welcome()->set_heartbeat_s(1);
  rig.Give(welcome);
  rig.Assign(RunTask(2, {{"a", rig.Keep(Number(1))}}));
  const wire::Message next = rig.Serve();
  ASSERT_TRUE(next.envelope.has_done());
  EXPECT_EQ(next.envelope.done().key().task(), 2u);
}

TEST(Conversation, RepeatsAHelloThatNobodyAnswers) {
  Rig rig(AddIndex);
  rig.Give(Event::kConnected);
  EXPECT_TRUE(rig.Serve().envelope.has_hello());
  rig.Pass(6);
  EXPECT_TRUE(rig.Serve().envelope.has_hello());
}

TEST(Conversation, AsksAgainForABlobThatDoesNotCome) {
  Rig rig(AddIndex);
  rig.Begin(1000);
  const Hash a = rig.Keep(Number(1));
  rig.Assign(RunTask(1, {{"a", a}}));
  EXPECT_TRUE(rig.transport.Take().envelope.has_fetch());
  rig.Pass(21);
  EXPECT_TRUE(rig.transport.Take().envelope.has_fetch());
  rig.Answer(a);
  EXPECT_TRUE(rig.Serve().envelope.has_done());
}

TEST(Conversation, AnAnswerWaitsWhileTheQueueIsFull) {
  Rig rig(AddIndex);
  rig.Begin(1000);
  const Hash a = rig.Keep(Number(1));
  rig.Assign(RunTask(1, {{"a", a}}));
  EXPECT_TRUE(rig.transport.Take().envelope.has_fetch());
  rig.transport.SetFull(true);
  rig.Answer(a);
  rig.Pass(1);
  rig.transport.SetFull(false);
  EXPECT_TRUE(rig.Serve().envelope.has_done());
}

wire::Message WelcomeOf(double heartbeat_s) {
  wire::Message welcome;
  welcome.envelope.mutable_welcome()->set_heartbeat_s(heartbeat_s);
  return welcome;
}

// ---- a coordinator that means ill ----
TEST(Conversation, WhatGoesBeyondItsSlotsIsNotKept) {
  Rig rig(SpinUntilCancelled, [](WorkerOptions& o) { o.session.hello.set_slots(2); });
  rig.Begin(1000);
  for (std::uint32_t i = 0; i < 50; ++i) {
    wire::Assign assign = RunTask(0);
    assign.mutable_key()->set_attempt(i);
    rig.Assign(assign);
  }
  rig.Give(WelcomeOf(1000));  // answered by a heartbeat
  while (rig.transport.Take(true).envelope.heartbeat().tasks_size() != 4) {
  }
  const std::string log = rig.log();
  EXPECT_NE(log.find("more tasks than this worker has slots (2)"), std::string::npos) << log;
  EXPECT_EQ(log.find("more tasks"), log.rfind("more tasks")) << "it is told once: " << log;
}

TEST(Conversation, ATaskWithANameOfMegabytesIsNotTaken) {
  Rig rig(AddIndex);
  rig.Begin(1000);
  const Hash a = rig.Keep(Number(1));
  wire::Assign large = RunTask(1, {{"a", a}});
  large.mutable_key()->set_job(std::string(1 << 20, 'j'));
  rig.Assign(large);
  rig.Assign(RunTask(2, {{"a", a}}));
  EXPECT_EQ(rig.Serve().envelope.done().key().task(), 2u);
  EXPECT_NE(rig.log().find("too long"), std::string::npos) << rig.log();
}

TEST(Conversation, AHeartbeatThatCannotBeIsRefusedAndALongOneShortened) {
  Rig rig(AddIndex);
  rig.Give(Event::kConnected);
  EXPECT_TRUE(rig.Serve().envelope.has_hello());
  for (const double never : {std::nan(""), -1.0, -HUGE_VAL, HUGE_VAL}) {
    rig.Give(WelcomeOf(never));
    rig.Pass(6);
    EXPECT_TRUE(rig.transport.Take(true).envelope.has_hello()) << "nobody has welcomed it: " << never;
  }
  EXPECT_NE(rig.log().find("a heartbeat every nan s"), std::string::npos) << rig.log();
  rig.Give(WelcomeOf(1e300));
  EXPECT_TRUE(rig.transport.Take(true).envelope.has_heartbeat());
  rig.Pass(1801);
  EXPECT_TRUE(rig.transport.Take(true).envelope.has_heartbeat());
}

TEST(Conversation, HeartbeatsSayHowItsMachineIs) {
  Rig rig(AddIndex, [](WorkerOptions& options) {
    options.session.add_vitals = [](wire::Heartbeat* heartbeat) { heartbeat->set_load(2.5); };
  });
  rig.Begin(1);
  EXPECT_EQ(rig.transport.Take(true).envelope.heartbeat().load(), 2.5);
}

// Over a slow link an input may come for minutes: its task moves as long as bytes of it do, and no longer.
TEST(Conversation, ATaskWhoseInputComesSlowlyMovesAndIsNotAskedForAgain) {
  Rig rig(AddIndex);
  rig.Begin(1);
  EXPECT_TRUE(rig.transport.Take(true).envelope.has_heartbeat());
  const Hash a = rig.Keep(Number(1));
  rig.Assign(RunTask(1, {{"a", a}}));
  EXPECT_TRUE(rig.transport.Take().envelope.has_fetch());
  const auto ticks = [&] {
    rig.Pass(15);
    wire::Message message;
    while (!message.envelope.has_heartbeat() || message.envelope.heartbeat().ticks_size() == 0) {
      message = rig.transport.Take(true);
      EXPECT_FALSE(message.envelope.has_fetch());
    }
    return message.envelope.heartbeat().ticks(0);
  };
  std::uint64_t before = ticks();
  for (int i = 0; i < 10; ++i) {
    rig.transport.bytes_came += 5000;
    const std::uint64_t after = ticks();
    EXPECT_GT(after, before) << i;
    before = after;
  }
  rig.transport.bytes_came += 100;  // a sign of life
  EXPECT_EQ(ticks(), before);
}

TEST(Conversation, NothingPilesUpForAPeerThatTakesNothing) {
  Rig rig(AddIndex);
  rig.Begin(1);
  EXPECT_TRUE(rig.transport.Take(true).envelope.has_heartbeat());
  rig.Assign(RunTask(1, {{"a", rig.Keep(Number(1))}}));
  EXPECT_TRUE(rig.transport.Take(true).envelope.has_fetch());
  rig.transport.SetFull(true);
  for (int i = 0; i < 100; ++i) {
    rig.Pass(30);
    rig.transport.AwaitPoll();
  }
  rig.transport.SetFull(false);
  for (int i = 0; i < 3; ++i) rig.transport.AwaitPoll();
  // Those that waited, and a new one of each, as they were old.
  EXPECT_GE(rig.transport.Waiting(), 2u);
  EXPECT_LE(rig.transport.Waiting(), 4u);
}

TEST(Conversation, NoCoordinatorFillsTheLog) {
  Rig rig(AddIndex);
  rig.Begin(1000);
  EXPECT_TRUE(rig.transport.Take(true).envelope.has_heartbeat());
  wire::Message stray;
  stray.envelope.mutable_hello();
  for (int i = 0; i < 1000; ++i) {
    rig.Give(stray);
    rig.Give(WelcomeOf(1000));
    rig.transport.Give({.kind = Event::kMalformed, .message = {}, .text = std::string(1 << 16, 'x')});
    rig.Give(Event::kDisconnected);
  }
  rig.transport.AwaitPoll();
  rig.Pass(6);
  rig.Give(stray);
  wire::Message refuse;
  refuse.envelope.mutable_refuse()->set_reason(std::string(1 << 20, 'r'));
  rig.Give(refuse);
  EXPECT_EQ(rig.Join(), kExitRefused);
  const std::string log = rig.log();
  EXPECT_LT(log.size(), 10'000u) << "two long texts, cut";
  EXPECT_LT(std::ranges::count(log, '\n'), 10);
  EXPECT_NE(log.find("(and 999 more of this kind)"), std::string::npos) << log;
}

TEST(Conversation, ARefusalEndsItWithTheReason) {
  Rig rig(AddIndex);
  rig.Give(Event::kConnected);
  wire::Message refuse;
  refuse.envelope.mutable_refuse()->set_reason("its numeric self-test gives other bits");
  rig.Give(refuse);
  EXPECT_EQ(rig.Join(), kExitRefused);
  EXPECT_NE(rig.log().find("other bits"), std::string::npos);
}

TEST(Conversation, AnUnknownKeyEndsIt) {
  Rig rig(AddIndex);
  rig.Give(Event::kKeyRefused);
  EXPECT_EQ(rig.Join(), kExitRefused);
}

TEST(Conversation, AHandshakeThatFailsIsToldAndTheNextConnectionGoesOn) {
  Rig rig(AddIndex);
  for (int i = 0; i < 7; ++i) rig.Give(Event::kHandshakeFailed);
  rig.Begin();
  rig.Assign(RunTask(1, {{"a", rig.Keep(Number(1))}}));
  EXPECT_TRUE(rig.Serve().envelope.has_done());
  const std::string log = rig.log();
  EXPECT_NE(log.find("(1 time)"), std::string::npos) << log;
  EXPECT_NE(log.find("(4 times)"), std::string::npos);
  EXPECT_EQ(log.find("(3 times)"), std::string::npos) << "it may go on for hours";
}

TEST(Conversation, LeaveEndsAPrivateWorkerOnly) {
  Rig own(AddIndex, [](WorkerOptions& o) { o.session.exit_on_leave = true; });
  own.Begin();
  own.Give(Plain(kLeave));
  EXPECT_EQ(own.Join(), kExitDone);

  Rig fleet(AddIndex);
  fleet.Begin();
  fleet.Give(Plain(kLeave));
  fleet.Begin();
  fleet.Assign(RunTask(1, {{"a", fleet.Keep(Number(1))}}));
  EXPECT_TRUE(fleet.Serve().envelope.has_done());
}

TEST(Conversation, APrivateWorkerThatFindsNobodyGivesUp) {
  Rig rig(AddIndex, [](WorkerOptions& o) { o.session.first_contact_s = 30; });
  rig.Give(Event::kConnected);
  EXPECT_TRUE(rig.Serve().envelope.has_hello());
  rig.Pass(31);
  EXPECT_EQ(rig.Join(), kExitLost);
}

const auto kDrain = [](wire::Envelope& e) { e.mutable_drain(); };

TEST(Conversation, AWorkerThatIsToldToLeaveFinishesWhatItRunsSendsLeaveAndEnds) {
  Rig rig(AddIndex);
  rig.Begin(1000);
  const Hash a = rig.Keep(Number(1));
  rig.Assign(RunTask(3, {{"a", a}}));
  EXPECT_TRUE(rig.transport.Take().envelope.has_fetch());
  rig.Give(Plain(kDrain));
  rig.Answer(a);
  EXPECT_TRUE(rig.Serve().envelope.has_done());
  EXPECT_TRUE(rig.Serve().envelope.has_leave());
  EXPECT_EQ(rig.Join(), kExitDone);
}

TEST(Conversation, AWorkerThatIsToldToLeaveAndIsCutOffEnds) {
  Rig rig(SpinUntilCancelled);
  rig.Begin(1000);
  rig.Assign(RunTask(0));
  rig.Give(Plain(kDrain));
  rig.Give(Event::kDisconnected);
  EXPECT_EQ(rig.Join(), kExitDone);
}

TEST(Conversation, OfItsOwnAccordItSaysSoFirstAndFinishesWhatItRuns) {
  std::atomic<bool> drain{false};
  Rig rig(AddIndex, [&drain](WorkerOptions& o) {
    o.drain = &drain;
    o.drain_s = 60;
  });
  rig.Begin(1000);
  const Hash a = rig.Keep(Number(1));
  rig.Assign(RunTask(3, {{"a", a}}));
  EXPECT_TRUE(rig.transport.Take().envelope.has_fetch());
  drain = true;
  rig.transport.Wake();
  EXPECT_TRUE(rig.transport.Take().envelope.has_drain());
  rig.Answer(a);
  EXPECT_TRUE(rig.Serve().envelope.has_done());
  EXPECT_TRUE(rig.Serve().envelope.has_leave());
  EXPECT_EQ(rig.Join(), kExitDone);
}

TEST(Conversation, OfItsOwnAccordItDoesNotWaitForLongerThanItWasGiven) {
  std::atomic<bool> drain{false};
  Rig rig(SpinUntilCancelled, [&drain](WorkerOptions& o) {
    o.drain = &drain;
    o.drain_s = 60;
  });
  rig.Begin(1000);
  rig.Assign(RunTask(0));
  drain = true;
  rig.transport.Wake();
  EXPECT_TRUE(rig.Serve().envelope.has_drain());
  rig.Pass(61);
  EXPECT_TRUE(rig.Serve().envelope.has_leave());
  EXPECT_EQ(rig.Join(), kExitDone);
}

TEST(Conversation, StoppingSendsLeave) {
  Rig rig(SpinUntilCancelled);
  rig.Begin();
  rig.Assign(RunTask(0));
  EXPECT_EQ(rig.Stop(), kExitDone);
  EXPECT_TRUE(rig.Serve().envelope.has_leave());
}

}  // namespace
}  // namespace cairn::worker
