#include "schema/wire/poller.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "schema/wire/testing/link.h"

namespace cairn::wire {
namespace {

TEST(Poller, AWakeupFromAnotherThreadEndsTheWait) {
  Link link;
  const Wakeup wakeup;
  Poller poller;
  poller.Add(link.router);
  poller.Add(wakeup);
  std::thread other([&] { wakeup.Signal(); });
  EXPECT_TRUE(poller.Wait(kPatience));
  other.join();
  EXPECT_FALSE(poller.Wait(std::chrono::milliseconds(0)));
}

}  // namespace
}  // namespace cairn::wire
