#include "coordinator/server/service.h"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>

#include "coordinator/server/metrics_port.h"
#include "coordinator/store/folder.h"
#include "coordinator/store/holder.h"
#include "schema/wire/testing/private_folder.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

// Whoever serves it elsewhere goes on: it would end for one that nobody can reach.
TEST(ServiceStart, OneThatCannotBeReachedTakesNoStoreOver) {
  const wire::PrivateFolder temp;
  const fs::path& folder = temp.path();
  const fs::path store = folder / "store";
  {
    ASSERT_TRUE(StoreFolder::Open(store).ok());
  }
  const Holder elsewhere{.number = 7, .serves = true, .host = "hub1", .boot = "b", .process = 12};
  ASSERT_TRUE(WriteHolder(store / "holder", elsewhere).ok());
  const auto metrics = MetricsPort::Listen("127.0.0.1:0");
  ASSERT_TRUE(metrics.ok()) << metrics.status().message();
  ServiceOptions options;
  options.store_dir = store;
  options.listen = temp.Ipc("socket");
  options.take_over = true;
  const std::atomic<bool> stop = true;
  const auto log = [](Severity, const std::string&) {};
  options.metrics = metrics.value()->address();
  EXPECT_FALSE(Serve(options, log, stop).ok()) << "its metrics' port is another's";
  EXPECT_EQ(ReadHolder(store / "holder").value(), elsewhere);
  options.metrics.clear();
  options.listen = "ipc://" + (folder / "none" / "socket").string();
  EXPECT_FALSE(Serve(options, log, stop).ok()) << "there is no folder for its socket";
  EXPECT_EQ(ReadHolder(store / "holder").value(), elsewhere);
  options.listen = temp.Ipc("socket");
  EXPECT_TRUE(Serve(options, log, stop).ok());
  EXPECT_EQ(ReadHolder(store / "holder").value().number, 8U);
  EXPECT_FALSE(ReadHolder(store / "holder").value().serves);
}

}  // namespace
}  // namespace cairn::coordinator
