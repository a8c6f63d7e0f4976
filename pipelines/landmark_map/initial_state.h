// What there is before the first round: settings, schedule, and the map that a job may be given.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipelines/landmark_map/round.h"
#include "pipelines/landmark_map/state/given_map.h"
#include "pipelines/landmark_map/state/schedule.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

struct InitialState {
  Settings settings;
  Schedule schedule;
  std::optional<GivenMap> given;
  std::optional<Perception> perception;  // of the given map
};

// From the stage's inputs. With a map all robots take part from the first round on, with all data.
// Throws InputError where the options need a map and there is none, or do not go with one.
// Throws InputError where Resolve or ReadGivenMap do.
InitialState MakeInitialState(const Options& options, const Inputs& inputs);

// Every robot's steps; those that start anywhere begin where they see what the first robot has seen too, or
// what the given map holds. `all`: takes them too.
// Throws InputError where MakeSteps does, and where a robot but the first names all its landmarks and saw a
// single one that another robot saw, too.
RobotStates MakeAllSteps(const Blob& log, const Options& options, const InitialState& initial,
                         cairn::Step* step, std::vector<RobotSteps>* all);

// The round's own blobs of the first round.
std::map<std::string, Blob> FirstBlobs(const InitialState& initial);

// Robots but the first start anywhere ([TBF98] section 8), that one too where it is asked for.
bool StartsAnywhere(const Options& options, std::size_t robot);

}  // namespace cairn::landmark_map
