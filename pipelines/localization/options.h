// Options of localization, each with unit, range and effect.
#pragma once

#include <cstdint>
#include <string>

#include "pipelines/common/options.h"

namespace cairn::localization {

struct Options {
  std::string runs = {};
  std::string features = {};
  std::string heading = "known";
  std::string belief = "samples";
  double cell_m = 0.25;
  std::int64_t nearest = 5;
  double prior_count = 0.5;
  std::string sensing = "soft";
  double trust = 0.5;
  std::string look = "all";
  double window_m = 0.0;
  std::int64_t traverses = 35;
  double travelled_m = 30.0;
  double every_m = 0.5;
  std::string odometry = "recorded";
  double odometry_ratio = 0.05;
  double motion_m = 0.1;
  double motion_ratio = 0.1;
  double motion_heading_deg = 15.0;
  double lost = 1e-4;
};

template <class V>
void VisitOptions(V& visit, Options& o) {
  visit(Option{"runs", "", 0, 0,
               "the runs of the samples to localise in, by commas; empty: those that the networks were not "
               "trained on"},
        o.runs);
  visit(Option{"features", "", 0, 0,
               "without networks: the hand-made features to use, by commas; empty: all of the samples'"},
        o.features);
  visit(
      Option{
          "heading",
          "",
          0,
          0,
          "what the robot knows of its heading: it compares only with what was seen facing its way; or it "
          "finds that out too, moving by its own forward and left; or headings are not looked at (as where "
          "all samples face one way, or theirs are not known)",
          {"known", "unknown", "ignored"}},
      o.heading);
  visit(Option{"belief",
               "",
               0,
               0,
               "over the training locations, or the cells of a grid around them",
               {"samples", "grid"}},
        o.belief);
  visit(Option{"cell_m", "m", 0.01, 100, "edge of a cell (belief grid)"}, o.cell_m);
  visit(Option{"nearest", "", 1, 1e6, "training samples, of which the features at a position are the mean"},
        o.nearest);
  visit(Option{"prior_count", "", 0, 1e6,
               "samples of either outcome that are added to them; 0: what they all rule out is impossible"},
        o.prior_count);
  visit(Option{"sensing",
               "",
               0,
               0,
               "features enter as their probabilities, or drawn by them (seeded), as the paper has it",
               {"soft", "sampled"}},
        o.sensing);
  visit(Option{"trust", "", 0.001, 1,
               "power of each sensation's likelihood; below 1 where successive ones "
               "err together"},
        o.trust);
  visit(Option{"look",
               "",
               0,
               0,
               "with several networks: all are sensed at each stop, or one, in turn, or the one that leaves "
               "the least error to be expected (active sensing)",
               {"all", "turn", "active"}},
        o.look);
  visit(Option{"window_m", "m", 0, 1e9,
               "what the robot knows of its position at the start: within so much of it (position tracking); "
               "0: nothing (global localisation)"},
        o.window_m);
  visit(Option{"traverses", "", 0, 1e6,
               "runs of the experiment, each from a random position of a run on; 0: each run once, from its "
               "beginning"},
        o.traverses);
  visit(Option{"travelled_m", "m", 0, 1e9, "distance travelled by each; 0: to the run's end"}, o.travelled_m);
  visit(Option{"every_m", "m", 0.001, 1e6, "distance from a sensation to the next"}, o.every_m);
  visit(
      Option{
          "odometry",
          "",
          0,
          0,
          "where displacements come from: the samples' odometry (from their labels, where they have none), "
          "or the labels",
          {"recorded", "labels"}},
      o.odometry);
  visit(Option{"odometry_ratio", "", 0, 10,
               "sd of the error that is put on each displacement by labels, an axis, a share of its length"},
        o.odometry_ratio);
  visit(Option{"motion_m", "m", 0, 1e6, "sd of a displacement in the motion model, an axis"}, o.motion_m);
  visit(Option{"motion_ratio", "", 0, 10, "and a share of its length, added in squares"}, o.motion_ratio);
  visit(Option{"motion_heading_deg", "deg", 0.1, 360,
               "and of the turn from the heading of a position to that of the next, at which samples were "
               "taken as "
               "it came (heading unknown)"},
        o.motion_heading_deg);
  visit(Option{"lost", "", 0, 1, "share of the belief that goes anywhere at each displacement"}, o.lost);
}

}  // namespace cairn::localization
