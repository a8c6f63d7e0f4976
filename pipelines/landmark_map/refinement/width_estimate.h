// How wide the errors of odometry and of sightings are, by what the least squares leave of them.
#pragma once

#include "pipelines/landmark_map/refinement/least_squares.h"

namespace cairn::landmark_map {

// One step of the estimate of all widths by redundancy: what the residuals are, in units of their widths,
// over what they are expected to be where as many unknowns as there are fit themselves to them (W. Foerstner,
// Ein Verfahren zur Schaetzung von Varianz- und Kovarianzkomponenten, 1979). A width's logarithm has a prior
// around that of `nominal`, which may well be wrong by a factor of three. Returns by what factor one has
// changed at most; 0: the equations have no solution.
inline constexpr double kLogWidthSd = 1.0;
double ReestimateWidths(const LeastSquaresProblem& nominal, const LeastSquaresPoint& point,
                        LeastSquaresProblem* problem);

// By the correlation of successive errors, (1 + r) / (1 - r) of a first-order process; 1 where that is not
// significant.
SightingRepeats RepeatsIn(const LeastSquaresProblem& problem, const LeastSquaresPoint& point);

}  // namespace cairn::landmark_map
