// How many workers one coordinator serves: `cairn coordinator` as people run it, with its store, and as many
// workers' sockets as are asked for, in processes of some thousands each. They join, are idle for a while,
// compute a job of tasks that do nothing, and then a job of tasks that take a while, in the middle of which
// the coordinator is killed and started again. Prints a JSON line; --check: exit code 1 where a task was lost
// or ran twice, a worker was taken for lost, or not all came back. docs/scale.md has what it printed.
#include <fcntl.h>
#include <sodium.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zmq.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <list>
#include <nlohmann/json.hpp>
#include <thread>

#include "coordinator/client.h"
#include "schema/numerics.h"
#include "schema/wire/keys.h"
#include "schema/wire/testing/private_folder.h"
#include "schema/wire/testing/raw_peer.h"
#include "tests/swarm/swarm.h"

namespace cairn::swarm {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  int workers = 10'000, processes = 0, nodes = 100, slots = 4;
  int tasks = 100'000, rounds = 6;
  double idle_s = 5;
  bool tcp = false, kill = false, check = false;
  int task_ms = 500, tasks_a_worker = 20;
  int restart_ms = 0;
  std::string program = CAIRN_PROGRAM, store;
};

void Sleep(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }
double Now_s() { return static_cast<double>(NowNs()) * 1e-9; }

// A process that ends with the object.
class Child {
 public:
  explicit Child(const std::function<void()>& work) : pid_(::fork()) {
    if (pid_ != 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    work();
    std::_Exit(1);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() { Kill(); }
  void Kill() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    pid_ = 0;
  }
  pid_t pid() const { return pid_; }
  // The most memory it ever had, in MiB.
  double PeakMib() const {
    std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
    for (std::string line; std::getline(status, line);)
      if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) / 1024;
    return 0;
  }
  // Processor seconds so far: of the event loop, of ZeroMQ's thread, of all other threads.
  struct Used {
    double loop_s = 0, sockets_s = 0, others_s = 0;
  };
  Used ProcessorSeconds() const {
    Used used;
    std::error_code gone;
    for (const auto& entry : fs::directory_iterator("/proc/" + std::to_string(pid_) + "/task", gone)) {
      std::ifstream file(entry.path() / "schedstat");
      double run_ns = 0;
      file >> run_ns;
      std::string name;
      std::getline(std::ifstream(entry.path() / "comm") >> std::ws, name);
      double& of = entry.path().filename() == std::to_string(pid_) ? used.loop_s
                   : name.starts_with("ZMQbg/IO")                  ? used.sockets_s
                                                                   : used.others_s;
      of += run_ns * 1e-9;
    }
    return used;
  }

 private:
  pid_t pid_;
};

// Keys of a coordinator, of each node and of the client, and the list of them.
struct Keys {
  std::vector<PeerKeys> nodes;
  wire::ClientSecurity client;
};

Key Raw(const std::string& text) {
  Key key{};
  CAIRN_DEMAND(zmq_z85_decode(key.data(), text.c_str()) != nullptr, "no key");
  return key;
}

Keys MakeKeys(const fs::path& dir, int nodes) {
  fs::create_directory(dir);
  const wire::KeyPair coordinator = wire::GenerateKeyPair();
  CAIRN_DEMAND(wire::WriteKeyPair(dir / "coordinator", coordinator).ok(), "no keys");
  Keys keys;
  keys.client = {wire::GenerateKeyPair(), coordinator.public_key};
  std::ofstream list(dir / "allowed");
  list << keys.client.keys.public_key << " submitter\n";
  for (int i = 0; i < nodes; ++i) {
    const wire::KeyPair node = wire::GenerateKeyPair();
    keys.nodes.push_back({Raw(coordinator.public_key), Raw(node.public_key), Raw(node.secret_key)});
    list << node.public_key << " worker node" << i << "\n";
  }
  list << "end\n";
  return keys;
}

class Bench {
 public:
  explicit Bench(const Arguments& a)
      : a_(a),
        shared_(static_cast<std::size_t>(a.workers),
                static_cast<std::size_t>(std::max(a.tasks * a.rounds, 2 * a.workers * a.tasks_a_worker))),
        endpoint_(a.tcp ? wire::FreeTcpEndpoint() : folder_.Ipc("hub")) {
    if (a.tcp) keys_ = MakeKeys(folder_.path() / "keys", a.nodes);
    shared_.sums().epoch = 1;
  }

