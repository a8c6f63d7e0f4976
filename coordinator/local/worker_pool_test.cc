#include "coordinator/local/worker_pool.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "coordinator/local/private_folder.h"

namespace cairn::coordinator {
namespace {

// A worker that ends at once with the exit code of the refused.
std::string RefusedWorker(const std::filesystem::path& folder) {
  const std::filesystem::path program = folder / "worker";
  std::ofstream(program) << "#!/bin/sh\nexit 2\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  return program.string();
}

TEST(WorkerPool, StartsWhoSaysItWasRefusedAgainWhileItsTurnsLast) {
  const Result<PrivateFolder> made = PrivateFolder::Make();
  ASSERT_TRUE(made.ok()) << made.status().message();
  const PrivateFolder& folder = made.value();
  WorkerPool pool({RefusedWorker(folder.path()), "ipc:///none", 1, 2, folder.path() / "log"});
  ASSERT_TRUE(pool.Start().ok());
  int deaths = 0;
  while (!pool.AllGone()) {
    for (const WorkerPool::Death& death : pool.Reap()) {
      EXPECT_TRUE(death.refused);
      ++deaths;
    }
    std::this_thread::yield();
  }
  EXPECT_EQ(deaths, 3);
}

}  // namespace
}  // namespace cairn::coordinator
