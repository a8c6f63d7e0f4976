#include "coordinator/scale/scaler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace cairn::coordinator {
namespace {

// An engine, a service and a list of keys that do what they are told; a test makes them fail.
struct World : Engine, ScaledService, WorkerKeys {
  std::map<std::string, EngineWorker> has;
  std::vector<wire::WorkerInfo> connected;
  std::vector<wire::Demand> demand;
  std::set<std::string> keys;
  std::vector<std::string> stopped;
  Status engine_fails, service_fails, start_fails;
  std::size_t places = 100;
  std::uint64_t next = 1;

  Result<std::vector<EngineWorker>> List() override {
    if (!engine_fails.ok()) return engine_fails;
    std::vector<EngineWorker> all;
    for (const auto& [name, worker] : has) all.push_back(worker);
    return all;
  }
  Started Start(const std::vector<std::string>& names) override {
    Started started{{}, start_fails};
    for (const std::string& name : names)
      if (start_fails.ok() && has.size() < places) {
        has[name] = {.name = name};
        started.names.push_back(name);
      }
    if (start_fails.ok() && started.names.size() < names.size()) started.status = {Code::kNoSpace, "full"};
    return started;
  }
  Status Stop(const std::vector<std::string>& names) override {
    for (const std::string& name : names) {
      stopped.push_back(name);
      has.erase(name);
    }
    return Status::Ok();
  }
  void Forget(const std::vector<std::string>& names) override {
    for (const std::string& name : names) has.erase(name);
  }
  Result<ScaleFacts> Ask() override {
    if (!service_fails.ok()) return service_fails;
    return ScaleFacts{connected, demand};
  }
  Status Drain(std::uint64_t worker) override {
    for (wire::WorkerInfo& info : connected)
      if (info.number() == worker) info.set_state("draining");
    return Status::Ok();
  }
  Result<std::vector<std::string>> Names() override {
    return std::vector<std::string>(keys.begin(), keys.end());
  }
  Status Make(const std::string& name) override {
    keys.insert(name);
    return Status::Ok();
  }
  Status Revoke(const std::string& name) override {
    keys.erase(name);
    return Status::Ok();
  }

  void Want(std::uint32_t tasks) {
    demand.clear();
    if (tasks == 0) return;
    demand.emplace_back().set_tasks(tasks);
    demand[0].set_work_s(1e6);
  }
  void Connect(const std::string& name, unsigned assigned = 0) {
    wire::WorkerInfo& info = connected.emplace_back();
    info.set_name(name);
    info.set_number(next++);
    info.set_state(assigned == 0 ? "idle" : "busy");
    info.set_assigned(assigned);
  }
  void ConnectAll(unsigned assigned = 0) {
    for (const auto& [name, worker] : has)
      if (std::ranges::none_of(connected, [&](const auto& info) { return info.name() == name; }))
        Connect(name, assigned);
  }
  void Gone(const std::string& name) {
    std::erase_if(connected, [&](const auto& info) { return info.name() == name; });
  }
  void SetIdle() {
    for (wire::WorkerInfo& info : connected) {
      info.set_assigned(0);
      info.set_state("idle");
    }
  }
};

struct Scaled : World {
  explicit Scaled(ScalerOptions options = {}) {
    options.prefix = "w-";
    options.policy.most = 5;
    scaler.emplace(options, *this, *this, *this,
                   [this](Severity, const std::string& line) { said.push_back(line); });
  }
  void Turn(double seconds = 1) {
    now_s += seconds;
    scaler->Turn(now_s);
  }
  bool Said(const std::string& part) const {
    return std::ranges::any_of(said,
                               [&](const std::string& line) { return line.find(part) != std::string::npos; });
  }
  std::size_t Count(const std::string& part) const {
    return static_cast<std::size_t>(std::ranges::count_if(
        said, [&](const std::string& line) { return line.find(part) != std::string::npos; }));
  }

