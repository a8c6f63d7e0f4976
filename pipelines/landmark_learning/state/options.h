// Options of landmark_learning, each with unit, range and effect.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "pipelines/common/options.h"

namespace cairn::landmark_learning {

struct Options {
  std::int64_t networks = 4;
  std::int64_t hidden = 6;
  std::int64_t hidden_2 = 0;
  double window_m = 2.0;
  std::string belief = "uniform";
  double heading_window_deg = 180.0;
  std::string error = "distance";
  double smooth_m = 0.5;
  std::string true_positions = "samples";
  double cell_m = 0.0;
  std::string sum = "auto";
  std::string method = "adam";
  double rate = 0.0;
  double momentum = 0.9;
  double weight_decay = 1e-4;
  double init_width = 0.1;
  double input_noise = 0.0;
  std::int64_t steps = 1000;
  std::int64_t starts = 1;
  std::int64_t start_steps = 0;
  std::int64_t batch = 0;
  bool sequential = false;
  std::int64_t pattern_steps = 100;
  double pattern_step = 1.0;
  std::string holdout = {};
  std::string unseen = {};
  std::int64_t validate_every = 20;
  std::int64_t patience = 10;
};

template <class V>
void VisitOptions(V& visit, Options& o) {
  visit(Option{"networks", "", 1, 12, "networks, each a binary feature"}, o.networks);
  visit(Option{"hidden", "", 1, 1000, "hidden units of each"}, o.hidden);
  visit(Option{"hidden_2", "", 0, 1000, "units of a second hidden layer of each; 0: there is none"},
        o.hidden_2);
  visit(Option{"window_m", "m", 0, 1e9,
               "what the robot knows of its position before it senses: within so much of it (gaussian: its "
               "standard "
               "deviation); 0: nothing"},
        o.window_m);
  visit(Option{"belief", "", 0, 0, "its shape", {"uniform", "gaussian"}}, o.belief);
  visit(
      Option{"heading_window_deg", "deg", 0, 180,
             "and of its heading: beliefs hold samples that were taken facing within so much of the robot's "
             "heading; 180: whichever way"},
      o.heading_window_deg);
  visit(
      Option{
          "error",
          "",
          0,
          0,
          "what a wrong position costs: the distance, its square, the difference of the distances travelled "
          "until there, the path through a map (input map), what a table says (input errors), or, of the "
          "whole belief, -log of its mass around the truth (Kullback-Leibler)",
          {"distance", "squared", "along", "travel", "table", "kl"}},
      o.error);
  visit(Option{"smooth_m", "m", 1e-6, 1e9,
               "standard deviation of the bell around the truth that weighs the mass (error kl)"},
        o.smooth_m);
  visit(
      Option{
          "cell_m", "m", 0, 1e6,
          "beliefs and P(f | position) are of square cells so large, for training alone: the sum's cost no "
          "longer grows "
          "with the number of samples in one (always over pairs; not with batch, nor method conjugate); "
          "0: of the samples"},
      o.cell_m);
  visit(Option{"true_positions",
               "",
               0,
               0,
               "how true positions are weighed: each sample alike, each half metre of space alike, or by the "
               "samples' array weight",
               {"samples", "space", "file"}},
        o.true_positions);
  visit(
      Option{"sum",
             "",
             0,
             0,
             "how pairs are summed: all in reach, by sums along a line (forced, on positions that are near "
             "one), "
             "by a tree over the plane (where nothing is known before, each distance to 1e-5), or whichever "
             "exact or error-bounded way the number and positions of samples make cheapest",
             {"auto", "pairs", "line", "tree"}},
      o.sum);
  visit(Option{"method",
               "",
               0,
               0,
               "how weights follow the gradient",
               {"gradient", "momentum", "adam", "conjugate", "pseudo"}},
        o.method);
  visit(Option{"rate", "", 0, 1e6,
               "learning rate (pseudo: of the fit; conjugate: root mean square of the first step); 0: the "
               "method's own"},
        o.rate);
  visit(
      Option{"momentum", "", 0, 0.999999, "share of the last step that goes into the next (method momentum)"},
      o.momentum);
  visit(Option{"weight_decay", "", 0, 1, "share of each weight that a step at rate 1 takes off"},
        o.weight_decay);
  visit(
      Option{
          "batch", "true positions", 0, 1e9,
          "true positions that a step draws, in stretches of 64; 0: all (methods gradient, momentum, adam)"},
      o.batch);
  visit(
      Option{
          "sequential", "", 0, 0,
          "networks are trained one after another, each with an even share of the steps (methods gradient, "
          "momentum, adam)"},
      o.sequential);
  visit(Option{"pattern_steps", "", 1, 1e6, "steps of backpropagation between two gradients (method pseudo)"},
        o.pattern_steps);
  visit(
      Option{
          "pattern_step", "", 1e-9, 1e9,
          "how far a target lies down the slope of the error summed over the true positions (method pseudo)"},
      o.pattern_step);
  visit(Option{"init_width", "", 1e-6, 100, "weights begin evenly within so much of zero"}, o.init_width);
  visit(Option{"input_noise", "", 0, 100,
               "noise on the inputs at each step, in standard deviations of each, against learning by heart "
               "(methods gradient, momentum, adam)"},
        o.input_noise);
  visit(Option{"steps", "", 1, 1e9, "gradient steps"}, o.steps);
  visit(
      Option{"starts", "", 1, 64,
             "sets of random weights that training begins with, side by side; the one with the least error, "
             "of the held-out run where there is one, goes on (not with sequential, input weights, nor "
             "method conjugate)"},
      o.starts);
  visit(Option{"start_steps", "steps", 0, 1e9, "after which starts are compared; 0: a fifth of all steps"},
        o.start_steps);
  visit(
      Option{"holdout", "", 0, 0,
             "the run that is not trained on but decides when to stop; empty: none, and all steps are made"},
      o.holdout);
  visit(Option{"unseen", "", 0, 0,
               "runs, by commas, that training does not look at, to score with later; empty: none"},
        o.unseen);
  visit(Option{"validate_every", "steps", 1, 1e9, "how often the held-out run is looked at"},
        o.validate_every);
  visit(
      Option{"patience", "", 1, 1e9, "looks at the held-out run without a better one before training stops"},
      o.patience);
}

// The learning rate, where the options leave it to the method.
inline double RateOf(const Options& o) {
  if (o.rate > 0.0) return o.rate;
  if (o.method == "gradient") return 8.0;
  if (o.method == "momentum") return 4.0;
  return o.method == "pseudo" ? 4.0 : 0.01;
}

// After how many steps starts are compared, where the options leave it open.
inline std::int64_t StartStepsOf(const Options& o) {
  return o.start_steps > 0 ? o.start_steps : std::max<std::int64_t>(1, o.steps / 5);
}

}  // namespace cairn::landmark_learning
