#include "coordinator/local/worker_pool.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "coordinator/local/private_folder.h"

namespace cairn::coordinator {
namespace {

// A worker whose whole program is one line of shell.
std::string WorkerThat(const std::filesystem::path& folder, const std::string& line) {
  const std::filesystem::path program = folder / "worker";
  std::ofstream(program) << "#!/bin/sh\n" << line << "\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  return program.string();
}

TEST(WorkerPool, StartsWhoSaysItWasRefusedAgainWhileItsTurnsLast) {
  const Result<PrivateFolder> made = PrivateFolder::Make();
  ASSERT_TRUE(made.ok()) << made.status().message();
  const PrivateFolder& folder = made.value();
  WorkerPool pool({WorkerThat(folder.path(), "exit 2"), "ipc:///none", 1, 2, folder.path() / "log"});
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

TEST(WorkerPool, TellsOfWhichSignalAWorkerDied) {
  const Result<PrivateFolder> made = PrivateFolder::Make();
  ASSERT_TRUE(made.ok()) << made.status().message();
  const PrivateFolder& folder = made.value();
  WorkerPool pool({WorkerThat(folder.path(), "kill -9 $$"), "ipc:///none", 1, 0, folder.path() / "log"});
  ASSERT_TRUE(pool.Start().ok());
  std::vector<WorkerPool::Death> deaths;
  while (deaths.empty()) {
    deaths = pool.Reap();
    std::this_thread::yield();
  }
  ASSERT_EQ(deaths.size(), 1u);
  EXPECT_EQ(deaths[0].signal, SIGKILL);
  EXPECT_FALSE(deaths[0].refused);
}

// Were it opened as files are, the test would never end.
TEST(WorkerPool, WaitsForNobodyWhoReadsFromAFifoInPlaceOfItsLog) {
  const Result<PrivateFolder> made = PrivateFolder::Make();
  ASSERT_TRUE(made.ok()) << made.status().message();
  const std::filesystem::path folder = made.value().path(), log = folder / "log";
  ASSERT_EQ(::mkfifo(log.c_str(), 0600), 0);
  WorkerPool pool({WorkerThat(folder, "exit 0"), "ipc:///none", 1, 0, log});
  const Status status = pool.Start();
  EXPECT_EQ(status.code(), Code::kRefused);
  EXPECT_EQ(status.message().find(log.string() + " is no regular file"), 0u) << status.message();
  EXPECT_TRUE(pool.AllGone());
}

}  // namespace
}  // namespace cairn::coordinator
