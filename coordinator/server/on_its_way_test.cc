#include "coordinator/server/on_its_way.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "coordinator/server/testing/hub_fixture.h"

namespace cairn::coordinator {
namespace {

using To = OnItsWay::To;

TEST(OnItsWay, CountsTheSameOnceForAllAndEachTimeForItsUser) {
  FakeTransport transport;
  OnItsWay on_its_way(transport, 60);
  transport.unsent = {{"a", 10}, {"b", 20}, {"c", 5}, {"d", 100}};
  on_its_way.Add("a", To::kUsers, "x", "map");
  on_its_way.Add("b", To::kUsers, "x", "map");
  on_its_way.Add("c", To::kUsers, "y", "another");
  on_its_way.Add("d", To::kAdministrators, "z", "map");
  EXPECT_EQ(on_its_way.Bytes(To::kUsers, ""), 25U);
  EXPECT_EQ(on_its_way.Bytes(To::kUsers, "map"), 5U);
  EXPECT_EQ(on_its_way.Bytes(To::kAdministrators, ""), 100U);
  EXPECT_EQ(on_its_way.BytesOf("x"), 30U);
  transport.unsent["b"] = 0;
  EXPECT_EQ(on_its_way.BytesOf("x"), 10U);
}

TEST(OnItsWay, WhoTakesNothingForTooLongIsReturnedOnceAndWhoTakesLittleIsNot) {
  FakeTransport transport;
  OnItsWay on_its_way(transport, 60);
  on_its_way.Look(0);
  transport.unsent = {{"deaf", 1000}, {"slow", 1000}, {"quick", 1000}};
  for (const char* peer : {"deaf", "slow", "quick"}) on_its_way.Add(peer, To::kUsers, "x", peer);
  transport.unsent["quick"] = 0;
  std::vector<std::string> stalled;
  for (int s = 1; s <= 200; ++s) {
    if (s % 50 == 0) --transport.unsent["slow"];
    for (const std::string& peer : on_its_way.Look(s)) stalled.push_back(peer + std::to_string(s));
  }
  EXPECT_EQ(stalled, std::vector<std::string>{"deaf61"});
}

// It was stopped itself, or busy.
TEST(OnItsWay, WhileNobodyLooksNobodyIsIdle) {
  FakeTransport transport;
  OnItsWay on_its_way(transport, 60);
  transport.unsent = {{"a", 1000}};
  on_its_way.Add("a", To::kUsers, "x", "map");
  for (int s = 1000; s < 30'000; s += 1000) EXPECT_TRUE(on_its_way.Look(s).empty()) << s;
}

TEST(OnItsWay, AnswersToAWorkerAreOutInTheOrderInWhichTheyWereSent) {
  FakeTransport transport;
  OnItsWay on_its_way(transport, 60);
  transport.unsent = {{"w", 60}};
  on_its_way.AddFetched("w", "first", 10, true);
  on_its_way.AddFetched("w", "second", 20, false);
  on_its_way.AddFetched("w", "third", 30, true);
  EXPECT_EQ(on_its_way.copied_bytes(), 40U);
  const auto expect = [&](std::size_t unsent, bool first, bool second, bool third) {
    transport.unsent["w"] = unsent;
    EXPECT_EQ(on_its_way.HasFetched("w", "first"), first) << unsent;
    EXPECT_EQ(on_its_way.HasFetched("w", "second"), second) << unsent;
    EXPECT_EQ(on_its_way.HasFetched("w", "third"), third) << unsent;
  };
  expect(51, true, true, true);
  expect(50, false, true, true);
  expect(31, false, true, true);
  expect(30, false, false, true);
  on_its_way.Look(1);
  EXPECT_EQ(on_its_way.copied_bytes(), 30U);
  EXPECT_FALSE(on_its_way.HasFetched("another", "third"));
  expect(0, false, false, false);
}

}  // namespace
}  // namespace cairn::coordinator
