#include "schema/kinds/tables.h"

namespace cairn {
namespace {

constexpr ArraySpec kSamples[] = {
    {"runs", "R", text},
    {"input_name", "I", text},
    {"run/N/time_s", "K", f64, Rising()},
    {"run/N/x_m", "K", f64, Position()},
    {"run/N/y_m", "K", f64, Position()},
    {"run/N/heading_rad", "K", f64, Finite()},
    {"run/N/odometry/turn_rad", "K", f64, Free()},  // of the first sample not looked at
    {"run/N/odometry/forward_m", "K", f64, Free()},
    {"run/N/odometry/left_m", "K", f64, Free()},
    {"run/N/input", "K,I", f32, Finite()},
    {"run/N/weight", "K", f64, From(0)},
    {"run/N/image", "K,rows,columns,3", u8, Free()},
    {"feature_name", "F", text},
    {"run/N/feature", "K,F", f32, Share()},
    {"label_error_m", "", f64, NotNegative()},
    {"truth/run/N/x_m", "K", f64, Position()},
    {"truth/run/N/y_m", "K", f64, Position()},
    {"truth/run/N/heading_rad", "K", f64, Finite()},
};

constexpr ArraySpec kErrors[] = {
    {"position/x_m", "P", f64, Position()},
    {"position/y_m", "P", f64, Position()},
    {"error", "P,P", f64, From(0)},
};

constexpr ArraySpec kNetworks[] = {
    {"networks/hidden_weight", "n,H,I", f64, Finite()},
    {"networks/hidden_bias", "n,H", f64, Finite()},
    {"networks/hidden_2_weight", "n,H2,H", f64, Finite()},
    {"networks/hidden_2_bias", "n,H2", f64, Finite()},
    {"networks/output_weight", "n,J", f64, Finite()},
    {"networks/output_bias", "n", f64, Finite()},
    {"networks/input_mean", "I", f64, Finite()},
    {"networks/input_scale", "I", f64, Above0()},
    {"networks/input_name", "I", text},
    {"map/x_m", "K", f64, Position()},
    {"map/y_m", "K", f64, Position()},
    {"map/along_m", "K", f64, NotNegative()},
    {"map/heading_rad", "K", f64, Finite()},
    {"map/run", "K", i32, IndexInto("runs")},
    {"map/output", "K,n", f32, Share()},
    {"runs", "R", text},
    {"history/training_error_m", "S", f64, Finite()},
    {"history/validation_error_m", "S", f64, Finite().OrNan()},
    {"history/gradient_norm", "S", f64, Finite()},
    {"prior_error_m", "", f64, Finite()},
    {"validation_prior_error_m", "", f64, Finite().OrNan()},
    {"window_m", "", f64, NotNegative()},
    {"heading_window_deg", "", f64, NotNegative()},
    {"options", "O", text},
    {"warnings", "W", text},
    {"starts/error_m", "C", f64, Finite()},
    {"starts/chosen", "", i64, IndexInto("starts/error_m")},
    {"ancestry/hash", "A", text},
    {"ancestry/options", "A", text},
    {"ancestry/steps", "A", i64, From(0)},
    {"ancestry/training_error_m", "A", f64, Finite().OrNan()},
    {"ancestry/prior_error_m", "A", f64, Finite().OrNan()},
};

constexpr ArraySpec kLocalization[] = {
    {"step/traverse", "S", i32, Rising()},
    {"step/run", "S", i32, IndexInto("runs")},
    {"step/sample", "S", i32, From(0)},
    {"step/travelled_m", "S", f64, NotNegative()},
    {"step/mean_x_m", "S", f64, Position()},
    {"step/mean_y_m", "S", f64, Position()},
    {"step/mode_x_m", "S", f64, Position()},
    {"step/mode_y_m", "S", f64, Position()},
    {"step/spread_m", "S", f64, NotNegative()},
    {"step/entries", "S", i64, RowsOf("belief/position")},
    {"belief/position", "B", i32, IndexInto("position/x_m")},
    {"belief/probability", "B", f32, Share()},
    {"position/x_m", "P", f64, Position()},
    {"position/y_m", "P", f64, Position()},
    {"position/heading_rad", "P", f64, Finite()},
    {"heading", "", text},
    {"runs", "R", text},
    {"feature_name", "F", text},
    {"samples_hash", "", text},
    {"window_m", "", f64, NotNegative()},
};

constexpr ArraySpec kProvenance[] = {
    {"provenance/seconds_s", "", f64, From(0)},
    {"provenance/job_yaml", "", text},
    {"provenance/job", "B", u8, Free()},
    {"provenance/stage", "", text},
    {"provenance/version", "", text},
    {"provenance/workers", "", i64, From(0)},
    {"provenance/round/note", "M", text},
    {"provenance/round/rounds", "M", i64, From(0)},
    {"provenance/round/tasks", "M", i64, From(0)},
    {"provenance/round/seconds_s", "M", f64, From(0)},
    {"provenance/round/compute_s", "M", f64, From(0)},
    {"provenance/kind", "", text},
    {"provenance/build", "", text},
    {"provenance/finished_utc", "", text},
    {"provenance/hosts", "H", text},
    {"provenance/retries", "", i64, From(0)},
};

}  // namespace

std::span<const ArraySpec> SamplesArrays() { return kSamples; }
std::span<const ArraySpec> ErrorArrays() { return kErrors; }
std::span<const ArraySpec> NetworkArrays() { return kNetworks; }
std::span<const ArraySpec> LocalizationArrays() { return kLocalization; }
std::span<const ArraySpec> ProvenanceArrays() { return kProvenance; }

}  // namespace cairn
