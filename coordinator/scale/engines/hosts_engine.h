// Workers on hosts that have a shell, this one or others over ssh. A folder on each host holds what is known
// of its workers: NAME.pid with process and start time, NAME.exit once it has ended, NAME.log, NAME.key. So
// they live on when who started them has ended, and are found again.
//
// A host that does not answer is left alone for a while: its workers are what they were.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "coordinator/scale/engine.h"
#include "coordinator/scale/engines/hosts_file.h"
#include "coordinator/scale/engines/programs.h"
#include "coordinator/store/log.h"

namespace cairn::coordinator {

struct HostsOptions {
  std::vector<Host> hosts;
  // The words that run a shell there, which reads its script.
  std::function<std::vector<std::string>(const Host&)> shell;
  std::string folder;                // there, with one in it for each host; where it is relative, in the home
  std::string worker;                // the program there
  std::vector<std::string> options;  // that each worker gets: --connect ENDPOINT …
  std::string keys;                  // folder here, of NAME.key; empty: they need none
  std::string server_key;            // the coordinator's public one
  double limit_s = 10;               // for a host to answer
  double away_s = 5;                 // one that did not is left alone for so long, twice as long each time …
  double most_away_s = 300;          // … up to this
  LogSink log = [](Severity, const std::string&) {};
};

// Scripts that a POSIX shell reads, and what they print.
std::string StartScript(const HostsOptions& options, const Host& host,
                        const std::map<std::string, std::string>& keys);  // texts of key files, by name
std::string ListScript(const HostsOptions& options, const Host& host);
std::string StopScript(const HostsOptions& options, const Host& host, const std::vector<std::string>& names);
std::string ForgetScript(const HostsOptions& options, const Host& host,
                         const std::vector<std::string>& names);
std::vector<EngineWorker> ReadList(const std::string& printed, const std::string& host);

class HostsEngine : public Engine {
 public:
  explicit HostsEngine(HostsOptions options);
  // Fails where no host answers.
  Result<std::vector<EngineWorker>> List() override;
  Started Start(const std::vector<std::string>& names) override;
  Status Stop(const std::vector<std::string>& names) override;
  void Forget(const std::vector<std::string>& names) override;

 private:
  using Clock = std::chrono::steady_clock;
  struct Place {
    Host host;
    std::vector<EngineWorker> workers;  // as it last said
    Clock::time_point away_until{};
    int failures = 0;  // in a row
    std::string failure;
  };
  // Runs a script on each of these, side by side; false at those that failed.
  std::vector<bool> Run(const std::vector<Place*>& places, const std::vector<std::string>& scripts,
                        std::vector<std::string>* printed);
  void NoteFailure(Place& place, const std::string& why);
  std::map<Place*, std::vector<std::string>> WhereTheyAre(const std::vector<std::string>& names);

  const HostsOptions options_;
  std::vector<Place> places_;
};

}  // namespace cairn::coordinator
