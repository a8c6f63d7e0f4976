#include "pipelines/localization/source.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "pipelines/common/handed_over.h"
#include "pipelines/localization/learned.h"
#include "schema/error.h"
#include "schema/headings.h"
#include "schema/kinds/learning.h"
#include "schema/kinds/sample_hashes.h"

namespace cairn::localization {
namespace {

std::string JoinNames(const std::vector<std::string>& names) {
  std::string joined;
  for (const std::string& name : names) joined += (joined.empty() ? "" : ", ") + name;
  return joined;
}

// Of each sample since the one before; empty where there is none, or labels are asked for.
std::vector<OwnMotion> OdometryOf(const Options& options, const kinds::Samples::Run& run,
                                  const std::string& name) {
  if (options.odometry == "labels" || !run.forward_m) return {};
  std::vector<OwnMotion> odometry;
  for (std::size_t k = 0; k < run.forward_m.size(); ++k) {
    const OwnMotion own{{run.forward_m[k], run.left_m ? run.left_m[k] : 0.0}, run.turn_rad[k]};
    if (k > 0 && !std::isfinite(own.moved.x_m + own.moved.y_m + own.turn_rad))
      throw InputError("run '" + name + "', sample " + std::to_string(k) + ": its odometry is not finite");
    odometry.push_back(own);
  }
  return odometry;
}

// With nothing sensed yet.
Run RunOf(const Options& options, const kinds::Samples& samples, std::size_t index) {
  const kinds::Samples::Run& of = samples.run[index];
  const std::string& name = samples.runs[index];
  Run run{static_cast<std::int32_t>(index), {}, {}, {}, OdometryOf(options, of, name)};
  for (std::size_t k = 0; k < of.x_m.size(); ++k) run.positions.push_back({of.x_m[k], of.y_m[k]});
  if (run.positions.empty()) throw InputError("run '" + name + "': there are no samples");
  if (of.heading_rad) run.heading_rad = of.heading_rad.vector();
  if (!run.odometry.empty() && run.heading_rad.empty())
    throw InputError("run '" + name +
                     "': its odometry says nothing without headings ('heading_rad'); "
                     "odometry=labels does not look at it");
  return run;
}

// Features by networks: those of several stand beside each other.
class NetworkExtractor {
 public:
  NetworkExtractor(const kinds::Samples& samples, const std::vector<Learned>& learned)
      : samples_(samples), learned_(learned) {
    const std::vector<std::string>& inputs = samples.input_name.values();
    width_ = inputs.size();
    for (const Learned& networks : learned) columns_.push_back(networks.ColumnsIn(inputs));
  }

  std::vector<float> OutputOf(std::size_t run, std::size_t rows) const {
    std::vector<std::vector<float>> parts;
    for (std::size_t n = 0; n < learned_.size(); ++n)
      parts.push_back(learned_[n].OutputsOf(samples_.run[run].input, width_, columns_[n]));
    return BesideEachOther(parts, rows);
  }

  std::vector<double> MapOutput() const {
    std::vector<std::vector<double>> parts;
    for (const Learned& networks : learned_) parts.push_back(networks.outputs());
    return BesideEachOther(parts, learned_.front().positions().size());
  }

 private:
  template <class T>
  static std::vector<T> BesideEachOther(const std::vector<std::vector<T>>& parts, std::size_t rows) {
    std::vector<T> all;
    for (std::size_t row = 0; row < rows; ++row) {
      for (const std::vector<T>& part : parts) {
        const std::size_t columns = part.size() / rows;
        const auto first = part.begin() + static_cast<std::ptrdiff_t>(row * columns);
        all.insert(all.end(), first, first + static_cast<std::ptrdiff_t>(columns));
      }
    }
    return all;
  }

  const kinds::Samples& samples_;
  const std::vector<Learned>& learned_;
  std::size_t width_ = 0;
  std::vector<std::vector<std::size_t>> columns_;
};

// Some columns of the hand-made features.
class HandMadeExtractor {
 public:
  HandMadeExtractor(const kinds::Samples& samples, const std::vector<std::string>& wanted)
      : samples_(samples) {
    if (!samples_.feature_name)
      throw InputError("without networks the samples need hand-made features, and they have none");
    const std::vector<std::string>& all = samples_.feature_name.values();
    all_columns_ = all.size();
    names_ = wanted.empty() ? all : wanted;
    if (names_.empty()) throw InputError("the samples have no features");
    for (const std::string& name : names_) {
      const auto at = std::ranges::find(all, name);
      if (at == all.end()) throw InputError("features: there is no '" + name + "' among " + JoinNames(all));
      columns_.push_back(static_cast<std::size_t>(at - all.begin()));
    }
  }

  const std::vector<std::string>& names() const { return names_; }

