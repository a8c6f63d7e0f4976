// What localisation starts from: positions whose features are known, and the runs to find the robot in.
#pragma once

#include <string>
#include <vector>

#include "pipelines/localization/belief.h"
#include "pipelines/localization/look.h"
#include "pipelines/localization/options.h"
#include "pipelines/localization/position_index.h"
#include "pipelines/pipeline.h"
#include "schema/kinds/learning.h"

namespace cairn::localization {

class Learned;

// A run of the samples (schema/FORMAT.md).
struct Run {
  std::int32_t index = 0;  // among the samples' runs
  // Displacements, the window at the start and scores come from these, nothing else.
  std::vector<Position> positions;
  std::vector<double> heading_rad;  // [samples]; empty where it is not known
  std::vector<float> output;        // [samples][features]: P(f_i = 1 | s)
  // Since the sample before, facing as at this one; empty where there is none.
  std::vector<OwnMotion> odometry;
  static void Fields(const auto& field) {
    field("index", &Run::index);
    field("positions", &Run::positions);
    field("heading_rad", &Run::heading_rad);
    field("output", &Run::output);
    field("odometry", &Run::odometry);
  }
};

struct Source {
  std::vector<std::string> run_names;  // of all runs of the samples
  std::vector<std::string> feature_names;
  std::vector<FeatureGroup> groups;     // of each networks input; one where features are hand-made
  std::vector<Position> map_positions;  // training samples
  std::vector<double> map_heading_rad;  // of these; empty where headings do not count
  std::vector<double> map_output;       // [training samples][features]
  std::vector<Run> runs;
  std::string samples_hash;  // of the samples without truth
  std::vector<std::string> extractors;
  std::vector<kinds::NetworksWorth> extractor;  // of each networks input; for the result alone

  std::size_t features() const { return feature_names.size(); }
  // Whether a position counts with its heading: where the robot finds that out too (heading unknown), or
  // knows it and samples do not all face one way.
  bool headings() const { return !map_heading_rad.empty(); }

  // Inputs `samples` and, where there are, `networks`, `networks_2` and `networks_3`: then the map is that of
  // the networks' training samples, which must be the same for all, and features are the networks' outputs; a
  // network's inputs are found among the samples' by their names. Else features are the samples' hand-made
  // ones, and the map is that of all runs that are not localised in. All were checked as their kinds.
  // Throws InputError that names run and row where
  // - a run is asked for that is not there, or that the networks were trained on;
  // - no run is left to localise in, or none for the map, or the map has fewer samples than `nearest`;
  // - features or the networks' inputs are not among the samples', or several networks were trained on
  //   different samples;
  // - headings are needed and not there;
  // - look=active would weigh the outcomes of more than 12 features.
  static Source Of(const Options& options, const Inputs& inputs);
  // As a task is handed it. Throws InputError where its arrays do not fit each other, or the options.
  static Source In(const Options& options, const Inputs& inputs);

  static void Fields(const auto& field) {
    field("run_names", &Source::run_names);
    field("feature_names", &Source::feature_names);
    field("groups", &Source::groups);
    field("map_positions", &Source::map_positions);
    field("map_heading_rad", &Source::map_heading_rad);
    field("map_output", &Source::map_output);
    field("run", &Source::runs);
    field("samples_hash", &Source::samples_hash);
    field("extractors", &Source::extractors);
    field("extractor", &Source::extractor);
  }

 private:
  void Check(const Options& options) const;
  void UseNetworks(const Options& options, const kinds::Samples& samples,
                   const std::vector<Learned>& learned);
  void UseHandMade(const Options& options, const kinds::Samples& samples);
  void DecideOnHeadings(const Options& options);
};

}  // namespace cairn::localization
