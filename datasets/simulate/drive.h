// A robot's true drive through a world of corridors: where it turned, how far it went, where it pressed its
// button.
#pragma once

#include <cstddef>
#include <vector>

#include "datasets/common/control.h"
#include "datasets/simulate/world.h"
#include "schema/rng.h"

namespace cairn::datasets {

struct Contact {
  std::size_t control = 0;   // at the end of which it happened
  std::size_t landmark = 0;  // node of the world
};

struct Drive {
  Pose start;
  std::vector<Control> controls;
  std::vector<double> times_s;  // end of each control; the drive starts at 0
  std::vector<Contact> contacts;
  std::vector<std::size_t> passes;  // the nodes that were passed, in order, detected or not
  double length_m = 0;
};

struct DriveOptions {
  double min_length_m = 1000;         // the drive ends at the first node after it
  double step_m = 0.33;               // distance of one control
  double contact_probability = 0.97;  // at each pass of a node
  double pass_sd_m = 0.3;             // distance between robot and node at the pass, an axis
};

// Starts anywhere in a corridor and wanders without U-turns but at dead ends, going straight on twice as
// often as round a corner. At its first chance it goes once round the big cycle. Every pass ends a control.
Drive DrawDrive(const CorridorWorld& world, const DriveOptions& options, Rng& rng);

}  // namespace cairn::datasets
