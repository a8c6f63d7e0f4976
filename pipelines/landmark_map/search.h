// The way out of bad optima: EM from several starts, of which the data choose one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipelines/landmark_map/landmarks/summary.h"
#include "pipelines/landmark_map/state/schedule.h"

namespace cairn::landmark_map {

// Where EM starts from.
struct StartingPoint {
  double drift_rad_per_m = 0.0;  // constant, taken off the first robot's odometry
  double prefix = 1.0;           // fraction of the data in the first iteration
};

// One a candidate. The drifts are spread evenly over two standard deviations of the nominal one to either
// side, twice: the first half of the candidates starts with the settings' fraction of the data, the second
// with less.
std::vector<StartingPoint> StartingPoints(const Settings& settings);

// Where EM of the first robot ended from one start.
struct Candidate {
  StartingPoint start;
  double drift_rad_per_m = 0.0;  // in the end
  double log_likelihood = 0.0;
  std::vector<Landmark> landmarks;
  std::optional<std::string> failure;  // why EM could not go on
  int refit_of = -1;                   // another candidate, of whose map a landmark was left out
  // Which landmark each of the first robot's observations is of, under this map; -1: none.
  std::vector<std::int32_t> associations;
};

// The log-likelihood, less the logarithm of the number of places for each landmark: another landmark raises
// the likelihood of any map, so it must pay for being told where it stands; and less what the drift's prior
// says against the drift that was found: with a drift that is large enough a square is a triangle.
double ScoreOf(const Candidate& candidate, const Settings& settings);

// Do both maps say alike which observations are of one landmark? Where their landmarks stand does not matter:
// maps that are bent differently are one map. So many observations must be `alike`, as a share of all.
bool SameMap(const Candidate& a, const Candidate& b, double alike);

struct Choice {
  int best = 0;
  // By how many nats the best one's score exceeds that of the best one with another map; none: all agree.
  std::optional<double> lead_nats;
  int support = 0;  // starts, refits not counted, that ended in the best one's map
  int starts = 0;   // of so many
};

// Throws InputError, the first candidate's, where all failed. Of equals the first is best.
Choice Choose(const std::vector<Candidate>& candidates, const Settings& settings);

// What to try next, around the best candidate: starts from odometry whose drifts lie between its own and
// those that were tried, or beyond them all, and refits of its map, each without one of the landmarks that
// were seen least.
struct Proposal {
  StartingPoint start;
  std::optional<std::size_t> without;  // index of the landmark to leave out of the best one's map
};
std::vector<Proposal> ProposalsAround(const std::vector<Candidate>& candidates, int best,
                                      const Settings& settings);

// What to try where too few starts agree on the best map: starts from odometry with drifts beyond all that
// were tried, up to twice as far to either side, to eight nominal standard deviations. Data sheets err, and a
// drift that no start comes near cannot be found from a map that is wrong. `increment_m`, the distance from
// one observation to the next, ends it where a drift turns the robot by an eighth of a circle on one: that
// makes other polygons of the same way.
inline constexpr int kEnoughSupport = 3;
// What all candidates may take for another wave to follow: of one core, reckoned from sizes.
inline constexpr double kEnoughSeconds = 20.0;
std::vector<Proposal> ProposalsBeyond(const std::vector<Candidate>& candidates, const Settings& settings,
                                      double increment_m);

// What to try where too few starts agree, or the best map looks open: starts that have all the data at once,
// whose drifts lie four times as near to one another, to one step on either side. Starts that begin with a
// little of the data and grow may all bend the path as each new stretch bids, and take what they come back to
// for new: with all data at once the loop draws from the first iteration on, but only to a drift that is
// near. None where starts began with more than a little, or this was tried.
std::vector<Proposal> ProposalsAtOnce(const std::vector<Candidate>& candidates, const Settings& settings);

// Whether at some moment few of the landmarks that were seen before are seen again (schema/kinds/
// few_in_common.h): so it is where a loop was not closed.
bool LooksOpen(const Candidate& candidate);

// What the result says of the search; fields as in schema/FORMAT.md, search/.
Blob ToBlob(const std::vector<Candidate>& candidates, const Choice& choice, const Settings& settings);

// The same where EM started once, from odometry: nothing to compare with.
Blob OneStartOnly();

std::string Sentence(const std::vector<Candidate>& candidates, const Choice& choice);

}  // namespace cairn::landmark_map
