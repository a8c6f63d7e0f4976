// cairn-sim: runs the coordinator's core in simulated worlds, one a seed, and says which seeds break it.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <sstream>
#include <string>

#include "schema/command_line/command.h"
#include "tests/simulation/scale_world.h"
#include "tests/simulation/size_world.h"
#include "tests/simulation/world.h"

namespace {

using cairn::simulation::Coverage;

// What to say where a demand of the core's aborts the process.
std::string abort_text;  // NOLINT: a signal handler has nothing else

void SayAbort(int) {
  const ssize_t ignored = ::write(STDOUT_FILENO, abort_text.data(), abort_text.size());
  static_cast<void>(ignored);
  ::_exit(1);
}

std::string Verdict(const std::string& program, std::uint64_t seed, const std::string& violation) {
  return "seed " + std::to_string(seed) + ": " + violation + "\n  replay: " + program + " --first " +
         std::to_string(seed) + " --seeds 1 --trace\n";
}

// Worlds of the scaler's. How many failed.
std::uint64_t RunScaleWorlds(const std::string& program, std::uint64_t first, std::uint64_t seeds,
                             double days, bool stop, const cairn::simulation::Trace& trace) {
  cairn::simulation::ScaleOutcome sum;
  std::uint64_t worlds = 0, failed = 0;
  for (; worlds < seeds && !(stop && failed > 0); ++worlds) {
    const std::uint64_t seed = first + worlds;
    const cairn::simulation::ScaleOutcome outcome = cairn::simulation::ScaleWorld(seed, trace).Run(days);
    for (const auto part :
         {&cairn::simulation::ScaleOutcome::turns, &cairn::simulation::ScaleOutcome::started,
          &cairn::simulation::ScaleOutcome::drained, &cairn::simulation::ScaleOutcome::lost,
          &cairn::simulation::ScaleOutcome::troubles})
      sum.*part += outcome.*part;
    if (outcome.violation.empty()) continue;
    ++failed;
    const std::string replay = program + " --scale-days " + std::to_string(days);
    std::fputs(Verdict(replay, seed, outcome.violation).c_str(), stdout);
  }
  std::printf(
      "%llu worlds of %g days, %llu failed; %llu turns, %llu workers started, %llu let go, %llu lost, "
      "%llu troubles\n",
      static_cast<unsigned long long>(worlds), days, static_cast<unsigned long long>(failed),
      static_cast<unsigned long long>(sum.turns), static_cast<unsigned long long>(sum.started),
      static_cast<unsigned long long>(sum.drained), static_cast<unsigned long long>(sum.lost),
      static_cast<unsigned long long>(sum.troubles));
  return failed;
}

void RunSizeWorld(const cairn::simulation::SizeOptions& options) {
  const cairn::simulation::SizeOutcome o = cairn::simulation::SizeWorld(options).Run();
  std::printf(
      "%u of %u workers joined; tasks of %g s: %.0f tasks/s, workers busy %.2f\n"
      "  event loop %.2f of a core (the core of the coordinator %.2f), sockets %.2f; longest from tick to "
      "tick "
      "%.2f s, longest silence %.2f s, %llu taken for lost\n",
      o.joined, options.workers, options.task_s, o.tasks_per_s, o.busy, o.loop, o.core, o.sockets,
      o.longest_tick_s, o.longest_silence_s, static_cast<unsigned long long>(o.lost));
  constexpr std::array<const char*, cairn::simulation::kCauses> kCauseTexts = {"joins", "heartbeats", "tasks",
                                                                               "ticks"};
  for (std::size_t k = 0; k < kCauseTexts.size(); ++k)
    std::printf("  for %s: event loop %.3f, sockets %.3f\n", kCauseTexts[k], o.a_second[k].loop_s,
                o.a_second[k].sockets_s);
  std::printf("  killed: %u back at work", o.back);
  if (o.back_s >= 0) std::printf(", all of them after %.1f s", o.back_s);
  std::printf("; %llu times one was told to try later\n", static_cast<unsigned long long>(o.turned_away));
}

// The figures of RunSizeWorld, and what docs/scale.md has measured of them.
void AddSizeOptions(CLI::App& app, cairn::simulation::SizeOptions& size) {
  app.add_option(
         "--workers", size.workers,
         "instead, a fleet of this size at one coordinator: what its threads take, and how soon all are "
         "back when it is killed")
      ->check(CLI::Range(1u, 1'000'000u));
  app.add_option("--task-s", size.task_s, "with --workers: what a task takes")->capture_default_str();
  app.add_option("--join-s", size.join_s, "with --workers: over how long they come")->capture_default_str();
  app.add_option("--jobs", size.jobs, "with --workers: side by side")
      ->check(CLI::Range(1u, 1000u))
      ->capture_default_str();
  app.add_option("--seconds", size.seconds, "with --workers: before it is killed, and after")
      ->capture_default_str();
  app.add_option("--message-us", size.message_us, "with --workers: of the event loop, for a message")
      ->capture_default_str();
  app.add_option("--socket-us", size.socket_us, "with --workers: of ZeroMQ's thread, for a message")
      ->capture_default_str();
  app.add_option("--join-us", size.join_us, "with --workers: of ZeroMQ's thread, for a connection")
      ->capture_default_str();
}

void PrintStats(const Coverage& sum) {
  for (std::size_t mark = 0; mark < cairn::simulation::kMarks; ++mark)
    std::printf("%12llu  %s\n", static_cast<unsigned long long>(sum[mark]),
                cairn::simulation::kMarkTexts[mark]);
}

// A full disk may show only when the last bytes are written.
int ExitCode(int code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  std::fputs("cairn-sim: cannot write to the standard output\n", stderr);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t seeds = 1000, first = 1;
  double scale_days = 0;
  cairn::simulation::SizeOptions size;
  size.workers = 0;
  bool traced = false, stats = false, stop = false;
  CLI::App app{
      "Runs Cairn's coordinator in simulated worlds, one a seed: workers and the coordinator crash, hang "
      "and\n"
      "lie, messages are lost, doubled, late and reordered, disks are full or forget, clocks jump, users "
      "cancel.\n"
      "Every job must end as if undisturbed.\n"
      "Example: cairn-sim --seeds 10000\n"
      "A seed that fails prints what is wrong and the command that replays it, event for event.\n"
      "Exit code: 0 all is well, 1 a seed failed, 2 bad usage."};
  app.add_option("--seeds", seeds, "how many worlds")->capture_default_str();
  app.add_option("--first", first, "the first seed")->capture_default_str();
  app.add_flag("--trace", traced, "print every event (>) and action (<), with the simulated time in seconds");
  app.add_flag("--stats", stats, "print how often each fault and each transition came up");
  app.add_option("--scale-days", scale_days,
                 "instead, so many days of each world in which workers are started and let go (cairn scale)");
  AddSizeOptions(app, size);
  app.add_flag("--stop", stop, "end at the first seed that fails");
  try {
    cairn::cli::Parse(app, argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream help;
    if (app.exit(error, help) != 0) return 2;
    std::fputs(help.str().c_str(), stdout);
    return ExitCode(0);
  }
  if (seeds == 0 || seeds - 1 > std::numeric_limits<std::uint64_t>::max() - first) {
    std::fputs("cairn-sim: --seeds is at least 1, and the last seed at most 18446744073709551615\n", stderr);
    return 2;
  }
  std::signal(SIGABRT, SayAbort);

  cairn::simulation::Trace trace;
  if (traced)
    trace = [](double now_s, const std::string& line) { std::printf("%10.4f  %s\n", now_s, line.c_str()); };
  if (size.workers > 0) {
    RunSizeWorld(size);
    return ExitCode(0);
  }
  if (scale_days > 0)
    return ExitCode(RunScaleWorlds(argv[0], first, seeds, scale_days, stop, trace) == 0 ? 0 : 1);
  std::uint64_t worlds = 0, failed = 0, events = 0;
  double simulated_s = 0;
  Coverage sum{};
  for (; worlds < seeds && !(stop && failed > 0); ++worlds) {
    const std::uint64_t seed = first + worlds;
    abort_text = Verdict(argv[0], seed, "aborted, for the reason above");
    if (traced) std::setvbuf(stdout, nullptr, _IOLBF, 0);
    const cairn::simulation::Outcome outcome = cairn::simulation::World(seed, trace).Run();
    events += outcome.events;
    simulated_s += outcome.simulated_s;
    for (std::size_t mark = 0; mark < sum.size(); ++mark) sum[mark] += outcome.coverage[mark];
    if (outcome.violation.empty()) continue;
    ++failed;
    std::fputs(Verdict(argv[0], seed, outcome.violation).c_str(), stdout);
    std::fflush(stdout);
  }
  if (stats) PrintStats(sum);
  std::printf("%llu worlds, %llu failed; %llu events, %.1f simulated hours\n",
              static_cast<unsigned long long>(worlds), static_cast<unsigned long long>(failed),
              static_cast<unsigned long long>(events), simulated_s / 3600);
  return ExitCode(failed == 0 ? 0 : 1);
}
