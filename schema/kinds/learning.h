// schema/FORMAT.md, `samples`, `errors`, `networks`, `localization`: landmarks that are learned, and what
// they serve.
#pragma once

#include "schema/kinds/fields.h"

namespace cairn::kinds {

struct Samples {
  struct Run {
    Column<double> time_s, x_m, y_m, heading_rad, turn_rad, forward_m, left_m, weight;
    Column<float> input, feature;
    Column<std::uint8_t> image;
    static void Fields(const auto& field) {
      field(Needed("time_s", "K", Rising()), &Run::time_s);
      field(Needed("x_m", "K", Position()), &Run::x_m);
      field(Needed("y_m", "K", Position()), &Run::y_m);
      field({"heading_rad", "K", Finite()}, &Run::heading_rad);
      field(Needed("odometry/turn_rad", "K", Free()), &Run::turn_rad);  // of the first sample not looked at
      field(Needed("odometry/forward_m", "K", Free()), &Run::forward_m);
      field({"odometry/left_m", "K", Free()}, &Run::left_m);
      field(Needed("input", "K,I", Finite()), &Run::input);
      field({"weight", "K", From(0)}, &Run::weight);
      field({"image", "K,rows,columns,3", Free()}, &Run::image);
      field({"feature", "K,F", Share()}, &Run::feature);
    }
  };
  struct TrueRun {
    Column<double> x_m, y_m, heading_rad;
    static void Fields(const auto& field) {
      field(Needed("x_m", "K", Position()), &TrueRun::x_m);
      field(Needed("y_m", "K", Position()), &TrueRun::y_m);
      field({"heading_rad", "K", Finite()}, &TrueRun::heading_rad);
    }
  };

  Texts runs, input_name, feature_name;
  std::vector<Run> run;
  Column<double> label_error_m;
  std::vector<TrueRun> true_run;

  static void Fields(const auto& field) {
    field({"runs", "R"}, &Samples::runs);
    field({"input_name", "I"}, &Samples::input_name);
    field("run", &Samples::run);
    field({"feature_name", "F"}, &Samples::feature_name);
    field({"label_error_m", "", NotNegative()}, &Samples::label_error_m);
    field("truth/run", &Samples::true_run);
  }
};

struct Errors {
  Column<double> x_m, y_m, error;
  static void Fields(const auto& field) {
    field(Needed("position/x_m", "P", Position()), &Errors::x_m);
    field(Needed("position/y_m", "P", Position()), &Errors::y_m);
    field({"error", "P,P", From(0)}, &Errors::error);
  }
};

struct Networks {
  struct Weights {
    Column<double> hidden_weight, hidden_bias, hidden_2_weight, hidden_2_bias, output_weight, output_bias,
        input_mean, input_scale;
    Texts input_name;
    static void Fields(const auto& field) {
      field(Needed("hidden_weight", "n,H,I", Finite()), &Weights::hidden_weight);
      field(Needed("hidden_bias", "n,H", Finite()), &Weights::hidden_bias);
      field({"hidden_2_weight", "n,H2,H", Finite()}, &Weights::hidden_2_weight);
      field({"hidden_2_bias", "n,H2", Finite()}, &Weights::hidden_2_bias);
      field(Needed("output_weight", "n,J", Finite()), &Weights::output_weight);
      field(Needed("output_bias", "n", Finite()), &Weights::output_bias);
      field(Needed("input_mean", "I", Finite()), &Weights::input_mean);
      field(Needed("input_scale", "I", Above0()), &Weights::input_scale);
      field(Needed("input_name", "I"), &Weights::input_name);
    }
  };
  struct Map {
    Column<double> x_m, y_m, along_m, heading_rad;
    Column<std::int32_t> run;
    Column<float> output;
    Column<std::int64_t> sample_hash;
    static void Fields(const auto& field) {
      field(Needed("x_m", "K", Position()), &Map::x_m);
      field(Needed("y_m", "K", Position()), &Map::y_m);
      field(Needed("along_m", "K", NotNegative()), &Map::along_m);
      field({"heading_rad", "K", Finite()}, &Map::heading_rad);
      field(Needed("run", "K", IndexInto("runs")), &Map::run);
      field(Needed("output", "K,n", Share()), &Map::output);
      field({"sample_hash", "K", Free()}, &Map::sample_hash);
    }
  };
  struct History {
    Column<double> training_error_m, validation_error_m, gradient_norm;
    static void Fields(const auto& field) {
      field(Needed("training_error_m", "S", Finite()), &History::training_error_m);
      field(Needed("validation_error_m", "S", Finite().OrNan()), &History::validation_error_m);
      field(Needed("gradient_norm", "S", Finite()), &History::gradient_norm);
    }
  };
  struct HeldOut {
    Column<std::int64_t> samples, in_reach;
    Column<double> known_share, same_share, agreement_sigmas;
    static void Fields(const auto& field) {
      field({"samples", "", From(0)}, &HeldOut::samples);
      field({"in_reach", "", From(0)}, &HeldOut::in_reach);
      field({"known_share", "", Share()}, &HeldOut::known_share);
      field({"same_share", "", Share()}, &HeldOut::same_share);
      field({"agreement_sigmas", "", Finite()}, &HeldOut::agreement_sigmas);
    }
  };
  struct Ancestry {
    Texts hash, options;
    Column<std::int64_t> steps, sample_hash;
    Column<double> training_error_m, prior_error_m;
    static void Fields(const auto& field) {
      field(Needed("hash", "A"), &Ancestry::hash);
      field(Needed("options", "A"), &Ancestry::options);
      field(Needed("steps", "A", From(0)), &Ancestry::steps);
      field(Needed("training_error_m", "A", Finite().OrNan()), &Ancestry::training_error_m);
      field(Needed("prior_error_m", "A", Finite().OrNan()), &Ancestry::prior_error_m);
      field({"sample_hash", "B", Free()}, &Ancestry::sample_hash);
    }
  };