  std::vector<float> OutputOf(std::size_t run, std::size_t rows) const {
    const std::span<const float> all = samples_.run[run].feature;
    std::vector<float> picked;
    for (std::size_t row = 0; row < rows; ++row) {
      for (const std::size_t column : columns_) picked.push_back(all[row * all_columns_ + column]);
    }
    return picked;
  }

 private:
  const kinds::Samples& samples_;
  std::vector<std::string> names_;
  std::vector<std::size_t> columns_;
  std::size_t all_columns_ = 0;
};

// Indices of the runs to localise in, ascending.
std::vector<std::size_t> RunsToLocaliseIn(const Options& options, const std::vector<std::string>& all,
                                          const std::vector<std::string>& trained_on) {
  const std::vector<std::string> wanted = ByCommas(options.runs);
  for (const std::string& name : wanted) {
    if (std::ranges::find(all, name) == all.end())
      throw InputError("runs: there is no run '" + name + "' among the samples");
    if (std::ranges::count(trained_on, name) > 0)
      throw InputError("runs: the networks were trained on '" + name + "'");
  }
  if (trained_on.empty() && wanted.empty())
    throw InputError("runs: without networks, which runs to localise in must be said");
  std::vector<std::size_t> runs;
  for (std::size_t r = 0; r < all.size(); ++r) {
    const bool asked =
        wanted.empty() ? std::ranges::count(trained_on, all[r]) == 0 : std::ranges::count(wanted, all[r]) > 0;
    if (asked) runs.push_back(r);
  }
  if (runs.empty()) throw InputError("the networks were trained on every run: none is left to localise in");
  return runs;
}

// The runs that networks, or any that they went on from, were trained on: by name, and by what was sensed
// where.
std::vector<std::string> TrainedOn(const kinds::Samples& samples, const std::vector<Learned>& learned) {
  std::vector<std::string> trained_on = learned.front().trained_on();
  for (std::size_t r = 0; r < samples.runs.size(); ++r) {
    const std::vector<std::int64_t> hashes = SampleHashes(samples.run[r], samples.input_name.size());
    const bool known = std::ranges::any_of(
        learned, [&](const Learned& of) { return InCommon(hashes, of.known_samples()).AreACopy(); });
    if (known && std::ranges::count(trained_on, samples.runs[r]) == 0) trained_on.push_back(samples.runs[r]);
  }
  return trained_on;
}

std::vector<Learned> ReadNetworks(const Options& options, const Inputs& inputs) {
  std::vector<Learned> learned;
  for (const char* name : {"networks", "networks_2", "networks_3"}) {
    if (!inputs.Has(name)) continue;
    learned.emplace_back(*inputs.Get(name));
    if (learned.back().positions() != learned.front().positions())
      throw InputError(std::string(name) + ": trained on other samples than the first networks");
  }
  if (!learned.empty() && !options.features.empty())
    throw InputError("features: they are the networks' outputs where there are networks");
  return learned;
}

}  // namespace

void Source::UseNetworks(const Options& options, const kinds::Samples& samples,
                         const std::vector<Learned>& learned) {
  const NetworkExtractor by_networks(samples, learned);
  for (std::size_t n = 0; n < learned.size(); ++n) {
    const std::size_t first = feature_names.size();
    const std::string of = learned.size() > 1 ? " of " + std::to_string(n + 1) : "";
    for (std::size_t i = 0; i < learned[n].networks(); ++i)
      feature_names.push_back("network " + std::to_string(i) + of);
    groups.push_back({first, feature_names.size()});
    extractors.push_back(n == 0 ? "networks" : "networks_" + std::to_string(n + 1));
    extractor.push_back(learned[n].worth());
  }
  map_positions = learned.front().positions();
  map_heading_rad = learned.front().headings_rad();
  map_output = by_networks.MapOutput();
  for (const std::size_t r : RunsToLocaliseIn(options, run_names, TrainedOn(samples, learned))) {
    Run run = RunOf(options, samples, r);
    run.output = by_networks.OutputOf(r, run.positions.size());
    runs.push_back(std::move(run));
  }
}

void Source::UseHandMade(const Options& options, const kinds::Samples& samples) {
  const HandMadeExtractor by_hand(samples, ByCommas(options.features));
  feature_names = by_hand.names();
  groups = {{0, feature_names.size()}};
  const std::vector<std::size_t> wanted = RunsToLocaliseIn(options, run_names, {});
  for (std::size_t r = 0; r < run_names.size(); ++r) {
    Run run = RunOf(options, samples, r);
    run.output = by_hand.OutputOf(r, run.positions.size());
    if (std::ranges::count(wanted, r) > 0) {
      runs.push_back(std::move(run));
      continue;
    }
    map_positions.insert(map_positions.end(), run.positions.begin(), run.positions.end());
    map_heading_rad.insert(map_heading_rad.end(), run.heading_rad.begin(), run.heading_rad.end());
    map_output.insert(map_output.end(), run.output.begin(), run.output.end());
  }
}

void Source::DecideOnHeadings(const Options& options) {
  std::vector<double> all = map_heading_rad;
  std::size_t samples = map_positions.size();
  for (const Run& run : runs) {
    all.insert(all.end(), run.heading_rad.begin(), run.heading_rad.end());
    samples += run.positions.size();
    if (options.heading == "unknown" && run.heading_rad.size() != run.positions.size())
      throw InputError("heading=unknown: run '" + run_names[static_cast<std::size_t>(run.index)] +
                       "' has no headings ('heading_rad') to turn by");
  }
  const bool known = map_heading_rad.size() == map_positions.size() && all.size() == samples;
  if (options.heading == "unknown" && !known)
    throw InputError(
        "heading=unknown: the map's samples have no headings; networks of an older version are to be "
        "trained again");
  const bool count =
      known && (options.heading == "unknown" || (options.heading == "known" && !AllFaceOneWay(all)));
  if (!count) map_heading_rad.clear();
}

Source Source::Of(const Options& options, const Inputs& inputs) {
  const BlobPtr blob = inputs.Get("samples");
  const auto samples = Read<kinds::Samples>(*blob);
  Source source;
  source.run_names = samples.runs.values();
  source.samples_hash = blob->SourceHash().Hex();
  const std::vector<Learned> learned = ReadNetworks(options, inputs);
  if (learned.empty())
    source.UseHandMade(options, samples);
  else
    source.UseNetworks(options, samples, learned);
  if (options.look == "active") RequireWeighable(source.groups);
  if (source.map_positions.empty()) throw InputError("runs: no run is left to make the map of");
  if (static_cast<std::size_t>(options.nearest) > source.map_positions.size()) {
    throw InputError("nearest = " + std::to_string(options.nearest) + ", but the map has only " +
                     std::to_string(source.map_positions.size()) + " samples");
  }
  source.DecideOnHeadings(options);
  return source;
}

namespace {

void RequirePositions(const std::vector<Position>& positions) {
  for (const Position& position : positions) {
    RequireWithin("a position's x_m", position.x_m, -kFar_m, kFar_m);
    RequireWithin("a position's y_m", position.y_m, -kFar_m, kFar_m);
  }
}

// One for each of `count` samples, or none.
void RequireHeadings(const std::vector<double>& heading_rad, std::size_t count) {
  if (!heading_rad.empty()) RequireSize("heading_rad", heading_rad.size(), count);
  RequireAllWithin("heading_rad", heading_rad, -1e9, 1e9);
}

// As one feature's, `count` of them.
template <class Output>
void RequireOutputs(const Output& output, std::size_t count) {
  RequireSize("output", output.size(), count);
  RequireAllWithin("output", output, -1e-6, 1 + 1e-6);
}

}  // namespace

void Source::Check(const Options& options) const {
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  const auto features = static_cast<std::int64_t>(this->features());
  RequireWithin("the number of features", features, 1, kMost);
  RequireWithin("the number of groups", static_cast<std::int64_t>(groups.size()), 1, features);
  for (const FeatureGroup& group : groups) {
    RequireWithin("the end of a group", static_cast<std::int64_t>(group.end), 1, features);
    RequireWithin("the first of a group", static_cast<std::int64_t>(group.first), 0,
                  static_cast<std::int64_t>(group.end) - 1);
  }
  if (options.look == "active") RequireWeighable(groups);
  RequireWithin("the number of samples of the map", static_cast<std::int64_t>(map_positions.size()),
                options.nearest, kMost);
  RequirePositions(map_positions);
  RequireHeadings(map_heading_rad, map_positions.size());
  RequireOutputs(map_output, map_positions.size() * this->features());
  RequireWithin("the number of runs", static_cast<std::int64_t>(runs.size()), 1, kMost);
  for (const Run& run : runs) {
    const std::size_t count = run.positions.size();
    RequireWithin("a run's index", run.index, 0, static_cast<std::int64_t>(run_names.size()) - 1);
    RequireWithin("the number of a run's samples", static_cast<std::int64_t>(count), 1, kMost);
    RequirePositions(run.positions);
    RequireHeadings(run.heading_rad, count);
    RequireOutputs(run.output, count * this->features());
    if (headings() || options.heading == "unknown" || !run.odometry.empty())
      RequireSize("a run's heading_rad", run.heading_rad.size(), count);
    if (!run.odometry.empty()) RequireSize("a run's odometry", run.odometry.size(), count);
    for (const OwnMotion& own : run.odometry) {
      RequirePositions({own.moved});
      RequireWithin("a turn", own.turn_rad, -1e9, 1e9);
    }
  }
  if (options.heading == "unknown")
    RequireSize("the map's heading_rad", map_heading_rad.size(), map_positions.size());
}

Source Source::In(const Options& options, const Inputs& inputs) {
  Source source = Read<Source>(*inputs.Get("source"));
  source.Check(options);
  return source;
}

}  // namespace cairn::localization
