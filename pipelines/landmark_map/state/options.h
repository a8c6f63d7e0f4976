// What a person can set of landmark_map.
#pragma once

#include <cstdint>
#include <string>

#include "pipelines/common/options.h"

namespace cairn::landmark_map {

struct Options {
  double cell_m = 0.0;
  double heading_deg = 0.0;
  std::int64_t iterations = 10;
  double tolerance = 5e-3;
  std::int64_t prefix_observations = 0;
  double growth_start = 0.0;
  double growth_factor = 0.0;
  bool calibrate = true;
  bool revise = true;
  bool incremental = false;
  bool refine = true;
  bool beliefs = false;
  std::int64_t starts = 0;
  std::int64_t waves = 6;
  std::int64_t first_robots = 0;
  std::string start = "origin";
  std::string model = "robust";
  std::string motion_error = "gaussian";
  double prune = 1e-3;
  double max_increment_m = 0.0;
  bool keep_kernels = false;
  std::string tables = "boxes";
  double radius_m = 0.0;
  double core_m = 0.0;
  double prior_count = 0.03;
  double no_landmark = 0.5;
  double false_rate_per_m2 = 1e-3;
  double noise_scale = 1.0;
  double drift_length_m = 0.0;
  double box_m = 0.0;
  double memory_mb = 4096;
  double slice_mcells = 8.0;
  bool speculate = true;
};

template <class V>
void VisitOptions(V& visit, Options& o) {
  visit(Option{"cell_m", "m", 0, 100,
               "edge of a map cell; 0: a 90th of the first robot's extent, or of how far it sees where that "
               "is more, on which several starts are searched "
               "even where this is finer; of range-bearing observations without identity whose log states no "
               "drift as fine as one range-bearing observation is exact, down to a fifth of that"},
        o.cell_m);
  visit(Option{"heading_deg", "deg", 0, 45, "step of the heading grid; 0: 5, finer for range and bearing"},
        o.heading_deg);
  visit(
      Option{
          "iterations", "", 0, 10000,
          "EM iterations over all data; 0: none, robots are found in the input map, or, without one, where "
          "odometry says"},
      o.iterations);
  visit(Option{"tolerance", "nats", 0, 1,
               "stop where an iteration changes the log-likelihood by less, an observation"},
        o.tolerance);
  visit(Option{"prefix_observations", "observations", 0, 1e9,
               "the data end with the observation of this number, of all robots in the order of time; 0: all "
               "data"},
        o.prefix_observations);
  visit(Option{"growth_start", "", 0, 1,
               "fraction of the data in the first iteration; 0: by the kind of sensor and how far odometry "
               "can be trusted"},
        o.growth_start);
  visit(Option{"growth_factor", "", 0, 100,
               "by how much that fraction grows an iteration; 0: 2 with identities, 1.3 without"},
        o.growth_factor);
  visit(Option{"calibrate", "", 0, 0,
               "estimate each robot's heading drift, walk and turn errors in the M-step"},
        o.calibrate);
  visit(
      Option{"revise", "", 0, 0,
             "false: every E-step takes alpha in place of alpha beta. EM still goes over all data again and "
             "again: a pose owes nothing to later data but for the map that it is found in"},
      o.revise);
  visit(
      Option{
          "incremental", "", 0, 0,
          "one pass forward in place of EM, for comparison: each observation is looked at once, in a map of "
          "those before it, and neither the map nor a pose is ever revised (one robot, model robust)"},
      o.incremental);
  visit(Option{"refine", "", 0, 0,
               "in the end landmarks get the positions of least squares over the associations, and paths too "
               "where landmarks are seen at a distance (model robust)"},
        o.refine);
  visit(Option{"beliefs", "", 0, 0,
               "the result also holds each step's belief, added up over headings: robot/N/beliefs"},
        o.beliefs);
  visit(
      Option{"starts", "", 0, 1000,
             "candidate starts of EM, which differ in the drift taken off the first robot's odometry and "
             "in how much data comes first; the data choose one; 0: auto, 1 where every observation names "
             "its landmark and with model exact, else 10, or fewer where the log is long; --dry-run and the "
             "result say how many and why"},
      o.starts);
  visit(
      Option{"waves", "", 0, 1000,
             "how often at most the search goes on: around its best candidate, with starts of drifts near "
             "its own "
             "and refits without one of its landmarks, and, where few starts agree, with drifts further out"},
      o.waves);
  visit(
      Option{
          "first_robots", "", 0, 1000,
          "robots that are tried as the first, in whose map the others are placed, where landmarks seen at a "
          "distance have no names and EM starts more than once: those that looked from most places; the "
          "likelier map of all robots is kept; 0: both of two robots, of more the log's first; 1: the log's "
          "first"},
      o.first_robots);
  visit(Option{"start",
               "",
               0,
               0,
               "where the first robot starts: at the origin, or anywhere in the input map",
               {"origin", "anywhere"}},
        o.start);
  visit(Option{"model",
               "",
               0,
               0,
               "perception: robust, or exact (Bernoulli cells, for contact detections)",
               {"robust", "exact"}},
        o.model);
  visit(Option{"motion_error", "", 0, 0, "shape of odometry's errors", {"gaussian", "triangular"}},
        o.motion_error);
  visit(Option{"prune", "", 0, 0.5,
               "a probability below this share of the largest is dropped (a tenth of it for robots that "
               "start anywhere)"},
        o.prune);
  visit(
      Option{"max_increment_m", "m", 0, 100000,
             "longest distance from one step to the next, longer ones are split; 0: a cell over the heading "
             "step, so that neighbouring headings still overlap"},
      o.max_increment_m);
  visit(Option{"keep_kernels", "", 0, 0,
               "keep a slice's motion kernels from its forward to its backward pass, instead of making them "
               "again"},
        o.keep_kernels);
  visit(Option{"tables",
               "",
               0,
               0,
               "what of a belief is stored and moved: boxes (a bounding box a heading), or whole (all of "
               "box_m under every heading; same results, for comparison)",
               {"boxes", "whole"}},
        o.tables);
  visit(Option{"radius_m", "m", 0, 1000,
               "perceptual radius of landmarks without identity; 0: two thirds of the distance between "
               "contact detections, or of the distance that landmarks keep in images, or what one "
               "range-bearing observation cannot tell apart, whichever is more"},
        o.radius_m);
  visit(Option{"core_m", "m", 0, 1000,
               "landmarks without identity nearer than this are one; 0: a quarter of the radius, of "
               "range-bearing observations what one cannot tell apart"},
        o.core_m);
  visit(Option{"prior_count", "observations", 0, 1000,
               "evidence against a landmark, in expected observations, that each cell starts with (landmarks "
               "without identity, model robust)"},
        o.prior_count);
  visit(Option{"no_landmark", "", 0, 100,
               "weight of the evidence that no other landmark is near a contact detection"},
        o.no_landmark);
  visit(Option{"false_rate_per_m2", "1/m2", 1e-9, 1, "probability of a false observation, per area"},
        o.false_rate_per_m2);
  visit(Option{"noise_scale", "", 0.1, 10, "factor on the log's nominal errors of odometry"}, o.noise_scale);
  visit(
      Option{
          "drift_length_m", "m", 0, 100000,
          "a constant drift is unknown over such a distance, which widens the heading's random walk; 0: 150 "
          "cells, less the nearer the candidate starts' drifts lie"},
      o.drift_length_m);
  visit(
      Option{"box_m", "m", 0, 100000, "edge of the square around the start that robots never leave; 0: none"},
      o.box_m);
  visit(Option{"memory_mb", "MB", 1, 1e9, "largest memory of one task"}, o.memory_mb);
  visit(Option{"slice_mcells", "1e6", 1e-3, 1e6,
               "millions of cells, added up over its steps, in a time slice (a task)"},
        o.slice_mcells);
  visit(
      Option{
          "speculate", "", 0, 0,
          "once the map is sharp, work on a robot's time slices side by side, from guesses of the beliefs at "
          "their ends; false: one after the other"},
      o.speculate);
}

}  // namespace cairn::landmark_map