  Weights networks;
  Map map;
  Texts runs, options, warnings, input_doubts;
  History history;
  HeldOut held_out;
  Column<double> prior_error_m, validation_prior_error_m, window_m, heading_window_deg, starts_error_m;
  Column<std::int64_t> starts_chosen;
  Ancestry ancestry;

  static void Fields(const auto& field) {
    field("networks", &Networks::networks);
    field("map", &Networks::map);
    field({"runs", "R"}, &Networks::runs);
    field("history", &Networks::history);
    field({"prior_error_m", "", Finite()}, &Networks::prior_error_m);
    field({"validation_prior_error_m", "", Finite().OrNan()}, &Networks::validation_prior_error_m);
    field({"window_m", "", NotNegative()}, &Networks::window_m);
    field({"heading_window_deg", "", NotNegative()}, &Networks::heading_window_deg);
    field({"options", "O"}, &Networks::options);
    field({"warnings", "W"}, &Networks::warnings);
    field({"input_doubts", "D"}, &Networks::input_doubts);
    field("held_out", &Networks::held_out);
    field({"starts/error_m", "C", Finite()}, &Networks::starts_error_m);
    field({"starts/chosen", "", IndexInto("starts/error_m")}, &Networks::starts_chosen);
    field("ancestry", &Networks::ancestry);
  }
};

// What tells how far networks can be trusted, in their own file and in that of a localization by them.
struct NetworksWorth {
  // At the step whose weights are kept, of the error of a robot that senses nothing; missing where no run was
  // held out.
  Column<double> held_out_reduction, training_reduction;
  Networks::HeldOut held_out;
  Texts input_doubts;

  static void Fields(const auto& field) {
    field({"held_out_reduction", "", Finite()}, &NetworksWorth::held_out_reduction);
    field({"training_reduction", "", Finite()}, &NetworksWorth::training_reduction);
    field("held_out", &NetworksWorth::held_out);
    field({"input_doubts", "D"}, &NetworksWorth::input_doubts);
  }
};

struct Localization {
  struct Steps {
    Column<std::int32_t> traverse, run, sample;
    Column<double> travelled_m, mean_x_m, mean_y_m, mode_x_m, mode_y_m, spread_m, off_label_m, lead_nats,
        expected_lead_nats;
    Column<std::int64_t> entries;
    static void Fields(const auto& field) {
      field(Needed("traverse", "S", Rising()), &Steps::traverse);
      field(Needed("run", "S", IndexInto("runs")), &Steps::run);
      field(Needed("sample", "S", From(0)), &Steps::sample);
      field(Needed("travelled_m", "S", NotNegative()), &Steps::travelled_m);
      field(Needed("mean_x_m", "S", Position()), &Steps::mean_x_m);
      field(Needed("mean_y_m", "S", Position()), &Steps::mean_y_m);
      field(Needed("mode_x_m", "S", Position()), &Steps::mode_x_m);
      field(Needed("mode_y_m", "S", Position()), &Steps::mode_y_m);
      field(Needed("spread_m", "S", NotNegative()), &Steps::spread_m);
      field({"off_label_m", "S", NotNegative()}, &Steps::off_label_m);
      field({"lead_nats", "S", Finite()}, &Steps::lead_nats);
      field({"expected_lead_nats", "S", NotNegative()}, &Steps::expected_lead_nats);
      field(Needed("entries", "S", RowsOf("belief/position")), &Steps::entries);
    }
  };

  Steps step;
  Column<std::int32_t> belief_position;
  Column<float> belief_probability;
  Column<double> position_x_m, position_y_m, position_heading_rad, window_m;
  Texts heading, runs, feature_name, samples_hash, extractors;
  std::vector<NetworksWorth> extractor;

  static void Fields(const auto& field) {
    field("step", &Localization::step);
    field(Needed("belief/position", "B", IndexInto("position/x_m")), &Localization::belief_position);
    field(Needed("belief/probability", "B", Share()), &Localization::belief_probability);
    field(Needed("position/x_m", "P", Position()), &Localization::position_x_m);
    field(Needed("position/y_m", "P", Position()), &Localization::position_y_m);
    field({"position/heading_rad", "P", Finite()}, &Localization::position_heading_rad);
    field({"heading", ""}, &Localization::heading);
    field({"runs", "R"}, &Localization::runs);
    field({"feature_name", "F"}, &Localization::feature_name);
    field({"samples_hash", ""}, &Localization::samples_hash);
    field({"window_m", "", NotNegative()}, &Localization::window_m);
    field({"extractors", "E"}, &Localization::extractors);
    field("extractor", &Localization::extractor);
  }
};

}  // namespace cairn::kinds