  int Run() {
    StartCoordinator();
    StartSwarm();
    Join();
    Say("all have joined");
    Idle();
    Rate();
    Say("the job is done");
    if (a_.kill) Recover();
    Facts();
    std::puts(result_.dump().c_str());
    return a_.check && !wrong_.empty() ? 1 : 0;
  }

 private:
  // How it goes: a run at size takes minutes.
  void Say(const std::string& what) const {
    std::fprintf(stderr, "%6.1f s  %s\n", Now_s() - began_s_, what.c_str());
  }

  void StartCoordinator() {
    const std::string store = a_.store.empty() ? (folder_.path() / "store").string() : a_.store;
    const std::string log = Log(), most = std::to_string(2 * a_.workers + 64);
    coordinator_.emplace([&] {
      ::dup2(::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600), STDERR_FILENO);
      ::dup2(STDERR_FILENO, STDOUT_FILENO);
      const std::string keys = (folder_.path() / "keys").string();
      std::vector<const char*> words = {a_.program.c_str(),  "coordinator", "--store",
                                        store.c_str(),       "--listen",    endpoint_.c_str(),
                                        "--max-connections", most.c_str()};
      if (a_.tcp) words.insert(words.end(), {"--keys", keys.c_str()});
      words.push_back(nullptr);
      ::execv(words[0], const_cast<char* const*>(words.data()));
    });
  }
  std::string Log() const { return (folder_.path() / "log").string(); }

  void StartSwarm() {
    constexpr int kOfAProcess = 5000;
    const int processes = a_.processes > 0 ? a_.processes : (a_.workers + kOfAProcess - 1) / kOfAProcess;
    for (int i = 0; i < processes; ++i) {
      const int first = i * a_.workers / processes, end = (i + 1) * a_.workers / processes;
      swarms_.emplace_back([&, this] {
        Swarm({endpoint_, first, end - first, a_.tcp ? a_.nodes : 1,
               keys_ ? keys_->nodes : std::vector<PeerKeys>(), a_.slots},
              shared_)
            .Serve();
      });
    }
  }

  coordinator::Client& Client() {
    if (!client_) {
      coordinator::ClientOptions options{.endpoint = endpoint_, .security = {}, .timeout_s = 60};
      if (keys_) options.security = keys_->client;
      client_.emplace(coordinator::Client::Connect(options).value());
    }
    return *client_;
  }

  void Join() {
    const double began_s = Now_s();
    while (true) {
      const auto list = Client().List();
      if (list.ok() && list.value().workers >= static_cast<unsigned>(a_.workers)) break;
      Sleep(0.05);
    }
    result_["workers"] = a_.workers;
    result_["wire"] = a_.tcp ? "tcp with keys" : "ipc";
    result_["join_s"] = Now_s() - began_s;
    result_["joins_per_s"] = a_.workers / (Now_s() - began_s);
    const Child::Used used = coordinator_->ProcessorSeconds();
    result_["join_us"] = Each(used, {}, a_.workers);
  }

  // Processor time of each of so many.
  static nlohmann::json Each(const Child::Used& now, const Child::Used& before, double count) {
    return {{"loop", (now.loop_s - before.loop_s) / count * 1e6},
            {"sockets", (now.sockets_s - before.sockets_s) / count * 1e6},
            {"others", (now.others_s - before.others_s) / count * 1e6}};
  }

  void Idle() {
    if (a_.idle_s <= 0) return;
    Sleep(1);
    const Child::Used before = coordinator_->ProcessorSeconds();
    const std::uint64_t heartbeats = shared_.sums().heartbeats;
    Sleep(a_.idle_s);
    result_["idle_heartbeats_per_s"] =
        static_cast<double>(shared_.sums().heartbeats - heartbeats) / a_.idle_s;
    result_["idle_cores"] = Each(coordinator_->ProcessorSeconds(), before, a_.idle_s * 1e6);
  }

  // Looks at the job now and then, and at the workers' silence.
  wire::JobInfo Await(const std::string& job, const std::function<bool(const wire::JobInfo&)>& enough) {
    for (int i = 1;; ++i) {
      const auto info = Client().Info(job);
      if (info.ok()) {
        CAIRN_DEMAND(info.value().state() != "failed" && info.value().state() != "paused",
                     info.value().reason());
        if (enough(info.value())) return info.value();
      }
      Sleep(0.1);
      if (i % 20 == 0 && info.ok())
        Say(std::to_string(info.value().tasks_done()) + " tasks are done, " +
            std::to_string(shared_.sums().assigned) + " assigned, " +
            std::to_string(shared_.sums().called_back) + " called back, " +
            std::to_string(shared_.sums().heartbeats) + " heartbeats");
      if (i % 10 != 0) continue;
      const auto fleet = Client().Fleet();
      if (!fleet.ok()) continue;
      for (const wire::WorkerInfo& worker : fleet.value().workers)
        longest_silence_s_ = std::max(longest_silence_s_, worker.silent_s());
    }
  }
  static bool IsDone(const wire::JobInfo& info) { return info.state() == "done"; }

  void CheckResult(const std::string& job, int tasks) {
    const auto results = Client().Results(job).value();
    if (results.at("empty")->Scalar<std::int64_t>("partials") != tasks)
      wrong_.push_back("partials are missing");
  }

  void Rate() {
    const Child::Used before = coordinator_->ProcessorSeconds();
    const std::uint64_t heartbeats = shared_.sums().heartbeats;
    const wire::JobInfo job =
        Client().Submit(MakeJob("rate", a_.tasks, a_.rounds, 0), std::map<std::string, BlobPtr>{}).value();
    const double began_s = Now_s();
    const wire::JobInfo done = Await(job.id(), IsDone);
    const double took_s = Now_s() - began_s;
    if (done.retries() > 0) wrong_.push_back(std::to_string(done.retries()) + " attempts failed");
    const int tasks = a_.tasks * a_.rounds;
    int again = 0, never = 0;
    for (int i = 0; i < tasks; ++i) {
      again += shared_.runs(static_cast<std::size_t>(i)) > 1;
      never += shared_.runs(static_cast<std::size_t>(i)) == 0;
    }
    if (never > 0) wrong_.push_back(std::to_string(never) + " tasks never ran");
    CheckResult(job.id(), a_.tasks);
    result_["tasks"] = tasks;
    result_["tasks_per_s"] = tasks / took_s;
    result_["task_us"] = Each(coordinator_->ProcessorSeconds(), before, tasks);
    result_["heartbeats_per_s_meanwhile"] =
        static_cast<double>(shared_.sums().heartbeats - heartbeats) / took_s;
    result_["called_back"] = shared_.sums().called_back.load();
    result_["moved"] = again;  // to who was idle, when they had been answered already
  }

  int BackInEpoch(int epoch) const {
    int back = 0;
    for (int i = 0; i < a_.workers; ++i) back += shared_.given_in(static_cast<std::size_t>(i)) == epoch;
    return back;
  }

  void Recover() {
    const int tasks = std::min(a_.workers * a_.tasks_a_worker, 200'000);
    const wire::JobInfo job =
        Client().Submit(MakeJob("kill", tasks, 2, a_.task_ms), std::map<std::string, BlobPtr>{}).value();
    Await(job.id(), [&](const wire::JobInfo& info) {
      return info.tasks_done() >= static_cast<unsigned>(2 * a_.workers);
    });
    peak_mib_ = coordinator_->PeakMib();
    Say("the coordinator is killed");
    coordinator_->Kill();
    const std::int64_t killed_ns = NowNs();
    shared_.sums().epoch = 2;
    Sleep(a_.restart_ms * 1e-3);
    StartCoordinator();
    client_.reset();
    const double limit_s = Now_s() + 120;
    while (BackInEpoch(2) < a_.workers && Now_s() < limit_s) Sleep(0.01);
    Say(std::to_string(BackInEpoch(2)) + " are back at work");
    std::vector<double> back_s;
    for (int i = 0; i < a_.workers; ++i)
      if (const auto n = static_cast<std::size_t>(i); shared_.given_in(n) == 2)
        back_s.push_back(static_cast<double>(shared_.given_ns(n) - killed_ns) * 1e-9);
    std::sort(back_s.begin(), back_s.end());
    if (back_s.size() < static_cast<std::size_t>(a_.workers))
      wrong_.push_back(std::to_string(static_cast<std::size_t>(a_.workers) - back_s.size()) +
                       " workers did not come back");
    if (!back_s.empty())
      result_["back_s"] = {{"first", back_s.front()},
                           {"half", back_s[back_s.size() / 2]},
                           {"99%", back_s[back_s.size() * 99 / 100]},
                           {"last", back_s.back()},
                           {"workers", back_s.size()}};
    Await(job.id(), IsDone);
    CheckResult(job.id(), tasks);
  }

  // Workers that the coordinator took for lost, as it says. (After it was killed it knows none.)
  int Lost() const {
    int lost = 0;
    std::ifstream log(Log());
    for (std::string line; std::getline(log, line);)
      lost += line.find("was not heard of") != std::string::npos ||
              line.find("lost its connection") != std::string::npos;
    return lost;
  }

  void Facts() {
    const int lost = Lost();
    if (lost > 0) wrong_.push_back(std::to_string(lost) + " workers were taken for lost");
    result_["lost_workers"] = lost;
    result_["longest_silence_s"] = longest_silence_s_;
    result_["coordinator_peak_mib"] = std::max(peak_mib_, coordinator_->PeakMib());
    result_["connections_made"] = shared_.sums().connections.load();
    result_["connections_broken"] = shared_.sums().broken.load();
    result_["longest_turn_of_swarm_s"] = static_cast<double>(shared_.sums().longest_turn_ns) * 1e-9;
    result_["wrong"] = wrong_;
  }

  const Arguments a_;
  const double began_s_ = Now_s();
  const wire::PrivateFolder folder_;
  const Shared shared_;
  const std::string endpoint_;
  std::optional<Keys> keys_;
  std::optional<Child> coordinator_;
  std::list<Child> swarms_;
  std::optional<coordinator::Client> client_;
  nlohmann::ordered_json result_;
  std::vector<std::string> wrong_;
  double longest_silence_s_ = 0, peak_mib_ = 0;
};

