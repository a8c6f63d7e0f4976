// A file of kind `networks` (schema/FORMAT.md) as evaluation needs it, and what the networks make of
// samples: a forward pass of its own, in double, so that it also checks the code that trained them.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn::datasets {

struct LearnedNetworks {
  std::size_t networks = 0, hidden = 0, inputs = 0;
  std::size_t hidden_2 = 0;             // of the second hidden layer; 0: there is none
  std::vector<double> hidden_weight;    // [networks][hidden][inputs]
  std::vector<double> hidden_bias;      // [networks][hidden]
  std::vector<double> hidden_2_weight;  // [networks][hidden_2][hidden]
  std::vector<double> hidden_2_bias;    // [networks][hidden_2]
  std::vector<double> output_weight;    // [networks][units of the last hidden layer]
  std::vector<double> output_bias;      // [networks]
  std::vector<double> input_mean, input_scale;
  std::vector<std::string> input_name;

  // The samples that they were trained on, [samples] each.
  std::vector<double> x_m, y_m;
  std::vector<std::int32_t> run;  // an index into `runs`
  std::vector<double> output;     // [samples][networks], in [0, 1]
  std::vector<std::string> runs;
  std::set<std::int64_t> known;     // SamplesKnownTo; empty in older files
  double window_m = 0;              // of the belief that they were trained for; 0: globally uncertain
  std::vector<double> heading_rad;  // of the samples; empty in older files, and where it is not known
  double heading_window_deg = 180;  // of that belief; 180: samples that face whichever way

  std::size_t samples() const { return x_m.size(); }
};

// At most this many networks: there are 2^n feature vectors.
inline constexpr std::size_t kMostNetworks = 12;

// Throws InputError that names the array: one that is missing, of a shape that does not fit the others, with
// a value that is no number (and which), a scale that is not above 0, an output that is no probability, no
// training samples, no or too many networks.
LearnedNetworks ReadLearnedNetworks(const Blob& file);

// g_i of each row of `input`, [rows][inputs]: [rows][networks]. [Thr98] section 4.1.
std::vector<double> OutputsOf(const LearnedNetworks& nets, std::span<const float> input);

}  // namespace cairn::datasets
