#include "pipelines/landmark_learning/data/training_data.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "schema/error.h"
#include "schema/kinds/inputs_of_time.h"
#include "schema/kinds/learning.h"
#include "schema/kinds/sample_hashes.h"

namespace cairn::landmark_learning {
namespace {

// Before they are sorted: the inputs as they were sensed.
struct RawRun {
  Positions positions;
  std::vector<double> weight;   // empty: the file has none
  std::vector<double> heading;  // the same
  std::vector<float> inputs;
  std::vector<std::int64_t> sample_hash;
};

// The same snapshot twice would be told apart from itself. (A robot that stands still has times of its own.)
void CheckNoDuplicates(const Positions& positions, const std::vector<double>& time_s,
                       const std::string& run) {
  for (std::size_t k = 1; k < time_s.size() && k < positions.x_m.size(); ++k) {
    if (time_s[k] == time_s[k - 1] && positions.x_m[k] == positions.x_m[k - 1] &&
        positions.y_m[k] == positions.y_m[k - 1])
      throw InputError("run '" + run + "', samples " + std::to_string(k - 1) + " and " + std::to_string(k) +
                       ": the same time and position, a duplicate");
  }
}

RawRun RunOf(const kinds::Samples::Run& of, const std::string& run, std::size_t inputs) {
  RawRun raw;
  raw.positions.x_m = of.x_m.vector();
  raw.positions.y_m = of.y_m.vector();
  const std::size_t count = raw.positions.x_m.size();
  if (count < 2)
    throw InputError("run '" + run + "' has " + std::to_string(count) + " samples; two are the least");
  if (of.weight) raw.weight = of.weight.vector();
  if (of.heading_rad) raw.heading = of.heading_rad.vector();
  CheckNoDuplicates(raw.positions, of.time_s.vector(), run);
  raw.inputs = of.input.vector();
  raw.sample_hash = SampleHashes(of, inputs);
  double along = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    if (k > 0)
      along += std::hypot(raw.positions.x_m[k] - raw.positions.x_m[k - 1],
                          raw.positions.y_m[k] - raw.positions.y_m[k - 1]);
    raw.positions.along_m.push_back(along);
  }
  return raw;
}

// A set that is still in the making.
struct RawSet {
  Positions positions;
  std::vector<std::int32_t> run;
  std::vector<float> inputs;
  std::vector<double> weight, heading;  // of fewer samples where a run has none
  std::vector<std::int64_t> sample_hash;
};

void Append(const RawRun& raw, std::size_t run, RawSet* set) {
  const auto add = [](const auto& from, auto* to) { to->insert(to->end(), from.begin(), from.end()); };
  add(raw.positions.x_m, &set->positions.x_m);
  add(raw.positions.y_m, &set->positions.y_m);
  add(raw.positions.along_m, &set->positions.along_m);
  add(raw.inputs, &set->inputs);
  add(raw.weight, &set->weight);
  add(raw.heading, &set->heading);
  add(raw.sample_hash, &set->sample_hash);
  set->run.insert(set->run.end(), raw.positions.x_m.size(), static_cast<std::int32_t>(run));
}

double Extent(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto [low, high] = std::ranges::minmax_element(values);
  return *high - *low;
}

RawSet Sorted(const RawSet& set, std::size_t inputs) {
  const std::vector<double>& along =
      Extent(set.positions.x_m) >= Extent(set.positions.y_m) ? set.positions.x_m : set.positions.y_m;
  std::vector<std::size_t> order(along.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return along[k]; });
  RawSet sorted;
  for (const std::size_t k : order) {
    sorted.positions.x_m.push_back(set.positions.x_m[k]);
    sorted.positions.y_m.push_back(set.positions.y_m[k]);
    sorted.positions.along_m.push_back(set.positions.along_m[k]);
    sorted.run.push_back(set.run[k]);
    sorted.sample_hash.push_back(set.sample_hash[k]);
    if (set.weight.size() == order.size()) sorted.weight.push_back(set.weight[k]);
    if (set.heading.size() == order.size()) sorted.heading.push_back(set.heading[k]);
    const float* row = &set.inputs[k * inputs];
    sorted.inputs.insert(sorted.inputs.end(), row, row + inputs);
  }
  return sorted;
}

// Into the positions, where beliefs look for them.
void PutDirections(SampleSet* set) {
  for (const double heading : set->heading_rad) {
    set->positions.cos_heading.push_back(std::cos(heading));
    set->positions.sin_heading.push_back(std::sin(heading));
  }
}

