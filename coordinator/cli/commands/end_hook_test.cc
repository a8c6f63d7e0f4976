#include "coordinator/cli/commands/end_hook.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "schema/wire/testing/private_folder.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

// All of it takes milliseconds: what is not so after two minutes will not be.
template <class IsSo>
void AwaitThat(const std::string& what, const IsSo& is_so) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (!is_so()) {
    if (std::chrono::steady_clock::now() > end) throw std::runtime_error("never: " + what);
    ::usleep(1000);
  }
}

class EndHookTest : public testing::Test {
 protected:
  std::string Script(const std::string& lines) {
    const fs::path path = folder_.path() / "hook";
    std::ofstream(path) << "#!/bin/sh\n" << lines;
    ::chmod(path.c_str(), 0700);
    return path.string();
  }
  void Start(const std::string& program, double limit_s = 60) {
    hook_.emplace(program, limit_s, [this](coordinator::Severity, const std::string& line) {
      const std::lock_guard lock(mutex_);
      log_.push_back(line);
    });
  }
  static wire::JobInfo Job(const std::string& id) {
    wire::JobInfo job;
    job.set_id(id);
    job.set_name("museum'; touch /tmp/x #");
    job.set_state("failed");
    job.set_reason("trouble");
    return job;
  }
  std::string Await(const std::string& file) {
    AwaitThat(file, [&] { return fs::exists(folder_.path() / file); });
    std::stringstream text;
    text << std::ifstream(folder_.path() / file).rdbuf();
    return text.str();
  }
  std::vector<std::string> Log() {
    const std::lock_guard lock(mutex_);
    return log_;
  }
  std::vector<std::string> AwaitLog(std::size_t lines = 1) {
    AwaitThat(std::to_string(lines) + " lines of the log", [&] { return Log().size() >= lines; });
    return Log();
  }

  const wire::PrivateFolder folder_;
  std::mutex mutex_;
  std::vector<std::string> log_;
  std::optional<EndHook> hook_;
};

TEST_F(EndHookTest, TheProgramGetsTheJobOnItsInputAndNoArguments) {
  const std::string here = folder_.path().string();
  Start(Script("[ $# = 0 ] || exit 1\ncat >" + here + "/part && mv " + here + "/part " + here + "/job\n"));
  hook_->JobEnded(Job("7-museum"));
  const auto json = nlohmann::json::parse(Await("job"));
  EXPECT_EQ(json.at("id"), "7-museum");
  EXPECT_EQ(json.at("name"), "museum'; touch /tmp/x #");
  EXPECT_EQ(json.at("state"), "failed");
  AwaitThat("it is idle", [&] { return hook_->Idle(); });
  hook_.reset();
  EXPECT_TRUE(Log().empty()) << Log().front();
}

TEST_F(EndHookTest, OneThatFailsOrIsNotThereIsALineOfTheLogAndTheNextIsRun) {
  Start(Script("echo cannot reach the chat >&2\nexit 3\n"));
  hook_->JobEnded(Job("7-museum"));
  EXPECT_NE(AwaitLog()[0].find("--on-end for job 7-museum: "), std::string::npos) << Log()[0];
  EXPECT_NE(Log()[0].find("cannot reach the chat"), std::string::npos) << Log()[0];
  hook_->JobEnded(Job("8-museum"));
  AwaitLog(2);
  hook_.reset();
  log_.clear();
  Start((folder_.path() / "nothing").string());
  hook_->JobEnded(Job("9-museum"));
  EXPECT_NE(AwaitLog()[0].find("No such file"), std::string::npos) << Log()[0];
}

TEST_F(EndHookTest, OneThatTakesTooLongIsKilledAndTheLogSaysSo) {
  Start(Script("sleep 1000\n"), 0.1);
  hook_->JobEnded(Job("7-museum"));
  EXPECT_NE(AwaitLog()[0].find("no answer"), std::string::npos) << Log()[0];
}

// A zombie has ended: whoever started this test may not look after it.
void AwaitEnd(pid_t process) {
  AwaitThat("the end of process " + std::to_string(process), [process] {
    std::ifstream stat("/proc/" + std::to_string(process) + "/stat");
    std::string pid, name, state;
    return !(stat >> pid >> name >> state) || state == "Z";
  });
}

TEST_F(EndHookTest, WhatItStartedEndsWithIt) {
  const std::string here = folder_.path().string();
  Start(
      Script("sleep 1000 &\necho $! >" + here + "/part && mv " + here + "/part " + here + "/child\nwait\n"));
  hook_->JobEnded(Job("7-museum"));
  const pid_t child = std::stoi(Await("child"));
  hook_.reset();
  AwaitEnd(child);
}

TEST_F(EndHookTest, SoDoesWhatItLeavesBehind) {
  const std::string here = folder_.path().string();
  Start(Script("sleep 1000 >/dev/null 2>&1 &\necho $! >" + here + "/part && mv " + here + "/part " + here +
               "/child\n"));
  hook_->JobEnded(Job("7-museum"));
  const pid_t child = std::stoi(Await("child"));
  AwaitEnd(child);
  hook_.reset();
  EXPECT_TRUE(Log().empty()) << Log().front();
}

// A process of its own, for it is killed.
TEST_F(EndHookTest, AndWithItsLimitWhereWhoStartedItIsKilled) {
  const std::string here = folder_.path().string();
  const std::string hook =
      Script("sleep 1000 &\necho $! >" + here + "/part && mv " + here + "/part " + here + "/child\nwait\n");
  const pid_t coordinator = ::fork();
  if (coordinator == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    Start(hook, 1);
    hook_->JobEnded(Job("7-museum"));
    while (true) ::pause();
  }
  const pid_t child = std::stoi(Await("child"));
  ::kill(coordinator, SIGKILL);
  ::waitpid(coordinator, nullptr, 0);
  AwaitEnd(child);
}

// The service is told of hundreds at once, and ends, while one hangs.
TEST_F(EndHookTest, WhoTellsItWaitsForNothingAndItsEndDoesNotEither) {
  const std::string here = folder_.path().string();
  Start(Script("touch " + here + "/began\nsleep 1000\n"));
  hook_->JobEnded(Job("0"));
  Await("began");
  for (std::size_t i = 0; i < EndHook::kMostWaiting + 5; ++i) hook_->JobEnded(Job(std::to_string(i)));
  hook_.reset();
  const std::string last = Log().back();
  EXPECT_NE(last.find("was not run for 1000 of the jobs"), std::string::npos) << last;
}

}  // namespace
}  // namespace cairn::cli
