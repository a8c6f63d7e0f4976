// What a lying worker says: wrong hashes, wrong shapes, answers to tasks that were never its own, and, in
// some worlds, wrong answers that look right.
#pragma once

#include <string>
#include <vector>

#include "coordinator/core/events.h"
#include "tests/simulation/toy.h"

namespace cairn::simulation {

class World;

// One message of a worker. `whole`: its blobs are what their hashes say.
struct Answer {
  coordinator::Event event;
  bool whole = true;
};

// What an honest worker says to `assign`.
Answer TellTruth(const std::string& peer, const wire::Assign& assign, const ToyAnswer& toy);
// What a liar says instead, or besides.
std::vector<Answer> TellLies(World& world, const std::string& peer, const wire::Assign& assign,
                             const ToyAnswer& toy);

}  // namespace cairn::simulation
