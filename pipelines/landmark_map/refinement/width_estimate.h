// How wide the errors of odometry and of sightings are, by what the least squares leave of them.
#pragma once

#include "pipelines/landmark_map/refinement/least_squares.h"

namespace cairn::landmark_map {

// One step of the estimate of all widths by redundancy: what the residuals are, in units of their widths,
// over what they are expected to be where as many unknowns as there are fit themselves to them (W. Foerstner,
// Ein Verfahren zur Schaetzung von Varianz- und Kovarianzkomponenten, 1979). A width's logarithm has a prior
// around that of the one expected, which may well be wrong by a factor of three. Returns by what factor one
// has changed at most; 0: the equations have no solution. Before that the problem gets RepeatsIn and TailOf.
inline constexpr double kLogWidthSd = 1.0;
struct ExpectedWidths {
  std::vector<EdgeWidths> odometry;  // [robots]
  ObservationNoise sightings;
};
double ReestimateWidths(const ExpectedWidths& expected, const LeastSquaresPoint& point,
                        LeastSquaresProblem* problem);

// From how many standard deviations on sightings have a Cauchy's tails, kCauchySigmas at least and 10 at
// most, which are hardly tails: the likeliest by their residuals. Weights that clip what honestly erred so
// far lose from 3 standard deviations on 3.4% of what Gaussian sightings tell, from 10 on 0.1%.
double TailOf(const LeastSquaresProblem& problem, const LeastSquaresPoint& point);

// The least with the widths, repeats and tails that it shows. False: there is no solution.
bool SettleWidths(const ExpectedWidths& expected, LeastSquaresProblem* problem, LeastSquaresEnd* end);

// The same with odometry's widths alone: what sightings err by stays, and how they repeat.
bool SettleOdometryWidths(const std::vector<EdgeWidths>& expected, LeastSquaresProblem* problem,
                          LeastSquaresEnd* end);

// Minus the logarithm of how likely the measurements are under the problem's widths, whatever the unknowns
// are (about their likeliest values, as Laplace has it), and of the widths' prior, up to a constant [nats]:
// between problems of the same nodes and sightings it tells which model of their errors holds. Wide errors of
// odometry explain what any other mistake leaves, and cost what they leave open.
double NegativeLogEvidence(const std::vector<EdgeWidths>& expected, const LeastSquaresProblem& problem,
                           const LeastSquaresPoint& point);

// By the correlation of successive errors, (1 + r) / (1 - r) of a first-order process; 1 where that is not
// significant.
SightingRepeats RepeatsIn(const LeastSquaresProblem& problem, const LeastSquaresPoint& point);

}  // namespace cairn::landmark_map
