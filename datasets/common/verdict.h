// How far a result can be trusted, and why: what its page, the summary of a run and `--json` say first.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "schema/blob.h"

namespace cairn::datasets {

// kNone: it is not known.
enum class Confidence { kNone, kLow, kFair, kHigh };

// Of a landmark_map by its search alone: by how many starts found the best map (search/support) and by how
// many nats it is ahead of the next different one (search/lead_nats): high from three starts and ten nats on,
// fair from two starts and three nats on. How often each was right on simulated logs
// pipelines/landmark_map/EXPERIMENTS.md says; of other logs and options nobody knows.
Confidence ReadConfidence(const Blob& result);

const char* Word(Confidence confidence);  // "not known", "low", "fair", "high"

struct Verdict {
  Confidence trust = Confidence::kNone;
  std::string why;                                           // "513 loops closed, none contradicted"
  std::vector<std::pair<std::string, double>> numbers = {};  // what it rests on, with units in the names

  std::string Text() const;  // "high: 513 loops closed, none contradicted"
};

// Of a landmark_map with landmarks that observations name and that are seen at a distance: whether the least
// squares explains them (`fit/`). High: at least 50, nine tenths of all that were made, at most 3% do not
// fit, none of them by six standard deviations, no five in a row; odometry fits everywhere; ranges and
// bearings err by at most 1.5 times what is stated; odometry's distances are within 7% of what the
// observations say, its turns within 15%. Low: a fifth do not fit, or ranges and bearings err by three times
// what is stated, or the distances are 15% off. Chosen on simulated figures of eight; how often it is right
// of other logs was not measured. Of landmarks without names at a distance: what the search says or the fit,
// whichever is less, and fair at most; low where ranges or bearings err by 1.5 times and less than half of
// the starts found the map. Of any other: what its search says, how many observations its
// landmarks explain, whether its refinement was refused. Of a map of a log, and with options, like those on
// which the rates were measured (search/unlike is there and empty): "high: right in 99 of 100 such
// simulations; found from 6 of 12 starts, 57.2 nats ahead of the next different map". Of another it is not
// known, and says in what it differs. No lead says that a better map, which was not tried, does not exist.
Verdict LandmarkMapVerdict(const Blob& result);

// Of a local_map: how many loops its path closes, how many contradict it, and how many go over the time over
// which the fewest do, for where a robot slipped or was carried what is before and after hangs together by
// chance alone (ends left out). High: 20 loops over every time, ten of which tell how far along each axis, at
// most a fiftieth contradict the path. Low: fewer than five, or more than a fifth, or walls that do not stand
// at right angles as the path supposes (wall_turns.h). How often each was right on simulated offices
// pipelines/local_map/EXPERIMENTS.md says. Not known where no loop was found.
Verdict LocalMapVerdict(const Blob& result);

// Of a grid_map: by how many nats readings that were left out are likelier in the map of the others than in
// one that knows nothing (`fit/`), whether the search ended by itself, how many readings the map explains.
// Whether the poses are right it cannot tell: not known. Low: by less than 0.1.
Verdict GridMapVerdict(const Blob& result);

// Of networks: by how much they reduce the error of a robot that senses nothing (which is what a detector
// that always says the same leaves it at) on the run that was held out, beside those that they were trained
// on, at the step whose weights are kept. Fair: at least half as much; never high, for that run chose the
// step. Low: less. Not known where no run was held out.
Verdict NetworksVerdict(const Blob& result);

// Why the landmarks of a map are not those of the least squares over its associations (refinement/reason):
// "refused: the weighted squares of its residuals rose from 210.4 to 388.0", "not tried: refine=false". Empty
// where they are, or where the file does not say.
std::string NotRefined(const Blob& result);
// True where that was tried and its outcome thrown away.
bool RefinementRefused(const Blob& result);

}  // namespace cairn::datasets
