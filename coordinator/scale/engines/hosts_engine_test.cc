#include "coordinator/scale/engines/hosts_engine.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <thread>

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

TEST(ParseHosts, TakesHostsWithCoresAndMemory) {
  const std::vector<Host> hosts =
      ParseHosts("# ours\ndesk 4\n\nann@lab-2.example 16 64000  # the large one\n", "hosts");
  ASSERT_EQ(hosts.size(), 2U);
  EXPECT_EQ(hosts[0].name, "desk");
  EXPECT_EQ(hosts[0].cores, 4);
  EXPECT_EQ(hosts[0].memory_mb, 0U);
  EXPECT_EQ(hosts[1].name, "ann@lab-2.example");
  EXPECT_EQ(hosts[1].memory_mb, 64000U);
}

TEST(ParseHosts, SaysWhichLineIsWrong) {
  const auto wrong = [](const std::string& text) -> std::string {
    try {
      ParseHosts(text, "hosts");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(wrong("desk 4\ndesk 2\n"), "hosts, line 2: 'desk' is here twice");
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "is no host", wrong("-oProxyCommand=reboot 4"));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "is no host", wrong("desk;reboot 4"));
  for (const char* text : {"desk", "desk many", "desk 0", "desk -1"})
    EXPECT_PRED_FORMAT2(testing::IsSubstring, "how many cores", wrong(text)) << text;
  for (const char* text : {"desk 4 8GB", "desk 4 -1"})
    EXPECT_PRED_FORMAT2(testing::IsSubstring, "no memory in MB", wrong(text)) << text;
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "one word too many", wrong("desk 4 1 2"));
  EXPECT_EQ(wrong("# nobody\n"), "hosts: names no host");
}

// Hosts that are folders of this machine; a program of the test's own in the place of cairn-worker.
struct Hosts {
  Hosts() {
    fs::remove_all(dir);
    fs::create_directories(dir / "keys");
    std::ofstream(dir / "program") << "#!/bin/sh\n"
                                      "trap 'echo told to go; exit 0' TERM\n"
                                      "echo \"$@\" >>\""
                                   << (dir / "begun").string()
                                   << "\"\n"
                                      "until [ -e \""
                                   << (dir / "end").string()
                                   << "\" ] || ! [ -e \"$0\" ]; do sleep 0.05; done\n"
                                      "echo what went wrong; exit 2\n";
    fs::permissions(dir / "program", fs::perms::owner_all);
    options.hosts = {{"one", 2, 0}, {"two", 3, 300}};
    options.shell = [this](const Host& host) {
      if (away == host.name)
        return std::vector<std::string>{"sh", "-c", "echo no route to host >&2; exit 255"};
      return std::vector<std::string>{"env", "HOME=" + (dir / host.name).string(), "sh", "-c",
                                      "mkdir -p $HOME && cd && exec sh -s"};
    };
    options.folder = "its workers";
    options.worker = (dir / "program").string();
    options.options = {"--connect", "tcp://hub:7017"};
    options.log = [this](Severity, const std::string& line) { said += line + "\n"; };
  }
  ~Hosts() {
    std::ofstream(dir / "end") << "now";
    std::error_code ignored;
    fs::remove_all(dir, ignored);
  }

