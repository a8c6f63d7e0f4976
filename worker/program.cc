#include "worker/program.h"

#include <malloc.h>
#include <signal.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "schema/build_info.h"
#include "schema/command_line/command.h"
#include "schema/command_line/renamed.h"
#include "schema/numerics.h"
#include "schema/process_limits.h"
#include "schema/text.h"
#include "schema/wire/keys.h"
#include "schema/wire/shared_blobs.h"
#include "worker/describe.h"
#include "worker/worker.h"
#include "worker/zmq_transport.h"

namespace cairn::worker {
namespace {

struct Arguments {
  std::string connect;
  std::string name;
  int slots = 4;
  std::size_t cache_mb = 512;
  std::string shared_path;
  std::uint64_t task_memory_mb = 0;
  double drain_s = 0;
  std::string key_file;
  std::string server_key_file;
  bool log_json = false;
  bool die_with_parent = false;
  int inputs_fd = -1;
  bool describe = false;
};

std::atomic<bool> g_stop{false}, g_drain{false}, g_may_drain{false};
std::atomic<Transport*> g_transport{nullptr};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch nothing else");

// SIGTERM drains where there is time for it; else, and at the next signal, it ends with a Leave; the signal
// after that ends the process at once.
void OnSignal(int number) {
  const bool drains = number == SIGTERM && g_may_drain && !g_stop && !g_drain.exchange(true);
  if (!drains && g_stop.exchange(true)) {
    ::signal(number, SIG_DFL);
    ::raise(number);
  }
  if (Transport* transport = g_transport) transport->Wake();
}

void CatchSignals() {
  struct sigaction action{};
  action.sa_handler = OnSignal;
  for (const int number : {SIGINT, SIGTERM}) ::sigaction(number, &action, nullptr);
  ::signal(SIGPIPE, SIG_IGN);  // who read its log may go; it stays
}

void Declare(cli::Command app, Arguments& a) {
  app.Footer(
      "Example:\n  cairn-worker --connect tcp://hub:7000 --key desk.key --server-key hub.pub "
      "--task-memory-mb "
      "2000\n\nExit codes: 0 ended on request, 1 no coordinator, 2 refused or bad usage");
  app.Add("--connect", a.connect, "endpoint of the coordinator: ipc:///FOLDER/NAME or tcp://HOST:PORT");
  app.Add("--name", a.name, "what to call it in the coordinator's lists");
  app.Add("--slots", a.slots, "tasks that may be assigned at a time").Within(1, 1000).ShowDefault();
  app.Add("--cache-mb", a.cache_mb, "memory for blobs that may be needed again").ShowDefault();
  app.Add(
      "--shared-path", a.shared_path,
      "folder with inputs that need not be fetched: the coordinator's STORE/blobs, or a copy of it, as this "
      "machine sees it; what is not there, or not what its hash says, is fetched");
  app.Add("--task-memory-mb", a.task_memory_mb,
          "memory that a task may take beside its inputs; a job's own limit counts where it is lower "
          "(0: no limit of this worker's)")
      .Within(std::uint64_t{0}, std::uint64_t{1'000'000'000})
      .ShowDefault();
  app.Add("--drain-s", a.drain_s,
          "on SIGTERM finish the task that runs, for at most so many seconds; a second signal does not "
          "wait")
      .Within(0.0, 1e6)
      .ShowDefault();
  app.Add("--key", a.key_file, "this worker's key pair (tcp)");
  app.Add("--server-key", a.server_key_file, "the coordinator's public key (tcp)");
  app.AddTaking<std::string>(
         "--log-format", [&a](const std::string& format) { a.log_json = format == "json"; },
         "of the log on stderr: text, or json, an object a line")
      .OneOf({"text", "json"});
  app.AddFlag("--die-with-parent", a.die_with_parent, "end with the process that started this one");
  app.Add("--inputs-fd", a.inputs_fd,
          "descriptor of memory with the run's inputs, which the process that started this one shares "
          "with it; else they are fetched");
  app.AddFlag("--describe", a.describe, "print all pipelines with their inputs and options as JSON, and end");
}

std::string JsonLine(Severity severity, const std::string& line) {
  constexpr std::array<const char*, 3> kNames = {"info", "warning", "error"};
  return nlohmann::json{{"level", kNames[static_cast<std::size_t>(severity)]},
                        {"pid", ::getpid()},
                        {"program", "cairn-worker"},
                        {"message", line}}
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

LogSink MakeLog(bool json) {
  spdlog::set_default_logger(spdlog::stderr_logger_mt("cairn-worker"));
  if (json) {
    spdlog::set_pattern(R"({"time":"%Y-%m-%dT%T.%e%z",%v)");
    return [](Severity severity, const std::string& line) {
      spdlog::info("{}", JsonLine(severity, line).substr(1));  // the pattern has opened the brace
    };
  }
  spdlog::set_pattern("%H:%M:%S worker %P %^%l%$: %v");
  return [](Severity severity, const std::string& line) {
    constexpr std::array kLevels = {spdlog::level::info, spdlog::level::warn, spdlog::level::err};
    spdlog::log(kLevels[static_cast<std::size_t>(severity)], "{}", Escaped(line));
  };
}

Result<std::optional<wire::ClientSecurity>> ReadSecurity(const Arguments& a) {
  std::optional<wire::ClientSecurity> none;
  if (a.key_file.empty() && a.server_key_file.empty()) return none;
  Result<wire::KeyPair> keys = wire::ReadKeyPair(a.key_file);
  if (!keys.ok()) return keys.status();
  Result<std::string> server = wire::ReadPublicKey(a.server_key_file);
  if (!server.ok()) return server.status();
  return std::optional(wire::ClientSecurity{std::move(keys).value(), std::move(server).value()});
}

// Never 0. A process id is no such name: in a container each process may have the same.
std::uint64_t DrawProcess() {
  std::random_device device;
  return (static_cast<std::uint64_t>(device()) << 32 | device()) | 1;
}

void AddVitals(wire::Heartbeat* heartbeat) {
  double load = 0;
  if (::getloadavg(&load, 1) == 1) heartbeat->set_load(load);
  std::ifstream pages("/proc/self/statm");
  std::uint64_t all = 0, resident = 0;
  if (pages >> all >> resident)
    heartbeat->set_memory_bytes(resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)));
}

WorkerOptions MakeOptions(const Arguments& a) {
  FixNumericsOfThread();
  WorkerOptions options;
  wire::Hello& hello = options.session.hello;
  hello.set_protocol(wire::kProtocol);
  *hello.mutable_build() = ThisBuild();
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  hello.set_host(host.data());
  hello.set_pid(::getpid());
  hello.set_name(a.name);
  hello.set_slots(static_cast<std::uint32_t>(a.slots));
  hello.set_process(DrawProcess());
  options.task_memory_mb = a.task_memory_mb;
  options.shared_path = a.shared_path;
  options.drain = &g_drain;
  options.drain_s = a.drain_s;
  options.session.cache_bytes = a.cache_mb << 20;
  options.session.add_vitals = AddVitals;
  options.session.exit_on_leave = a.die_with_parent;
  // A private worker whose parent died before PR_SET_PDEATHSIG took hold finds nobody.
  options.session.first_contact_s = a.die_with_parent ? 30 : 0;
  return options;
}

// What cannot be had that way can be fetched.
void TakeInputs(int fd, SessionOptions& session) {
  if (fd < 0) return;
  Result<std::vector<wire::NamedBlob>> inputs = wire::TakeSharedBlobs(fd);
  if (!inputs.ok()) return session.log(Severity::kWarning, inputs.status().message());
  session.given = std::move(inputs).value();
  session.log(Severity::kInfo, "reads " + std::to_string(session.given.size()) +
                                   " inputs from memory that it shares with its parent");
}

int Run(const Arguments& a, const PipelineFactory& factory) {
  WorkerOptions options = MakeOptions(a);
  options.session.log = MakeLog(a.log_json);
  TakeInputs(a.inputs_fd, options.session);
  const auto fail = [&](const Status& status) {
    options.session.log(Severity::kError, status.message());
    return kExitRefused;
  };
  const auto security = ReadSecurity(a);
  if (!security.ok()) return fail(security.status());
  const Result<std::unique_ptr<ZmqTransport>> transport = ZmqTransport::Connect(a.connect, security.value());
  if (!transport.ok()) return fail(transport.status());
  g_transport = transport.value().get();
  g_may_drain = a.drain_s > 0;
  CatchSignals();
  ServiceManager manager;
  options.manager = &manager;
  manager.Ready();  // whether there is a coordinator is for the log to say: it waits for one
  const int code = RunWorker(*transport.value(), factory, options, g_stop);
  manager.Stopping();
  g_transport = nullptr;
  return code;
}

// A full disk may show only when the last bytes are written.
int Print(const std::string& text) {
  if (std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0) return kExitDone;
  std::fputs("cairn-worker: cannot write to the standard output\n", stderr);
  return kExitLost;
}

// Belief tables come and go by the hundred. By default the C library gives the larger ones back to the system
// each time, which takes them in again page by page: a twentieth of a search's time.
void KeepMemory() {
#ifdef __GLIBC__
  constexpr int kBytes = 64 << 20;
  ::mallopt(M_MMAP_THRESHOLD, kBytes);
  ::mallopt(M_TRIM_THRESHOLD, kBytes);
#endif
}

}  // namespace

int WorkerProgram(int argc, char** argv, const std::vector<PipelineInfo>& pipelines,
                  const PipelineFactory& factory) {
  FixNumericsOfProcess();
  KeepMemory();
  Arguments arguments;
  CLI::App app("Computes tasks for a Cairn coordinator", "cairn-worker");
  app.set_version_flag("--version", CAIRN_VERSION);
  Declare(cli::Command(&app), arguments);
  try {
    std::vector<char*> words(argv, argv + argc);
    const std::vector<std::string> now = cli::ArgumentsNow(&words);
    cli::Parse(app, argc, words.data());
  } catch (const CLI::ParseError& error) {
    std::ostringstream help;
    if (app.exit(error, help) != 0) return kExitRefused;
    return Print(help.str());
  }
  if (arguments.describe) return Print(DescribePipelines(pipelines) + "\n");
  if (arguments.connect.empty()) {
    std::fputs("cairn-worker: --connect ENDPOINT is missing (see --help)\n", stderr);
    return kExitRefused;
  }
  if (const Status limits =
          PrepareProcess({.files = 32,
                          .file_bytes = 0,
                          .memory_bytes = 512 << 20,
                          .threads = 5 + static_cast<std::uint64_t>(std::max(0, arguments.slots))});
      !limits.ok()) {
    std::fprintf(stderr, "cairn-worker: %s\n", limits.message().c_str());
    return kExitRefused;
  }
  if (arguments.die_with_parent) ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  return Run(arguments, factory);
}

}  // namespace cairn::worker
