// What each trick of [TBF98] section 5 does to landmark_map's time, memory and result: paper difficulty, one
// start, every seed's log as one slice. Prints a Markdown table.
//   tricks [FIRST LAST] [key=value …]      # seeds, 101 120; options for every row
// Processor time is of the job alone. Each row is a process of its own, whose largest resident set is the
// memory.
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "datasets/evaluate/evaluate.h"
#include "datasets/simulate/loop.h"
#include "pipelines/common/motion.h"
#include "pipelines/registry.h"
#include "pipelines/testing/in_process.h"
#include "tests/bench/bench_main.h"
#include "tests/bench/stage_option.h"

namespace cairn {
namespace {

using Options = std::vector<std::string>;

struct Row {
  const char* what;
  Options options;
};

// Rows of one grid; the first is what the others are compared with.
struct Table {
  const char* title;
  Options options;
  std::vector<Row> rows;
};

std::vector<Table> Tables() {
  const Row kept{"caching: kernels kept for the backward pass", {"keep_kernels=true"}};
  const auto boxed = [](const std::string& box) -> Row {
    return {"beliefs cut to box_m, for the rows below", {box}};
  };
  const auto whole = [](const std::string& box) -> Row {
    return {"no selective memorization", {box, "tables=whole"}};
  };
  const auto all_cells = [](const std::string& box) -> Row {
    return {"no selective computation", {box, "prune=0"}};
  };
  const auto neither = [](const std::string& box) -> Row {
    return {"neither", {box, "prune=0", "tables=whole"}};
  };
  const auto pruned = [](const char* least) -> Row {
    return {"selective computation", {std::string("prune=") + least}};
  };
  const auto increments = [](const char* what, const char* most_m) -> Row {
    return {what, {std::string("max_increment_m=") + most_m}};
  };
  const Row micro = increments("no coarse-grained time: a step a metre", "1");
  const Row paper_increments = increments("coarse-grained time as in the paper", "20");
  return {{"1 m, 5°, motion increments to 11 m",
           {"cell_m=1", "heading_deg=5"},
           {{"as by default", {}},
            kept,
            micro,
            increments("coarse-grained time", "4"),
            paper_increments,
            pruned("1e-2"),
            pruned("1e-5"),
            boxed("box_m=130"),
            whole("box_m=130"),
            all_cells("box_m=130")}},
          {"2 m, 10°, motion increments to 11 m",
           {"cell_m=2", "heading_deg=10"},
           {{"as by default", {}},
            boxed("box_m=180"),
            whole("box_m=180"),
            all_cells("box_m=180"),
            neither("box_m=180")}},
          {"0.5 m, 2.5°, motion increments to 11 m",
           {"cell_m=0.5", "heading_deg=2.5"},
           {{"as by default", {}}, kept, micro, paper_increments, pruned("1e-2"), pruned("1e-5")}}};
}

double ProcessorSeconds() {
  struct timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// What a row's process tells; memory is seen from outside.
struct Outcome {
  int jobs = 0, right = 0;
  double seconds = 0.0, log_likelihood = 0.0;  // means over jobs
  double rmse_m = NAN;                         // median over those that are right
};

Outcome RunRow(int first, int last, const proto::Stage& stage) {
  Outcome outcome;
  std::vector<double> rmse_m;
  for (int seed = first; seed <= last; ++seed) {
    datasets::SimulateLoopOptions world;
    world.difficulty = "paper";
    world.seed = static_cast<std::uint64_t>(seed);
    const Blob log = datasets::SimulateLoop(world);
    const auto seen = std::make_shared<const Blob>(log.Without("truth/"));
    const double begin = ProcessorSeconds();
    const BlobPtr result = RunInProcess(*MakePipeline(stage, world.seed), {{"log", seen}});
    outcome.seconds += ProcessorSeconds() - begin;
    outcome.log_likelihood += result->Get<double>("history/log_likelihood").back();
    const datasets::Evaluation score = datasets::Evaluate(*result, log);
    ++outcome.jobs;
    if (!score.topology_correct.value_or(false)) continue;
    ++outcome.right;
    rmse_m.push_back(score.landmarks->rmse_m.value_or(NAN));
  }
  outcome.seconds /= outcome.jobs;
  outcome.log_likelihood /= outcome.jobs;
  std::ranges::sort(rmse_m);
  if (!rmse_m.empty()) outcome.rmse_m = rmse_m[rmse_m.size() / 2];
  return outcome;
}

[[noreturn]] void RunChild(int first, int last, const proto::Stage& stage, int pipe) {
  int status = 1;
  try {
    const Outcome outcome = RunRow(first, last, stage);
    if (::write(pipe, &outcome, sizeof outcome) == sizeof outcome) status = 0;
  } catch (const InputError& error) {
    std::fprintf(stderr, "tricks: %s\n", error.what());
  }
  ::_exit(status);
}

// In a process of its own. False where it failed, after it has said why.
bool Measure(int first, int last, const proto::Stage& stage, Outcome* outcome, double* peak_mb) {
  int ends[2];
  if (::pipe(ends) != 0) return false;
  std::fflush(stdout);
  const pid_t child = ::fork();
  if (child < 0) return false;
  if (child == 0) RunChild(first, last, stage, ends[1]);
  ::close(ends[1]);
  const bool told = ::read(ends[0], outcome, sizeof *outcome) == sizeof *outcome;
  ::close(ends[0]);
  struct rusage usage{};
  ::wait4(child, nullptr, 0, &usage);
  *peak_mb = static_cast<double>(usage.ru_maxrss) * 1.024e-3;
  return told;
}

std::string Joined(const Options& options) {
  std::string text;
  for (const std::string& option : options) text += (text.empty() ? "`" : " ") + option;
  return text.empty() ? "" : text + "`";
}

void PrintTable(const Table& table, int first, int last, const Options& everywhere) {
  std::printf(
      "\n| %s | options | processor time a job | peak memory | right | landmark RMSE | log-likelihood |\n",
      table.title);
  std::printf("| --- | --- | --- | --- | --- | --- | --- |\n");
  for (const Row& row : table.rows) {
    proto::Stage stage;
    stage.set_name("landmarks");
    stage.set_pipeline("landmark_map");
    for (const Options& options :
         {Options{"starts=1", "slice_mcells=1e6"}, table.options, row.options, everywhere}) {
      for (const std::string& option : options) SetOption(option, &stage);
    }
    Outcome o;
    double peak_mb = 0.0;
    std::printf("| %s | %s | ", row.what, Joined(row.options).c_str());
    if (!Measure(first, last, stage, &o, &peak_mb)) {
      std::printf("failed | | | | |\n");
      continue;
    }
    std::printf("%.3f s | %.0f MB | %d of %d | %.2f m | %.1f |\n", o.seconds, peak_mb, o.right, o.jobs,
                o.rmse_m, o.log_likelihood);
  }
}

// A belief as wide as one is between landmarks: every heading, 20 x 20 cells.
LayeredGrid SomeBelief(int headings) {
  LayeredGrid belief;
  for (int c = 0; c < headings; ++c) {
    belief.layers.emplace_back(Box{0, 0, 20, 20});
    belief.layers.back().values.assign(400, 1.0);
  }
  return belief;
}

// What there is to be saved by symmetry and caching: a stencil serves all places of a heading.
void PrintStencils() {
  constexpr int kHeadings = 72, kTimes = 200;
  const MotionIncrement increment{.dx_m = 6.0, .dy_m = 2.0, .path_m = 6.5, .turn_rad = 0.5};
  const IncrementError error{.heading_rad = 0.05, .along_m = 0.3};
  const LayeredGrid belief = SomeBelief(kHeadings);
  double sink = 0.0;
  double begin = ProcessorSeconds();
  for (int i = 0; i < kTimes; ++i) {
    for (int c = 0; c < kHeadings; ++c) {
      const double angle = 2.0 * std::numbers::pi * c / kHeadings + 1e-3 * i;
      const double cosine = std::cos(angle), sine = std::sin(angle);
      sink += ShiftStencil(6.0 * cosine - 2.0 * sine, 6.0 * sine + 2.0 * cosine, cosine, sine, 0.3)
                  .points[0]
                  .weight;
    }
  }
  const double stencil_s = (ProcessorSeconds() - begin) / (kTimes * kHeadings);
  begin = ProcessorSeconds();
  for (int i = 0; i < kTimes; ++i) {
    sink += MotionKernel(increment, error, 1.0, kHeadings, ErrorShape::kGaussian)
                .Forward(belief)
                .layers[0]
                .values[0];
  }
  const double cell_s = (ProcessorSeconds() - begin) / kTimes / static_cast<double>(belief.cells());
  std::printf(
      "\nA stencil takes %.0f ns to make, a cell %.1f ns to move (%lld cells under %d headings). Stencils "
      "take %.1f%% "
      "of a move; one for each cell, without symmetry, would take %.0f times the move.%s\n",
      1e9 * stencil_s, 1e9 * cell_s, static_cast<long long>(belief.cells()), kHeadings,
      100.0 * kHeadings * stencil_s / (cell_s * static_cast<double>(belief.cells())), stencil_s / cell_s,
      std::isnan(sink) ? " (not a number)" : "");
}

int Main(const std::vector<std::string>& words) {
  Options everywhere;
  std::vector<std::string> args;
  for (const std::string& word : words) {
    (word.find('=') != std::string::npos ? everywhere : args).push_back(word);
  }
  const int first = args.empty() ? 101 : std::atoi(args[0].c_str());
  const int last = args.size() < 2 ? std::max(first, 120) : std::atoi(args[1].c_str());
  if (args.size() > 2 || first < 1 || last < first) {
    std::fprintf(stderr, "usage: tricks [FIRST LAST] [key=value ...]\n");
    return 2;
  }
  std::printf("paper, seeds %d to %d, one start, one slice\n", first, last);
  for (const Table& table : Tables()) PrintTable(table, first, last, everywhere);
  PrintStencils();
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return cairn::BenchMain("tricks", cairn::Main, argc, argv); }