  // How many programs have set their traps.
  std::ptrdiff_t Begun() const {
    std::ifstream file(dir / "begun");
    return std::count(std::istreambuf_iterator<char>(file), {}, '\n');
  }
  std::vector<EngineWorker> ListUntil(Engine& engine,
                                      const std::function<bool(const std::vector<EngineWorker>&)>& is) {
    for (int i = 0; i < 1200; ++i) {
      Result<std::vector<EngineWorker>> list = engine.List();
      if (list.ok() && is(list.value())) return list.value();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    ADD_FAILURE() << "it never came to be";
    return {};
  }
  std::vector<EngineWorker> ListEnded(Engine& engine, std::size_t count) {
    return ListUntil(engine, [&](const std::vector<EngineWorker>& list) {
      return std::ranges::count(list, EngineWorker::State::kEnded, &EngineWorker::state) ==
             static_cast<std::ptrdiff_t>(count);
    });
  }

  const fs::path dir = fs::path(testing::TempDir()) / ("hosts_engine." + std::to_string(::getpid()));
  HostsOptions options;
  std::string away;  // that host does not answer
  std::string said;
};

std::vector<std::string> Names(int first, int last) {
  std::vector<std::string> names;
  for (int i = first; i <= last; ++i) names.push_back("w-" + std::to_string(i));
  return names;
}

// The shell that waits for a worker is there before anybody is told of it.
TEST(HostsEngine, AWorkerThatIsToldToGoAtOnceSaysHowItEnded) {
  Hosts hosts;
  HostsEngine engine(hosts.options);
  ASSERT_TRUE(engine.List().ok());
  for (int i = 0; i < 5; ++i) {
    const std::vector<std::string> names = Names(10 * i, 10 * i + 4);
    ASSERT_EQ(engine.Start(names).names.size(), 5U);
    ASSERT_TRUE(engine.Stop(names).ok());
    for (const EngineWorker& worker : hosts.ListEnded(engine, 5))
      EXPECT_EQ(worker.why.find("its process is gone"), std::string::npos) << worker.name;
    engine.Forget(names);
    ASSERT_TRUE(engine.List().ok());
  }
}

TEST(HostsEngine, StartsWhereThereIsRoomAndAnotherFindsThemAgain) {
  Hosts hosts;
  HostsEngine engine(hosts.options);
  ASSERT_TRUE(engine.List().ok());
  const Engine::Started started = engine.Start(Names(1, 6));
  EXPECT_EQ(started.names.size(), 5U) << "two cores and three";
  EXPECT_EQ(started.status.code(), Code::kNoSpace);
  HostsEngine another(hosts.options);
  const auto list = another.List();
  ASSERT_TRUE(list.ok());
  ASSERT_EQ(list.value().size(), 5U);
  EXPECT_EQ(std::ranges::count(list.value(), "two", &EngineWorker::where), 3);
  EXPECT_EQ(std::ranges::count(list.value(), EngineWorker::State::kRuns, &EngineWorker::state), 5);
  EXPECT_EQ(another.Start(Names(7, 7)).names.size(), 0U);

  // Those that are told to go say why they went, in the end.
  hosts.ListUntil(another, [&](const auto&) { return hosts.Begun() == 5; });
  ASSERT_TRUE(another.Stop({"w-1", "w-2"}).ok());
  for (const EngineWorker& worker : hosts.ListEnded(another, 2)) EXPECT_EQ(worker.why, "");
  another.Forget({"w-1", "w-2"});
  EXPECT_EQ(another.List().value().size(), 3U);
  std::ofstream(hosts.dir / "end") << "now";
  for (const EngineWorker& worker : hosts.ListEnded(another, 3))
    EXPECT_EQ(worker.why, "what went wrong (exit code 2)");
}

TEST(HostsEngine, GivesEachItsNameItsKeyAndItsShareOfTheMemory) {
  Hosts hosts;
  hosts.options.hosts = {{"two", 3, 300}};
  hosts.options.keys = (hosts.dir / "keys").string();
  hosts.options.server_key = "the hub's key";
  std::ofstream(hosts.dir / "keys" / "w-1.key") << "it's a secret\n";
  HostsEngine engine(hosts.options);
  ASSERT_TRUE(engine.List().ok());
  ASSERT_EQ(engine.Start({"w-1"}).names.size(), 1U);
  hosts.ListUntil(engine, [&](const auto&) {
    return fs::exists(hosts.dir / "begun") && fs::file_size(hosts.dir / "begun") > 0;
  });
  std::stringstream begun;
  begun << std::ifstream(hosts.dir / "begun").rdbuf();
  EXPECT_EQ(begun.str(),
            "--name w-1 --connect tcp://hub:7017 --task-memory-mb 100 --key w-1.key --server-key "
            "coordinator.pub\n");
  const fs::path key = hosts.dir / "two" / "its workers" / "two" / "w-1.key";
  std::stringstream secret;
  secret << std::ifstream(key).rdbuf();
  EXPECT_EQ(secret.str(), "it's a secret\n");
  EXPECT_EQ(fs::status(key).permissions() & fs::perms::all, fs::perms::owner_read | fs::perms::owner_write);
  ASSERT_TRUE(engine.Stop({"w-1"}).ok());
  hosts.ListEnded(engine, 1);
  engine.Forget({"w-1"});
  EXPECT_FALSE(fs::exists(key));
}

// Its number may be another process's by now.
TEST(HostsEngine, OfAProcessThatIsGoneItSaysSo) {
  Hosts hosts;
  HostsEngine engine(hosts.options);
  fs::create_directories(hosts.dir / "one" / "its workers" / "one");
  std::ofstream(hosts.dir / "one" / "its workers" / "one" / "w-1.pid") << "1 12345\n";
  const auto list = engine.List();
  ASSERT_TRUE(list.ok());
  ASSERT_EQ(list.value().size(), 1U);
  EXPECT_EQ(list.value()[0].state, EngineWorker::State::kEnded);
  EXPECT_TRUE(list.value()[0].why.starts_with("its process is gone"));
  EXPECT_TRUE(engine.Stop({"w-1"}).ok()) << "and process 1 is not touched";
}

TEST(HostsEngine, AHostThatDoesNotAnswerIsLeftAloneAndTheOthersServe) {
  Hosts hosts;
  hosts.options.away_s = hosts.options.most_away_s = 0;
  HostsEngine engine(hosts.options);
  ASSERT_TRUE(engine.List().ok());
  ASSERT_EQ(engine.Start(Names(1, 2)).names.size(), 2U);
  hosts.away = "one";
  const auto list = engine.List();
  ASSERT_TRUE(list.ok());
  EXPECT_EQ(list.value().size(), 2U) << "its workers are what they were";
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "one is left alone for a while: sh: no route to host",
                      hosts.said);
  for (const std::string& name : engine.Start(Names(3, 6)).names)
    EXPECT_TRUE(fs::exists(hosts.dir / "two" / "its workers" / "two" / (name + ".pid"))) << name;
  hosts.away.clear();
  ASSERT_TRUE(engine.List().ok());
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "one answers again", hosts.said);
  hosts.options.hosts = {{"one", 2, 0}};
  hosts.away = "one";
  EXPECT_EQ(HostsEngine(hosts.options).List().status().message(), "sh: no route to host");
}

TEST(HostsEngine, AProgramThatIsNotThereIsSaid) {
  Hosts hosts;
  hosts.options.worker = "/no/cairn-worker";
  HostsEngine engine(hosts.options);
  ASSERT_TRUE(engine.List().ok());
  ASSERT_EQ(engine.Start({"w-1"}).names.size(), 1U);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "/no/cairn-worker", hosts.ListEnded(engine, 1)[0].why);
}

TEST(ReadList, LeavesOutWhatItDoesNotKnow) {
  EXPECT_TRUE(ReadList("\nwelcome to desk\nw-1\nw-2 sleeps\nlisted\n", "desk").empty());
  EXPECT_EQ(ReadList("w-1 ended 137 \n", "desk").at(0).why, "exit code 137");
}

}  // namespace
}  // namespace cairn::coordinator
