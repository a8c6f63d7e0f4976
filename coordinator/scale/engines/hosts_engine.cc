#include "coordinator/scale/engines/hosts_engine.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <utility>

#include "schema/text.h"

namespace cairn::coordinator {
namespace {

// What is known of a worker's process: it, and when it began, for its number may come again.
constexpr const char* kTools = R"sh(
began() { cut -d ' ' -f 22 "/proc/$1/stat" 2>/dev/null; }
runs() { read -r pid start <"$1.pid" 2>/dev/null && [ -n "$start" ] && [ "$(began "$pid")" = "$start" ]; }
)sh";

// Without these nothing can be told of its workers.
constexpr const char* kNeeds = R"sh(
[ -r /proc/self/stat ] || { echo "it has no /proc" >&2; exit 1; }
command -v setsid >/dev/null || { echo "it has no setsid (util-linux)" >&2; exit 1; }
: >writable || exit 1
)sh";

// The shell that waits for a worker is told when the worker is to go, hands that on, and says how it ended. A
// signal is lost that comes before the worker's program is in the place of the shell's own, so it looks for
// that first. It is waited for until it does, or is gone: its number comes once it has set its trap.
constexpr const char* kBegin = R"sh(
begin() {
  rm -f "$1.exit"
  pid=$(setsid sh -c 'tell() {
      while cmp -s "/proc/$$/cmdline" "/proc/$worker/cmdline"; do sleep 0.01; done
      kill -s TERM "$worker"
    }
    trap "if [ -n \"\$worker\" ]; then tell; else told=1; fi" TERM INT
    echo $$
    exec >>"$0.log"
    "$@" & worker=$!
    [ -z "$told" ] || tell
    until wait "$worker"; code=$?; ! kill -0 "$worker" 2>/dev/null; do :; done
    echo "$code" >"$0.end"; mv "$0.end" "$0.exit"' \
    "$@" </dev/null 2>>"$1.log" &)
  echo "$pid $(began "$pid")" >"$1.pid"
}
)sh";

// A folder a host: hosts may have one home.
std::string EnterFolder(const HostsOptions& options, const Host& host) {
  const std::string folder = ShellWord(options.folder + "/" + host.name);
  return "umask 077\nmkdir -p -- " + folder + " && cd -- " + folder + " || exit 1\n" + kTools;
}

std::string WriteFile(const std::string& name, const std::string& text) {
  return "printf %s " + ShellWord(text) + " >" + ShellWord(name) + " || exit 1\n";
}

std::string Words(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += " " + ShellWord(word);
  return text;
}

std::string WhyEnded(const std::string& code, const std::string& last_line) {
  if (code == "0") return "";
  if (code.empty()) return "how could not be written there: is its disk full?";
  if (code == "lost") return "its process is gone; was the host started anew?";
  return (last_line.empty() ? "exit code " + code : Printable(last_line, 300) + " (exit code " + code + ")");
}

std::size_t Occupied(const std::vector<EngineWorker>& workers) {
  return static_cast<std::size_t>(std::ranges::count_if(
      workers, [](const EngineWorker& worker) { return worker.state != EngineWorker::State::kEnded; }));
}

}  // namespace

std::string StartScript(const HostsOptions& options, const Host& host,
                        const std::map<std::string, std::string>& keys) {
  std::string script = EnterFolder(options, host) + kBegin;
  if (!options.server_key.empty()) script += WriteFile("coordinator.pub", options.server_key + "\n");
  for (const auto& [name, key] : keys) {
    std::vector<std::string> words = {name, options.worker, "--name", name};
    words.insert(words.end(), options.options.begin(), options.options.end());
    if (host.memory_mb > 0)
      words.insert(words.end(),
                   {"--task-memory-mb", std::to_string(std::max<std::uint64_t>(
                                            1, host.memory_mb / static_cast<std::uint64_t>(host.cores)))});
    if (!key.empty()) {
      script += WriteFile(name + ".key", key);
      words.insert(words.end(), {"--key", name + ".key", "--server-key", "coordinator.pub"});
    }
    script += "begin" + Words(words) + "\n";
  }
  return script;
}

