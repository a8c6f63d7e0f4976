#include "coordinator/page/program.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <sstream>
#include <thread>

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/home.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/programs.h"
#include "coordinator/cli/common/stop_signal.h"
#include "coordinator/http/listen.h"
#include "coordinator/page/html.h"
#include "coordinator/page/site.h"
#include "coordinator/page/watcher.h"
#include "schema/process_limits.h"
#include "schema/store/atomic_file.h"
#include "schema/store/regular_file.h"
#include "schema/text.h"
#include "schema/wire/keys.h"

namespace cairn::page {
namespace {

struct Arguments {
  std::string connect, key, server_key;
  std::string listen = "0", password_file, proxy;
  std::string run;  // the folder of the run that it is for
  std::uint64_t upload_mb = 4000;
  bool read_only = false, die_with_parent = false;
};

constexpr unsigned kConnections = 256, kStreams = Site::kMostStreams;

void Declare(cli::Command app, Arguments& a) {
  app.Footer(
      "It prints a link that works once. Who opened it stays signed in for a day after the last look.\n"
      "Exit codes: 0 ended on request, 1 the world failed, 2 bad usage\n"
      "Example:\n  cairn page\n  cairn page --connect tcp://hub:7000 --listen 8080\n  cairn page --listen "
      "0.0.0.0:8080 "
      "--password-file page.password");
  app.Add("--connect", a.connect, "endpoint of the coordinator: ipc:///FOLDER/NAME or tcp://HOST:PORT");
  app.Add("--key", a.key, "this page's key pair (tcp); whoever looks at the page has that key's rights");
  app.Add("--server-key", a.server_key, "the coordinator's public key (tcp)");
  app.Add("--listen", a.listen,
          "PORT on this machine alone (0: any that is free), or ADDRESS:PORT, which needs --password-file or "
          "--behind-proxy")
      .ShowDefault();
  app.Add("--password-file", a.password_file,
          "a file of yours alone (mode 0600) whose first line lets people in, beside the link");
  app.Add("--behind-proxy", a.proxy,
          "https://HOST, the address at which people reach it through a proxy, which has TLS");
  app.AddFlag("--read-only", a.read_only, "no buttons, and no commands, whatever the key may do");
  app.Add(
         "--upload-mb", a.upload_mb,
         "what files that people bring here to start jobs with may take together, on this machine’s disk; 0: "
         "no job is started from here")
      .Within(std::uint64_t{0}, std::uint64_t{100'000'000})
      .ShowDefault();
  app.Add("--run", a.run, "the folder of the run whose page this is (cairn run --page)");
  app.AddFlag("--die-with-parent", a.die_with_parent, "end with the process that started this one");
}

coordinator::ClientOptions ClientOf(const Arguments& a) {
  coordinator::ClientOptions options;
  options.endpoint = a.connect;
  options.timeout_s = 6;
  if (a.connect.starts_with("tcp://") || !a.key.empty() || !a.server_key.empty()) {
    if (a.key.empty() || a.server_key.empty()) throw InputError("TCP needs keys: say --key and --server-key");
    options.security = wire::ClientSecurity{cli::Take(wire::ReadKeyPair(a.key)),
                                            cli::Take(wire::ReadPublicKey(a.server_key))};
  }
  return options;
}

// As a secret key's: its owner's alone.
std::string ReadPassword(const std::string& path) {
  constexpr std::size_t kMostBytes = 1024, kLeast = 8;
  if (path.empty()) return "";
  struct stat facts{};
  std::string text = cli::Take(ReadSmallFile(path, kMostBytes));
  if (::stat(path.c_str(), &facts) != 0 || facts.st_uid != ::geteuid() || (facts.st_mode & 077) != 0)
    throw InputError("'" + path + "' must be yours, and nobody else may read or write it: chmod 600");
  text = text.substr(0, text.find_first_of("\r\n"));
  if (text.size() < kLeast) throw InputError("'" + path + "' has a password of less than 8 characters");
  return text;
}

void CheckAddress(const Arguments& a) {
  if (!a.proxy.empty()) {
    const std::size_t slashes = a.proxy.find("://");
    const bool scheme = a.proxy.starts_with("https://") || a.proxy.starts_with("http://");
    const std::string host = scheme ? a.proxy.substr(slashes + 3) : "";
    if (host.empty() ||
        host.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-:[]") !=
            std::string::npos)
      throw InputError("--behind-proxy takes https://HOST or https://HOST:PORT, with nothing behind it");
  }
  const bool loopback = coordinator::IsLoopback(coordinator::SplitAddress(a.listen).first);
  if (!loopback && a.password_file.empty() && a.proxy.empty())
    throw InputError(
        "'" + a.listen +
        "' can be reached from other machines: that needs --password-file, or --behind-proxy where "
        "another program listens there with TLS");
}

// The options that say which coordinator, for `cairn results` and the like, in whatever folder they run.
std::vector<std::string> ServiceWords(const Arguments& a) {
  const auto whole = [](const std::string& path) { return std::filesystem::absolute(path).string(); };
  const std::string ipc = "ipc://";
  std::vector<std::string> words = {
      "--connect=" + (a.connect.starts_with(ipc) ? ipc + whole(a.connect.substr(ipc.size())) : a.connect)};
  if (!a.key.empty())
    words.insert(words.end(), {"--key=" + whole(a.key), "--server-key=" + whole(a.server_key)});
  return words;
}

double Clock_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void SayLink(const std::string& link) {
  std::printf("open %s\n", link.c_str());
  std::fflush(stdout);
}

// A run that came to its end has left a report since then.
std::string HowItEnded(const std::string& run, std::filesystem::file_time_type began) {
  std::error_code error;
  const auto written = std::filesystem::last_write_time(std::filesystem::path(run) / "report.html", error);
  if (!error && written >= began)
    return "The run is over. What it left is in " + Escaped(run) + ", with its report.html.";
  return "The run was stopped, or has failed: where it was started it says why. The same command goes on "
         "with "
         "what is in " +
         Escaped(run) + ".";
}

// A port of any number is known only once it is listened at, so requests wait for the site until then.
int Serve(const Arguments& a) {
  const std::atomic<bool>& stop = cli::StopOnSignals();
  const auto began =
      std::filesystem::file_time_type::clock::now() - std::chrono::seconds(1);  // files' are coarser
  ::signal(SIGPIPE, SIG_IGN);  // who read the link may go; it stays
  const std::string password = ReadPassword(a.password_file);
  CheckAddress(a);
  const std::filesystem::path folder = std::filesystem::path(cli::HomeFolder()) / "page";
  const std::uint64_t most_bytes = a.read_only ? 0 : a.upload_mb * 1'000'000;
  std::optional<Desk> desk;  // outlives all that asks it
  if (most_bytes > 0)
    desk.emplace(DeskOptions{.program = cli::CairnProgram(),
                             .service = ServiceWords(a),
                             .folder = folder,
                             .most_bytes = most_bytes});
  std::atomic<coordinator::HttpServer*> woken = nullptr;
  std::shared_ptr<Site> site;
  std::atomic<bool> begun = false;
  const auto watcher = std::make_shared<Watcher>(
      WatcherOptions{
          .client = ClientOf(a),
          .unanswered = a.run.empty()
                            ? ""
                            : "The run does not answer: it is ending, or its machine is busy. This page "
                              "will say when it is over.",
          .results = {.program = cli::CairnProgram(), .service = ServiceWords(a), .folder = folder}},
      [&woken] {
        if (coordinator::HttpServer* server = woken) server->Wake();
      });
  const coordinator::HttpLimits limits{.connections = kConnections,
                                       .streams = kStreams,
                                       .silent_s = 30,
                                       .head_bytes = 32'768,
                                       .body_bytes = 65'536,
                                       .upload_bytes = 2 * most_bytes};
  std::unique_ptr<coordinator::HttpServer> server = cli::Take(coordinator::HttpServer::Listen(
      a.listen, "the page", limits,
      [&begun, &site](const coordinator::HttpRequest& request, const auto& reply) {
        if (begun) return site->Answer(request, reply);
        reply->Send({.code = 503, .body = "it begins\n"});
      },
      [&begun, &site](const coordinator::HttpRequest& request)
          -> std::variant<std::shared_ptr<coordinator::HttpUpload>, coordinator::HttpAnswer> {
        if (begun) return site->BeginUpload(request);
        return coordinator::HttpAnswer{.code = 503, .body = "it begins\n"};
      }));
  const std::string foot = "Jobs of the coordinator at " + Text(a.connect) +
                           (a.read_only ? ", to look at" : "") + ". Cairn " CAIRN_VERSION ".";
  site = std::make_shared<Site>(
      SiteOptions{.read_only = a.read_only, .foot = foot, .desk = desk ? &*desk : nullptr},
      Entrance({.address = server->address(), .proxy = a.proxy, .password = password}, SayLink), watcher,
      Clock_s);
  begun = true;
  woken = server.get();
  while (!stop) std::this_thread::sleep_for(std::chrono::milliseconds(50));

  site->End(a.run.empty() ? "“cairn page” was stopped. Start it again, and open its link, to look on."
                          : HowItEnded(a.run, began));
  server->Wake();
  constexpr double kFarewell_s = 10;  // for those who look on to hear it, however slow their machine
  const double end_s = Clock_s() + kFarewell_s;
  while ((server->streams() > 0 || site->AwaitsListeners()) && Clock_s() < end_s)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  woken = nullptr;
  server.reset();
  return cli::kExitDone;
}

int Complain(const std::string& problem, int code) {
  std::fprintf(stderr, "cairn-page: %s\n", problem.c_str());
  return code;
}

int Run(const Arguments& a) {
  try {
    if (a.connect.empty()) throw InputError("--connect ENDPOINT is missing (see --help)");
    cli::Check(PrepareProcess({.files = 64 + 2 * kConnections + kStreams, .threads = 8}));
    if (a.die_with_parent) ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    return Serve(a);
  } catch (const InputError& error) {
    return Complain(error.what(), cli::kExitBadInput);
  } catch (const std::exception& error) {
    return Complain(error.what(), cli::kExitFailed);
  }
}

}  // namespace

int PageProgram(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Pages to watch a coordinator's jobs with, and to command them, in a browser", "cairn-page");
  app.set_version_flag("--version", CAIRN_VERSION);
  Declare(cli::Command(&app), arguments);
  try {
    cli::Parse(app, argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream help, complaint;
    if (app.exit(error, help, complaint) != 0) return Complain(error.what(), cli::kExitBadInput);
    if (std::fputs(help.str().c_str(), stdout) >= 0 && std::fflush(stdout) == 0) return cli::kExitDone;
    return Complain("cannot write to the standard output",
                    cli::kExitFailed);  // a full disk may show only now
  }
  return Run(arguments);
}

}  // namespace cairn::page