  std::optional<Scaler> scaler;
  std::vector<std::string> said;
  double now_s = 0;
};

TEST(Scaler, StartsAsManyAsAreWantedOnceAndLetsThemGoWhenTheyAreIdle) {
  Scaled world;
  world.Want(3);
  for (int i = 0; i < 5; ++i) world.Turn();
  EXPECT_EQ(world.has.size(), 3U) << "what starts is not started again";
  EXPECT_EQ(world.keys.size(), 3U);
  world.ConnectAll(2);
  world.Turn();
  world.Want(0);
  world.Turn(1000);
  EXPECT_TRUE(std::ranges::none_of(world.connected, [](const auto& info) {
    return info.state() == "draining";
  })) << "who computes is not told to go";
  world.SetIdle();
  world.Turn();
  world.Turn(59);
  EXPECT_EQ(world.connected[0].state(), "idle");
  world.Turn(1);
  for (const auto& info : world.connected) EXPECT_EQ(info.state(), "draining");
  EXPECT_TRUE(world.stopped.empty());
  // They have ended as they were told.
  world.connected.clear();
  for (auto& [name, worker] : world.has) worker.state = EngineWorker::State::kEnded;
  world.Turn();
  EXPECT_TRUE(world.has.empty()) << "forgotten";
  EXPECT_TRUE(world.keys.empty()) << "revoked";
  EXPECT_EQ(world.Count("w-1 "), 2U) << "it leaves, and has ended";
}

TEST(Scaler, AnotherGoesOnWhereOneEnded) {
  Scaled world;
  world.Want(3);
  world.Turn();
  world.ConnectAll(1);
  Scaler next({.policy = {.most = 5}, .prefix = "w-"}, world, world, world,
              [](Severity, const std::string&) {});
  world.Want(5);
  next.Turn(0);
  EXPECT_EQ(world.has.size(), 5U);
  EXPECT_TRUE(world.has.contains("w-5")) << "numbers go on";
}

TEST(Scaler, WhatAnotherStartedIsNeverTouchedButCounts) {
  Scaled world;
  world.Connect("by hand");
  world.Connect("w-oops");
  world.Want(4);
  world.Turn();
  EXPECT_EQ(world.has.size(), 2U);
  world.Want(0);
  world.ConnectAll();
  world.Turn();
  world.Turn(1000);
  EXPECT_EQ(world.connected[0].state(), "idle");
  EXPECT_EQ(world.connected[1].state(), "idle");
  EXPECT_EQ(world.connected[2].state(), "draining");
}

TEST(Scaler, DoesNothingWhileItDoesNotKnowAndSaysSoOnce) {
  for (Status World::* fails : {&World::engine_fails, &World::service_fails}) {
    Scaled world;
    world.Want(3);
    world.*fails = {Code::kIo, "gone fishing"};
    for (int i = 0; i < 5; ++i) world.Turn();
    EXPECT_TRUE(world.keys.empty());
    EXPECT_EQ(world.Count("gone fishing"), 1U);
    world.*fails = Status::Ok();
    world.Turn();
    EXPECT_EQ(world.has.size(), 3U);
    EXPECT_TRUE(world.Said("answers again"));
  }
}

TEST(Scaler, AnEngineThatRefusesIsAskedLessAndLessOften) {
  Scaled world;
  world.Want(3);
  world.start_fails = {Code::kRefused, "no such partition"};
  for (int i = 0; i < 1000; ++i) world.Turn();
  EXPECT_TRUE(world.keys.empty()) << "keys of those that were not begun";
  EXPECT_LE(world.Count("no such partition"), 9U) << "5, 10, 20, … and then every 300 s";
  EXPECT_GE(world.Count("no such partition"), 7U);
  world.start_fails = Status::Ok();
  world.Turn(300);
  EXPECT_EQ(world.has.size(), 3U);
}

TEST(Scaler, AFullEngineGivesWhatItHas) {
  Scaled world;
  world.places = 2;
  world.Want(5);
  for (int i = 0; i < 3; ++i) world.Turn();
  EXPECT_EQ(world.has.size(), 2U);
  EXPECT_EQ(world.keys.size(), 2U);
}

TEST(Scaler, WorkersThatEndAtOnceAreNotStartedForEver) {
  Scaled world;
  world.Want(1);
  int begun = 0;
  for (int i = 0; i < 1000; ++i) {
    world.Turn();
    for (auto& [name, worker] : world.has)
      if (worker.state == EngineWorker::State::kRuns) {
        ++begun;
        worker.state = EngineWorker::State::kEnded;
        worker.why = "another build";
      }
  }
  EXPECT_LE(begun, 9);
  EXPECT_GE(begun, 7);
  EXPECT_TRUE(world.Said("another build; none is started for 5 s"));
}

TEST(Scaler, OneThatIsLostIsReplacedAndItsKeyRevoked) {
  Scaled world;
  world.Want(2);
  world.Turn();
  world.ConnectAll(1);
  world.Turn();
  world.Gone("w-1");  // its node is dead, which the engine does not know yet
  world.Turn(14);
  EXPECT_EQ(world.has.size(), 2U) << "it may be back";
  world.Turn(1);
  EXPECT_TRUE(world.has.contains("w-3"));
  world.ConnectAll(1);
  world.has.erase("w-1");
  for (int i = 0; i < 31; ++i) world.Turn();
  EXPECT_FALSE(world.keys.contains("w-1"));
  EXPECT_EQ(world.has.size(), 2U);
}

TEST(Scaler, OneThatRunsAndNeverConnectsIsStopped) {
  Scaled world;
  world.Want(1);
  world.Turn();
  world.Turn();
  world.Turn(119);
  EXPECT_TRUE(world.stopped.empty());
  world.Turn(1);
  EXPECT_EQ(world.stopped, std::vector<std::string>{"w-1"});
  EXPECT_TRUE(world.Said("w-1 runs, but has not connected for 120 s"));
  world.Turn(31);
  EXPECT_FALSE(world.keys.contains("w-1"));
}

// As a cluster whose controller was just started again.
TEST(Scaler, AListWithoutThoseThatWereJustStartedStartsNoMore) {
  Scaled world;
  world.Want(3);
  world.Turn();
  const auto all = world.has;
  world.has.clear();
  world.Turn(29);
  EXPECT_TRUE(world.has.empty());
  world.has = all;
  world.Turn();
  EXPECT_EQ(world.has.size(), 3U);
  world.has.clear();
  for (int i = 0; i < 30; ++i) world.Turn();
  EXPECT_EQ(world.has.size(), 3U) << "those are gone for good";
  EXPECT_FALSE(world.has.contains("w-1"));
}

TEST(Scaler, WhatWaitsForAPlaceIsWaitedForAsLongAsItIsWanted) {
  Scaled world;
  world.Want(1);
  world.Turn();
  world.has["w-1"].state = EngineWorker::State::kWaiting;
  world.Turn(10000);
  EXPECT_EQ(world.has.size(), 1U);
  EXPECT_TRUE(world.stopped.empty());
  world.Want(0);
  world.Turn();
  EXPECT_EQ(world.stopped, std::vector<std::string>{"w-1"});
  world.Turn();
  EXPECT_TRUE(world.keys.empty());
}

TEST(Scaler, AKeyThatNobodyHasIsRevoked) {
  Scaled world;
  world.keys = {"w-7", "desk"};
  world.Turn();
  world.Turn(29);
  EXPECT_TRUE(world.keys.contains("w-7")) << "it may be on its way";
  world.Turn(1);
  EXPECT_EQ(world.keys, std::set<std::string>{"desk"});
  world.Want(1);
  world.Turn();
  EXPECT_TRUE(world.has.contains("w-8")) << "no number comes twice";
}

TEST(Scaler, WithKeysANameAloneMakesNoWorkerOurs) {
  Scaled world;
  const std::string most = "w-18446744073709551615";
  world.Connect(most);
  world.Connect("w-4");
  world.has[most] = {.name = most};
  world.has["w-5"] = {.name = "w-5"};
  world.Turn();
  EXPECT_EQ(world.scaler->workers(), 0U);
  world.Want(3);
  world.Turn();
  EXPECT_EQ(world.keys, std::set<std::string>{"w-1"}) << "two others serve, and numbers begin with 1";
  world.Want(0);
  world.Turn(1000);
  EXPECT_EQ(world.connected[0].state(), "idle");
  EXPECT_EQ(world.connected[1].state(), "idle");
  EXPECT_EQ(std::ranges::count(world.stopped, most), 0);
  EXPECT_EQ(std::ranges::count(world.stopped, "w-5"), 1) << "it has no key, and does not end by itself";
}

TEST(Scaler, IsOverWhenAllIsDoneAndAllHaveGone) {
  Scaled world({.until_done = true});
  world.Want(2);
  world.Turn();
  world.ConnectAll(1);
  world.Turn();
  EXPECT_FALSE(world.scaler->over());
  world.Want(0);
  world.SetIdle();
  world.Turn();
  for (const auto& info : world.connected) EXPECT_EQ(info.state(), "draining");
  world.connected.clear();
  world.has.clear();
  world.Turn();
  EXPECT_TRUE(world.scaler->over());
  EXPECT_TRUE(world.keys.empty());
}

TEST(Scaler, TwoOfOneNameAreTwo) {
  Scaled world;
  world.Want(2);
  world.Turn();
  for (const char* name : {"w-1", "w-1", "w-2"}) world.Connect(name);  // an engine that starts twice
  world.Turn();
  EXPECT_EQ(world.scaler->workers(), 3U);
  world.Turn(1000);
  EXPECT_EQ(std::ranges::count(world.connected, "draining", &wire::WorkerInfo::state), 1)
      << "one is too many";
}

}  // namespace
}  // namespace cairn::coordinator