std::string ListScript(const HostsOptions& options, const Host& host) {
  return EnterFolder(options, host) + kNeeds + R"sh(for file in *.pid; do
  [ -e "$file" ] || continue
  name=${file%.pid}
  if runs "$name"; then echo "$name runs"
  elif [ -e "$name.exit" ]; then echo "$name ended $(cat "$name.exit") $(tail -n 1 "$name.log" | cut -c 1-500)"
  else echo "$name ended lost"; fi
done
echo listed
)sh";
}

std::string StopScript(const HostsOptions& options, const Host& host, const std::vector<std::string>& names) {
  return EnterFolder(options, host) + "for name in" + Words(names) + R"sh(; do
  if runs "$name"; then kill -s TERM "$pid"; fi
done
)sh";
}

std::string ForgetScript(const HostsOptions& options, const Host& host,
                         const std::vector<std::string>& names) {
  return EnterFolder(options, host) + "for name in" + Words(names) + R"sh(; do
  rm -f -- "$name.pid" "$name.exit" "$name.end" "$name.log" "$name.key"
done
)sh";
}

std::vector<EngineWorker> ReadList(const std::string& printed, const std::string& host) {
  std::vector<EngineWorker> workers;
  std::istringstream lines(printed);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    EngineWorker worker{.where = host};
    std::string state, code, said;
    if (!(words >> worker.name >> state)) continue;
    if (state == "ended") {
      worker.state = EngineWorker::State::kEnded;
      words >> code >> std::ws;
      std::getline(words, said);
      worker.why = WhyEnded(code, said);
    } else if (state != "runs") {
      continue;
    }
    workers.push_back(std::move(worker));
  }
  return workers;
}

HostsEngine::HostsEngine(HostsOptions options) : options_(std::move(options)) {
  for (const Host& host : options_.hosts) places_.push_back({host, {}, {}, 0, ""});
}

void HostsEngine::NoteFailure(Place& place, const std::string& why) {
  const double wait_s =
      std::min(options_.most_away_s, options_.away_s * std::exp2(std::min(place.failures, 30)));
  ++place.failures;
  place.away_until = Clock::now() + std::chrono::milliseconds(static_cast<std::int64_t>(wait_s * 1000));
  if (std::exchange(place.failure, why) != why)
    options_.log(Severity::kWarning, place.host.name + " is left alone for a while: " + why);
}

std::vector<bool> HostsEngine::Run(const std::vector<Place*>& places, const std::vector<std::string>& scripts,
                                   std::vector<std::string>* printed) {
  constexpr std::size_t kAtOnce = 64;  // each has pipes
  std::vector<ProgramOutput> outputs;
  for (std::size_t first = 0; first < places.size(); first += kAtOnce) {
    std::vector<Program> programs;
    for (std::size_t i = first; i < std::min(places.size(), first + kAtOnce); ++i)
      programs.push_back({options_.shell(places[i]->host), scripts[i]});
    for (ProgramOutput& output : RunPrograms(programs, options_.limit_s))
      outputs.push_back(std::move(output));
  }
  std::vector<bool> well;
  for (std::size_t i = 0; i < places.size(); ++i) {
    well.push_back(outputs[i].exit_code == 0);
    if (printed != nullptr) printed->push_back(std::move(outputs[i].out));
    if (!well.back())
      NoteFailure(*places[i], outputs[i].failure);
    else if (std::exchange(places[i]->failures, 0) > 0) {
      places[i]->failure.clear();
      options_.log(Severity::kInfo, places[i]->host.name + " answers again");
    }
  }
  return well;
}

