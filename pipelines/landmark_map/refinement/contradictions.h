// Data that no map of this method explains: refused with the reason, instead of a map that looks right. Holes
// in the odometry, and observations that are all the same, are named with it (schema/kinds/).
#pragma once

#include <string>
#include <vector>

#include "pipelines/landmark_map/refinement/model_fit.h"
#include "pipelines/landmark_map/state/partial.h"
#include "schema/geometry.h"

namespace cairn::landmark_map {

// A landmark with an identity stands in one place: those of which a quarter of what was expected, and four
// observations at least, lies around a second one. Identities were mixed up, or a robot lost its way.
struct InTwoPlaces {
  int type = 0;
  double apart_m = 0.0;
  std::string reason;  // names it and both places
  Point main, other;   // where most of it is expected, and where the next most
};
std::vector<InTwoPlaces> LandmarksInTwoPlaces(const LayeredGrid& counts, const MapRules& rules,
                                              const Blob& log);

// Of those that EM finds in two places, least squares may find the one: where all but a quarter of a
// landmark's observations lie within a quarter of the way from one to the other, or most of that quarter lies
// scattered, as false observations do, and not in a place.
// Those that stay in two. `fit`: nullptr where there was no least squares.
std::vector<InTwoPlaces> StillInTwoPlaces(const std::vector<InTwoPlaces>& found,
                                          const std::vector<Landmark>& landmarks, const ModelFit* fit);

// Robots that one map does not explain.
class RobotsContradictError : public InputError {
 public:
  using InputError::InputError;
};

// Of robots that start anywhere, in their first round, each under a map that is not its own.
// Throws RobotsContradictError that names the robot where the map makes its observations no likelier than if
// every one were false, but for kLeastGain nats an observation: it was somewhere else, and would be laid over
// the map where it fits least badly.
inline constexpr double kLeastGain = 0.25;
void CheckRobotsFitTheMap(const RoundSum& sum, const std::vector<Perception>& perceptions,
                          const std::vector<RobotSteps>& steps, const Blob& log);

// At the end. A robot that was somewhere else adds to the map what is not there, which the first robot's data
// feel. EXPERIMENTS.md says why it is 0.29: robots of one place cost at most 0.27 nats an observation, one of
// another place 0.31 or more in ten of eleven.
// Throws RobotsContradictError where they lost more than kMostLoss nats an observation against the first
// robot's own map
// (`history`: of all rounds), and more than being told one of `places` costs.
inline constexpr double kMostLoss = 0.29;
void CheckRobotsAgree(const RoundSum& sum, const Blob& history, double places, std::size_t observations,
                      const Blob& log);

}  // namespace cairn::landmark_map
