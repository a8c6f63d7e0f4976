#include "datasets/evaluate/learning/held_out_runs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "schema/kinds/learning.h"
#include "schema/kinds/sample_hashes.h"

namespace cairn::datasets {
namespace {

void CheckInputs(const std::vector<std::string>& names, const LearnedNetworks& nets) {
  if (names.size() != nets.inputs)
    throw InputError(std::to_string(names.size()) + " inputs, the networks have " +
                     std::to_string(nets.inputs));
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] != nets.input_name[i])
      throw InputError("input " + std::to_string(i) + " is '" + names[i] + "', in the networks '" +
                       nets.input_name[i] + "'");
  }
}

using RunPosition = std::pair<double, double>;

bool WasTrainedOn(const HeldOutRun& run, const LearnedNetworks& nets) {
  std::set<RunPosition> positions;
  for (std::size_t k = 0; k < run.x_m.size(); ++k) positions.emplace(run.x_m[k], run.y_m[k]);
  bool any = false;
  for (std::size_t k = 0; k < nets.samples(); ++k) {
    if (nets.runs[static_cast<std::size_t>(nets.run[k])] != run.name) continue;
    if (!positions.contains({nets.x_m[k], nets.y_m[k]})) return false;
    any = true;
  }
  return any;
}

// Whatever it is called: more than half of its samples stand where one was trained on, and the networks make
// the same of both.
bool IsCopyOfTrained(const HeldOutRun& run, const LearnedNetworks& nets) {
  constexpr std::size_t kFew = 20;
  constexpr double kSame = 1e-4;
  if (run.x_m.size() < kFew) return false;
  std::multimap<RunPosition, std::size_t> trained;
  for (std::size_t k = 0; k < nets.samples(); ++k) trained.emplace(RunPosition(nets.x_m[k], nets.y_m[k]), k);
  std::size_t copies = 0;
  for (std::size_t k = 0; k < run.x_m.size(); ++k) {
    const auto [first, last] = trained.equal_range({run.x_m[k], run.y_m[k]});
    if (first == last) continue;
    const std::vector<double> output = OutputsOf(nets, run.input.subspan(k * nets.inputs, nets.inputs));
    copies += std::any_of(first, last, [&](const auto& one) {
      for (std::size_t i = 0; i < nets.networks; ++i)
        if (std::abs(nets.output[one.second * nets.networks + i] - output[i]) > kSame) return false;
      return true;
    });
  }
  return 2 * copies > run.x_m.size();
}

bool DecidedWhenToStop(const std::string& name, const LearnedNetworks& nets) {
  const auto named = std::ranges::find(nets.runs, name);
  return named != nets.runs.end() &&
         std::ranges::count(nets.run, static_cast<std::int32_t>(named - nets.runs.begin())) == 0;
}

}  // namespace

HeldOutRuns ReadHeldOutRuns(const Blob& file, const LearnedNetworks& nets) {
  const auto samples = Read<kinds::Samples>(file);
  const std::vector<std::string>& names = samples.runs.values();
  CheckInputs(samples.input_name, nets);
  HeldOutRuns held_out;
  for (std::size_t r = 0; r < names.size(); ++r) {
    const kinds::Samples::Run& of = samples.run[r];
    HeldOutRun run{names[r], r, of.x_m, of.y_m, of.input, of.heading_rad.OrNone()};
    if (run.x_m.empty()) continue;
    if (DecidedWhenToStop(names[r], nets)) held_out.stopped_by.push_back(names[r]);
    const bool known = InCommon(SampleHashes(of, nets.inputs), nets.known).AreACopy();
    if (known || WasTrainedOn(run, nets) || IsCopyOfTrained(run, nets))
      held_out.trained_on.push_back(names[r]);
    else
      held_out.runs.push_back(std::move(run));
  }
  if (held_out.runs.empty() && held_out.trained_on.empty()) throw InputError("there are no samples");
  if (held_out.runs.empty()) throw InputError("the networks were trained on every run: none is held out");
  return held_out;
}

}  // namespace cairn::datasets
