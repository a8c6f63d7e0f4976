// How far a landmark_map can be trusted.
#pragma once

#include <string>

#include "datasets/verdicts/verdict.h"
#include "schema/blob.h"

namespace cairn::datasets {

// Of a landmark_map by its search alone: by how many starts found the best map (search/support) and by how
// many nats it is ahead of the next different one (search/lead_nats): high from three starts and ten nats on,
// fair from two starts and three nats on. How often each was right on simulated logs
// pipelines/landmark_map/EXPERIMENTS.md says; of other logs and options nobody knows.
Confidence ReadConfidence(const Blob& result);

// Of a landmark_map with landmarks that observations name and that are seen at a distance: whether the least
// squares explains them (`fit/`). High: at least 50, nine tenths of all that were made, at most 3% do not
// fit, none of them by six standard deviations, no five in a row; odometry fits everywhere; ranges and
// bearings err by at most 1.5 times what is stated; odometry's distances are within 7% of what the
// observations say, its turns within 15%; two landmarks or more are seen both before and after any time; no
// landmark may be more than 1 m off by its own covariance (95%). Low: a fifth do not fit, or ranges and
// bearings err by three times what is stated, or the distances are 15% off. Chosen on simulated figures of
// eight; how often it is right of other logs was not measured. Of landmarks without names at a distance: what
// the search says or the fit, whichever is less, and fair at most; low where ranges or bearings err by 1.5
// times and less than half of the starts found the map, or where none has a name and odometry does not fit,
// or most are seen on one side of a moment alone (landmarks_on_one_side.h). Low, too, where the place of a
// robot among the others rests on landmarks without names and is not ten nats ahead of the next one, or of
// none (place_lead_nats), or by less than nine to one is not chance (place_odds_nats; 99 to one: fair); where
// a sensor's clock takes the path further off than it says of itself; where less than half of the
// observations are of a landmark; where three landmarks or more, and a fifth of what either side saw and both
// looked at, are seen by one robot alone or by all but it (a tenth: fair at most); where odometry and
// observations contradict each other; where a map is not ten nats behind in which what one robot saw before,
// or between, long ways without landmarks is shifted along their pattern (fit/shift_lead_nats). At most fair
// where such a map was taken instead of EM's, and where odometry lacks some way (`holes/`), low where what
// was seen before and after does not hold together as robots must. Of any other: what its search says, how
// many observations its landmarks explain, whether its refinement was refused. Of a map of a log, and with
// options, like those on which the rates were measured (search/unlike is there and empty): "high: right in 99
// of 100 such simulations, which have no false observations; found from 6 of 12 starts, 57.2 nats ahead of
// the next different map". Of another it is not known, and says in what it differs. No lead says that a
// better map, which was not tried, does not exist.
Verdict LandmarkMapVerdict(const Blob& result);

// Why the landmarks of a map are not those of the least squares over its associations (refinement/reason):
// "refused: the weighted squares of its residuals rose from 210.4 to 388.0", "not tried: refine=false". Empty
// where they are, or where the file does not say.
std::string NotRefined(const Blob& result);
// True where that was tried and its outcome thrown away.
bool RefinementRefused(const Blob& result);
// True where no path explains both odometry and observations.
bool OdometryContradicts(const Blob& result);

}  // namespace cairn::datasets