void RaiseFileLimit() {
  rlimit files{};
  ::getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = files.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &files);
}

}  // namespace
}  // namespace cairn::swarm

int main(int argc, char** argv) {
  cairn::swarm::Arguments a;
  CLI::App app("How many workers one coordinator serves");
  app.add_option("--workers", a.workers, "connections")->check(CLI::Range(1, 200'000))->capture_default_str();
  app.add_option("--processes", a.processes, "that the workers are in (one for each 5,000)");
  app.add_option("--slots", a.slots, "tasks in flight to a worker")->capture_default_str();
  app.add_option("--tasks", a.tasks, "of a round")->check(CLI::Range(1, 10'000'000))->capture_default_str();
  app.add_option("--rounds", a.rounds)->check(CLI::Range(1, 100'000))->capture_default_str();
  app.add_option("--idle-s", a.idle_s, "before the job")->capture_default_str();
  app.add_flag("--tcp", a.tcp, "over TCP, with keys, from so many addresses (without: ipc, without keys)");
  app.add_option("--nodes", a.nodes, "addresses, each with a key")
      ->check(CLI::Range(2, 10'000))
      ->capture_default_str();
  app.add_flag("--kill", a.kill, "then a second job, in which the coordinator is killed and started again");
  app.add_option("--task-ms", a.task_ms, "that a task of the second job takes")->capture_default_str();
  app.add_option("--tasks-a-worker", a.tasks_a_worker,
                 "of a round of the second job; a round has at most 200,000")
      ->capture_default_str();
  app.add_option("--restart-ms", a.restart_ms, "until it is started again")->capture_default_str();
  app.add_option("--program", a.program, "whose coordinator it is")->capture_default_str();
  app.add_option("--store", a.store, "the coordinator's folder (one in the folder for temporary files)");
  app.add_flag("--check", a.check, "exit code 1 where anything is wrong");
  CLI11_PARSE(app, argc, argv);
  if (::sodium_init() < 0) return 2;
  cairn::FixNumericsOfProcess();
  cairn::FixNumericsOfThread();
  cairn::swarm::RaiseFileLimit();
  return cairn::swarm::Bench(a).Run();
}
