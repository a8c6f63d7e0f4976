#include "schema/service_manager.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "schema/service_manager_testing.h"

namespace cairn {
namespace {

TEST(ServiceManager, IsToldOfReadinessOfLifeAndOfTheEnd) {
  FakeServiceManager manager;
  ::setenv("WATCHDOG_USEC", "3", 1);
  ::setenv("WATCHDOG_PID", std::to_string(::getpid()).c_str(), 1);
  ServiceManager told;
  told.Ready();
  ::usleep(2);
  told.Alive();
  told.Stopping();
  EXPECT_EQ(manager.Hear(), "READY=1");
  EXPECT_EQ(manager.Hear(), "WATCHDOG=1");
  EXPECT_EQ(manager.Hear(), "STOPPING=1");
  EXPECT_EQ(manager.Hear(), "");
}

TEST(ServiceManager, HearsOfLifeNoMoreOftenThanItWatches) {
  FakeServiceManager manager;
  ::setenv("WATCHDOG_USEC", "3600000000", 1);
  ServiceManager told;
  for (int i = 0; i < 1000; ++i) told.Alive();
  EXPECT_EQ(manager.Hear(), "WATCHDOG=1");
  EXPECT_EQ(manager.Hear(), "");
}

TEST(ServiceManager, HearsOfLifeOnlyWhereItWatchesThisProcess) {
  FakeServiceManager manager;
  ServiceManager unwatched;
  unwatched.Alive();
  ::setenv("WATCHDOG_USEC", "3", 1);
  ::setenv("WATCHDOG_PID", std::to_string(::getppid()).c_str(), 1);
  ServiceManager of_another;
  of_another.Alive();
  EXPECT_EQ(manager.Hear(), "");
}

TEST(ServiceManager, WhereThereIsNoneNothingHappens) {
  for (const char* name : {"", "relative", "/nowhere/at/all", "@nobody-listens-here"}) {
    ::setenv("NOTIFY_SOCKET", name, 1);
    ServiceManager told;
    told.Ready();
    told.Stopping();
  }
  ::unsetenv("NOTIFY_SOCKET");
  ServiceManager().Ready();
}

}  // namespace
}  // namespace cairn