Result<std::vector<EngineWorker>> HostsEngine::List() {
  std::vector<Place*> asked;
  for (Place& place : places_)
    if (Clock::now() >= place.away_until) asked.push_back(&place);
  std::vector<std::string> printed;
  std::vector<std::string> scripts;
  for (const Place* place : asked) scripts.push_back(ListScript(options_, place->host));
  const std::vector<bool> well = Run(asked, scripts, &printed);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    if (!well[i]) continue;
    if (printed[i].ends_with("listed\n"))
      asked[i]->workers = ReadList(printed[i], asked[i]->host.name);
    else
      NoteFailure(*asked[i], "its list of workers breaks off");
  }
  if (std::ranges::all_of(places_, [](const Place& place) { return place.failures > 0; }))
    return Status(Code::kIo,
                  places_.size() == 1 ? places_[0].failure : "no host answers; " + places_[0].failure);
  std::vector<EngineWorker> all;
  for (const Place& place : places_) all.insert(all.end(), place.workers.begin(), place.workers.end());
  return all;
}

// Spread over the hosts: each next one to where most places are free.
Engine::Started HostsEngine::Start(const std::vector<std::string>& names) {
  Started started;
  std::map<Place*, std::map<std::string, std::string>> shares;
  for (const std::string& name : names) {
    const auto free = [&](const Place& place) {
      const auto share = shares.find(const_cast<Place*>(&place));
      const std::size_t taken = Occupied(place.workers) + (share == shares.end() ? 0 : share->second.size());
      return place.failures > 0
                 ? 0
                 : static_cast<std::ptrdiff_t>(place.host.cores) - static_cast<std::ptrdiff_t>(taken);
    };
    const auto best = std::ranges::max_element(places_, {}, free);
    if (free(*best) <= 0) {
      started.status = {Code::kNoSpace, "no host has room for more workers"};
      break;
    }
    std::string key;
    if (!options_.keys.empty()) {
      std::ostringstream text;
      text << std::ifstream(options_.keys + "/" + name + ".key").rdbuf();
      key = text.str();
    }
    shares[&*best][name] = key;
  }
  std::vector<Place*> places;
  std::vector<std::string> scripts;
  for (const auto& [place, keys] : shares) {
    places.push_back(place);
    scripts.push_back(StartScript(options_, place->host, keys));
  }
  const std::vector<bool> well = Run(places, scripts, nullptr);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!well[i]) {
      started.status = {Code::kIo, places[i]->host.name + ": " + places[i]->failure};
      continue;
    }
    for (const auto& [name, key] : shares[places[i]]) {
      places[i]->workers.push_back({.name = name, .where = places[i]->host.name});
      started.names.push_back(name);
    }
  }
  return started;
}

std::map<HostsEngine::Place*, std::vector<std::string>> HostsEngine::WhereTheyAre(
    const std::vector<std::string>& names) {
  const std::set<std::string> wanted(names.begin(), names.end());
  std::map<Place*, std::vector<std::string>> found;
  for (Place& place : places_)
    for (const EngineWorker& worker : place.workers)
      if (wanted.contains(worker.name)) found[&place].push_back(worker.name);
  return found;
}

Status HostsEngine::Stop(const std::vector<std::string>& names) {
  for (const auto& [place, there] : WhereTheyAre(names))
    if (!Run({place}, {StopScript(options_, place->host, there)}, nullptr)[0])
      return {Code::kIo, place->host.name + ": " + place->failure};
  return Status::Ok();
}

void HostsEngine::Forget(const std::vector<std::string>& names) {
  std::vector<Place*> places;
  std::vector<std::string> scripts;
  for (const auto& [place, there] : WhereTheyAre(names)) {
    places.push_back(place);
    scripts.push_back(ForgetScript(options_, place->host, there));
    const std::set<std::string> gone(there.begin(), there.end());
    std::erase_if(place->workers, [&](const EngineWorker& worker) { return gone.contains(worker.name); });
  }
  Run(places, scripts, nullptr);
}

}  // namespace cairn::coordinator
