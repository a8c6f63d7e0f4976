// chaos [--seconds N] [--every S] [--seed N] [--workers N] [--jobs N]: see chaos.h. Exit code 0: all jobs
// gave the undisturbed bits; 1: the problem, and where the logs are.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "tests/faults/chaos.h"

namespace {

void Print(const cairn::faults::ChaosReport& report) {
  for (const auto& [fault, count] : report.faults) std::printf("%5d x %s\n", count, fault.c_str());
  int jobs = 0;
  for (const auto& [name, count] : report.done) {
    std::printf("%5d jobs of %s: the undisturbed bits\n", count, name.c_str());
    jobs += count;
  }
  std::printf("%5d jobs in all, the longest took %.1f s; %d submitted again; coordinator at most %.0f MB\n",
              jobs, report.longest_job_s, report.submitted_again,
              static_cast<double>(report.coordinator_most_kb) / 1024);
}

}  // namespace

int main(int argc, char** argv) {
  cairn::faults::ChaosOptions options;
  CLI::App app("Hurts a service's processes while jobs go through", "chaos");
  app.add_option("--seconds", options.seconds)->capture_default_str();
  app.add_option("--every", options.every_s, "seconds from fault to fault, on average")
      ->capture_default_str();
  app.add_option("--seed", options.seed)->capture_default_str();
  app.add_option("--workers", options.workers)->capture_default_str()->check(CLI::Range(1, 64));
  app.add_option("--jobs", options.jobs, "under way at a time")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  ::setenv("CAIRN_TASK_MS", "20", 0);
  std::string folder = (std::filesystem::temp_directory_path() / "cairn-chaos-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return std::perror("chaos"), 1;
  const cairn::faults::ChaosReport report = cairn::faults::RunChaos(options, folder);
  Print(report);
  if (!report.problem.empty())
    return std::fprintf(stderr, "%s\n(see %s)\n", report.problem.c_str(), folder.c_str()), 1;
  std::filesystem::remove_all(folder);
  return report.done.empty() || report.faults.empty();  // it must have looked at something
}