SampleSet Normalised(RawSet set, const std::vector<double>& mean, const std::vector<double>& scale) {
  for (std::size_t i = 0; i < set.inputs.size(); ++i) {
    const std::size_t input = i % mean.size();
    set.inputs[i] = static_cast<float>((set.inputs[i] - mean[input]) / scale[input]);
  }
  const std::int64_t samples = set.positions.size();
  std::vector<double> weight(static_cast<std::size_t>(samples), 1.0 / static_cast<double>(samples));
  SampleSet normalised{std::move(set.positions),
                       std::move(set.run),
                       std::move(weight),
                       Array::Of<float>({samples, static_cast<std::int64_t>(mean.size())}, set.inputs),
                       std::move(set.weight),
                       std::move(set.heading),
                       std::move(set.sample_hash)};
  PutDirections(&normalised);
  return normalised;
}

void FindNorm(const RawSet& set, std::size_t inputs, std::vector<double>* mean, std::vector<double>* scale) {
  const auto count = static_cast<double>(set.positions.size());
  std::vector<double> sum(inputs, 0.0), squares(inputs, 0.0);
  for (std::size_t i = 0; i < set.inputs.size(); ++i) sum[i % inputs] += set.inputs[i];
  for (const double s : sum) mean->push_back(s / count);
  for (std::size_t i = 0; i < set.inputs.size(); ++i) {
    const double d = set.inputs[i] - (*mean)[i % inputs];
    squares[i % inputs] += d * d;
  }
  for (const double s : squares) scale->push_back(s > 0.0 ? std::sqrt(s / count) : 1.0);
}

void RequireKnownRuns(const std::vector<std::string>& runs, const std::string& holdout,
                      const std::vector<std::string>& unseen) {
  const auto refuse = [&](const char* option, const std::string& run) {
    if (std::ranges::count(runs, run) == 0)
      throw InputError(option + (": there is no run '" + run) + "' among the samples");
  };
  if (!holdout.empty()) refuse("holdout", holdout);
  for (const std::string& run : unseen) {
    refuse("unseen", run);
    if (run == holdout) throw InputError("unseen: '" + run + "' is held out: it decides when to stop");
  }
}

// What was recorded once says nothing of what was learned from it, whatever it is called.
void RequireNoCopy(const kinds::Samples& samples, const std::string& holdout,
                   const std::vector<std::string>& unseen) {
  const std::vector<std::string>& names = samples.runs.values();
  const std::size_t inputs = samples.input_name.values().size();
  const auto at = static_cast<std::size_t>(std::ranges::find(names, holdout) - names.begin());
  if (at == names.size()) return;
  const std::vector<std::int64_t> held_out = SampleHashes(samples.run[at], inputs);
  for (std::size_t r = 0; r < names.size(); ++r) {
    if (r == at || std::ranges::count(unseen, names[r]) > 0) continue;
    const std::vector<std::int64_t> trained = SampleHashes(samples.run[r], inputs);
    const SamplesInCommon common = InCommon(held_out, {trained.begin(), trained.end()});
    if (!common.AreACopy()) continue;
    throw InputError("holdout: " + std::to_string(common.known) + " of " + std::to_string(common.all) +
                     " samples of run '" + holdout + "' are row by row those of run '" + names[r] +
                     "', which is trained on: it is a copy, and tells nothing of what was learned. Hold out "
                     "another run, or name '" +
                     names[r] + "' as unseen");
  }
}

}  // namespace

TrainingData TrainingData::Of(const Blob& blob, const std::string& holdout, const InputNorm* given,
                              const std::vector<std::string>& unseen) {
  TrainingData data;
  const auto samples = Read<kinds::Samples>(blob);
  const std::vector<std::string>& all = samples.runs.values();
  RequireKnownRuns(all, holdout, unseen);
  data.input_names = samples.input_name.values();
  const std::size_t inputs = data.input_names.size();
  if (inputs == 0)
    throw InputError("the samples have no inputs; of images `cairn run image_features` makes some");
  data.input_doubts = InputsOfTimeOf(blob);
  if (!holdout.empty()) RequireNoCopy(samples, holdout, unseen);
  RawSet training, held_out;
  for (std::size_t r = 0; r < all.size(); ++r) {
    if (std::ranges::count(unseen, all[r]) > 0) continue;
    Append(RunOf(samples.run[r], all[r], inputs), data.runs.size(),
           !holdout.empty() && all[r] == holdout ? &held_out : &training);
    data.runs.push_back(all[r]);
  }
  if (training.positions.size() == 0) throw InputError("no run is left to train on");
  if (given != nullptr) {
    data.mean = given->mean;
    data.scale = given->scale;
  } else {
    FindNorm(training, inputs, &data.mean, &data.scale);
  }
  data.training = Normalised(Sorted(training, inputs), data.mean, data.scale);
  data.held_out = Normalised(Sorted(held_out, inputs), data.mean, data.scale);
  return data;
}

}  // namespace cairn::landmark_learning
