#include <array>

#include "coordinator/cli/job_file/job_file.h"
#include "schema/error.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

constexpr std::string_view kCatalog =
    R"({"pipelines": [{"name": "map", "summary": "", "inputs": ["log", "poses?"],
  "options": [{"name": "cell_m", "type": "real", "low": 0.01, "high": 10}, {"name": "steps", "type": "integer",
  "low": 1, "high": 100}, {"name": "sharp", "type": "boolean"}, {"name": "mode", "type": "text",
  "choices": ["fast", "good"]}]}]})";

constexpr std::array<std::string_view, 3> kJobs{
    "inputs: {log: log.h5}\nstages:\n  - {name: a, pipeline: map, log: log}\n",
    "name: museum\nseed: 7\ninputs:\n  log: log.h5\n  other: \"log.h5\"\nstages:\n  - name: first\n    "
    "pipeline: map\n"
    "    log: log\n    options: {cell_m: 0.25, steps: 5, sharp: true, mode: fast}\n  - name: second\n"
    "    pipeline: map\n    log: &x other\n    poses: first\n    options:\n      mode: \"good\"\n",
    "seed: 18446744073709551615\ninputs: {a: log.h5}\nstages: [{name: b.c, pipeline: map, log: a}]\n",
};

Outcome Run(std::span<const std::uint8_t> bytes) {
  static const cli::Catalog catalog = cli::Catalog::FromJson(kCatalog);
  static const ScratchFolder folder;
  static const bool filled = (folder.Put("log.h5", "x"), true);
  static_cast<void>(filled);
  folder.Put("job.yaml", AsText(bytes));
  try {
    const cli::ParsedJob parsed = cli::ReadJobFile((folder.path() / "job.yaml").string(), catalog);
    CAIRN_DEMAND(parsed.job.stages_size() > 0 && !parsed.inputs.empty(), "a job of nothing");
    for (const proto::Stage& stage : parsed.job.stages())
      CAIRN_DEMAND(stage.inputs().contains("log") && stage.name().find('/') == std::string::npos,
                   "a stage that cannot be");
  } catch (const InputError&) {
    return Outcome::kRefused;
  }
  return Outcome::kAccepted;
}

std::vector<Bytes> Seeds() {
  std::vector<Bytes> seeds;
  for (const std::string_view job : kJobs) seeds.emplace_back(job.begin(), job.end());
  return seeds;
}

}  // namespace

Target JobFileTarget() { return {"job_file", Run, Seeds, 2000}; }

}  // namespace cairn::fuzz
