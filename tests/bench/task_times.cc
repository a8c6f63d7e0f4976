// How long the tasks of a job are (processor time), and how much memory it takes: runs a stage in this
// process and prints a line a round and one of all.
//   task_times PIPELINE LOG.h5 [key=value …] [trace=FILE] [input:NAME=FILE.h5 …]
// A trace is what tests/eta replays, a line each: `start SECONDS`; of each round `round
// COST SECONDS` of its ADVANCE, `later ROUNDS COST WIDTH LEAST MOST` of each phase that its step expects to
// follow, `task KIND COST SECONDS` with the tasks whose partials it reads.
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "pipelines/registry.h"
#include "pipelines/testing/in_process.h"
#include "schema/store/blob_file.h"
#include "tests/bench/bench_main.h"
#include "tests/bench/stage_option.h"

namespace cairn {
namespace {

// Of processor time: a machine that is shared does not matter.
double Seconds() {
  struct timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Round {
  proto::Step plan;
  std::vector<double> seconds;  // of each task
  int tasks = 0;
  double longest_s = 0.0, all_s = 0.0, work = 0.0;
  std::size_t largest_bytes = 0;
};

// Passes everything on and takes the time.
class Timed : public Pipeline {
 public:
  // `trace`: may be null.
  Timed(const Pipeline& pipeline, std::FILE* trace) : pipeline_(pipeline), trace_(trace) {}

  Step Start(const Inputs& inputs) const override {
    const double begin = Seconds();
    Step step = pipeline_.Start(inputs);
    std::printf("start %.3f s\n", Seconds() - begin);
    if (trace_ != nullptr) std::fprintf(trace_, "start %.4f\n", Seconds() - begin);
    round_.plan = step.plan;
    return step;
  }
  Blob Run(const Task& task, const Inputs& inputs, Progress& progress) const override {
    const double begin = Seconds();
    Blob partial = pipeline_.Run(task, inputs, progress);
    const double seconds = Seconds() - begin;
    ++round_.tasks;
    round_.seconds.push_back(seconds);
    round_.longest_s = std::max(round_.longest_s, seconds);
    round_.all_s += seconds;
    if (partial.Has("work") && task.kind() == "backward") round_.work += partial.Scalar<double>("work");
    round_.largest_bytes = std::max(round_.largest_bytes, partial.ByteCount());
    return partial;
  }
  Step Advance(const State& state, Partials& partials, const Inputs& inputs) const override {
    const double begin = Seconds();
    Step step = pipeline_.Advance(state, partials, inputs);
    std::printf(
        "%5d tasks, longest %.3f s, all %.3f s, %.2f million cells, largest partial %.2f MB; advance %.3f s: "
        "%s\n",
        round_.tasks, round_.longest_s, round_.all_s, round_.work / 1e6,
        static_cast<double>(round_.largest_bytes) / 1e6, Seconds() - begin, step.plan.note().c_str());
    if (trace_ != nullptr) Trace(Seconds() - begin);
    longest_s_ = std::max({longest_s_, round_.longest_s, Seconds() - begin});
    work_ += round_.work;
    run_s_ += round_.all_s;
    round_ = {};
    round_.plan = step.plan;
    return step;
  }
  void PrintTotal() const {
    struct rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    std::printf("longest %.3f s; %.1f million cells in %.2f s, %.1f million a second; peak %.0f MB\n",
                longest_s_, work_ / 1e6, run_s_, work_ / 1e6 / run_s_,
                static_cast<double>(usage.ru_maxrss) / 1e3);
  }

 private:
  void Trace(double advance_s) const {
    std::fprintf(trace_, "round %.0f %.4f\n", round_.plan.advance_cost(), advance_s);
    for (const proto::Phase& phase : round_.plan.later())
      std::fprintf(trace_, "later %.3g %.3g %.3g %.3g %.3g\n", phase.rounds(), phase.cost(), phase.width(),
                   phase.least(), phase.most());
    for (const Task& task : round_.plan.tasks()) {
      std::fprintf(trace_, "task %s %llu %.4f", task.kind().c_str(),
                   static_cast<unsigned long long>(task.cost()), round_.seconds[task.index()]);
      std::set<std::uint32_t> reads;
      for (const proto::InputRef& input : task.inputs())
        if (input.has_task()) reads.insert(input.task());
      for (const std::uint32_t read : reads) std::fprintf(trace_, " %u", read);
      std::fprintf(trace_, "\n");
    }
  }

  const Pipeline& pipeline_;
  std::FILE* trace_;
  mutable Round round_;
  mutable double longest_s_ = 0.0, work_ = 0.0, run_s_ = 0.0;
};

int Main(const std::vector<std::string>& args) {
  if (args.size() < 2) {
    std::fprintf(stderr, "usage: task_times PIPELINE LOG.h5 [key=value ...]\n");
    return 2;
  }
  proto::Stage stage;
  stage.set_name("stage");
  stage.set_pipeline(args[0]);
  std::map<std::string, BlobPtr> inputs;
  const auto read = [&inputs](const std::string& name, const std::string& path) {
    auto file = ReadBlobFileWithoutTruth(path);
    if (!file.ok()) throw InputError(file.status().message());
    inputs[name.empty() ? file.value().kind : name] =
        std::make_shared<const Blob>(std::move(file).value().blob);
  };
  read("", args[1]);  // called after its kind: a log, samples
  constexpr std::string_view kTrace = "trace=", kInput = "input:";
  std::FILE* trace = nullptr;
  for (std::size_t i = 2; i < args.size(); ++i) {
    const std::size_t equals = args[i].find('=');
    if (args[i].starts_with(kTrace)) {
      trace = std::fopen(args[i].substr(kTrace.size()).c_str(), "w");
      if (trace == nullptr) throw InputError(args[i] + ": cannot be written");
    } else if (args[i].starts_with(kInput) && equals != std::string::npos) {
      read(args[i].substr(kInput.size(), equals - kInput.size()), args[i].substr(equals + 1));
    } else {
      SetOption(args[i], &stage);
    }
  }
  if (trace != nullptr) {
    std::fprintf(trace, "# task_times");
    for (const std::string& arg : args) std::fprintf(trace, " %s", arg.c_str());
    std::fprintf(trace, "\n");
  }
  const auto pipeline = MakePipeline(stage, 1);
  const Timed timed(*pipeline, trace);
  RunInProcess(timed, inputs);
  if (trace != nullptr) std::fclose(trace);
  timed.PrintTotal();
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return cairn::BenchMain("task_times", cairn::Main, argc, argv); }
