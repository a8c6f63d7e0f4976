#include "pipelines/landmark_learning/sum_path.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "pipelines/landmark_learning/far_field.h"
#include "pipelines/landmark_learning/line_sums.h"
#include "schema/error.h"

namespace cairn::landmark_learning {
namespace {

// Samples projected onto the line through the first one and the one that is farthest from it.
struct OnLine {
  Places places;
  double off_m = 0.0;  // from the leftmost to the rightmost of them, across the line
  double length_m = 0.0;
};

OnLine Projected(const Places& places) {
  const auto count = static_cast<std::size_t>(places.size());
  const double x0 = places.x_m[0], y0 = places.y_m[0];
  OnLine line;
  double ux = 1.0, uy = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const double dx = places.x_m[k] - x0, dy = places.y_m[k] - y0, distance = std::hypot(dx, dy);
    if (distance <= line.length_m) continue;
    line.length_m = distance;
    ux = dx / distance;
    uy = dy / distance;
  }
  double low = 0.0, high = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const double dx = places.x_m[k] - x0, dy = places.y_m[k] - y0, across = dy * ux - dx * uy;
    line.places.x_m.push_back(dx * ux + dy * uy);
    low = std::min(low, across);
    high = std::max(high, across);
  }
  line.places.y_m.assign(count, 0.0);
  line.places.along_m = places.along_m;
  line.off_m = high - low;
  return line;
}

double PairsInReach(const Pairs& pairs, int truths) {
  double sum = 0.0;
  std::vector<Stretch> stretches;
  for (int first = 0; first < truths; first += kTileSamples) {
    const Range strip{first, std::min(truths, first + kTileSamples)};
    pairs.Reach(strip, &stretches);
    for (const Stretch& stretch : stretches)
      sum += static_cast<double>(strip.size()) * stretch.samples.size();
  }
  return sum;
}

// What LineSums could do here: at all, and exactly.
struct LineCase {
  bool possible = false, exact = false;
  double bound = 0.0;
  OnLine line;
};

LineCase LookAtLine(const Belief& belief, const ErrorRule& error, const Places& places) {
  constexpr double kRounding = 1e-12;  // what is off a line by so much of its length is off by rounding
  LineCase found;
  if (belief.shape != BeliefShape::kUniform || error == ErrorKind::kTable ||
      error == ErrorKind::kPosteriorMass)
    return found;
  const bool global = std::isinf(belief.ReachM());
  if (global && !(error == ErrorKind::kDistance)) {
    found.possible = found.exact = true;  // the way travelled is a line, a square the sum of two
    found.line.places = places;
  } else if (!(error == ErrorKind::kAlong)) {
    found.line = Projected(places);
    found.possible = true;
    found.exact = found.line.off_m <= kRounding * found.line.length_m;
  }
  return found;
}

std::string LineText(const LineCase& found, double bound) {
  char text[160];
  if (found.exact)
    std::snprintf(text, sizeof text, "sum along the line, relative error below %.1e", bound);
  else
    std::snprintf(text, sizeof text, "sum along the line, distances up to %.3g m short", found.line.off_m);
  return text;
}

}  // namespace

Belief BeliefOf(const Options& options) {
  return {options.belief == "gaussian" ? BeliefShape::kGaussian : BeliefShape::kUniform,
          options.window_m > 0.0 ? options.window_m : std::numeric_limits<double>::infinity()};
}

ErrorRule ErrorOf(const Options& options) {
  if (options.error == "table" || options.error == "travel") return ErrorKind::kTable;
  if (options.error == "kl") return {ErrorKind::kPosteriorMass, options.smooth_m};
  if (options.error == "squared") return ErrorKind::kSquaredDistance;
  return options.error == "along" ? ErrorKind::kAlong : ErrorKind::kDistance;
}

SumPlan PlanSum(const Options& options, const Places& places) {
  const Belief belief = BeliefOf(options);
  const ErrorRule error = ErrorOf(options);
  SumPlan plan;
  plan.flops_per_vector = 8.0 * PairsInReach(Pairs(places, places, belief, error), places.size());
  plan.text = "sum over all pairs in reach";
  const LineCase found =
      options.sum == "pairs" || options.sum == "tree" ? LineCase() : LookAtLine(belief, error, places);
  // Of a sample and feature; in the time of which a core does so many of the pairs'. The tree's are three
  // times what they measure at, as pairs can be cut into tasks and are exact.
  const double line_flops = (std::isinf(belief.ReachM()) ? 450.0 : 1200.0) * places.size();
  const double tree_flops = 40'000.0 * places.size();
  const bool tree =
      belief.shape == BeliefShape::kUniform && std::isinf(belief.ReachM()) && error == ErrorKind::kDistance;
  if (options.sum == "line" && !found.possible)
    throw InputError(
        "sum = line: it takes a uniform belief and distances, and errors along the way only where nothing is "
        "known before");
  if (options.sum == "tree" && !tree)
    throw InputError("sum = tree: it takes distances, and window_m = 0: nothing known before");
  const bool free = options.sum == "auto" && options.batch == 0;
  if (options.sum == "line" || (free && found.exact && line_flops < plan.flops_per_vector)) {
    const LineSums sums(error == ErrorKind::kAlong ? places.along_m : found.line.places.x_m, belief.ReachM(),
                        false);
    return {SumPath::kLine, found.line.places, line_flops, LineText(found, sums.Bound())};
  }
  plan.places = places;
  if (options.sum == "tree" || (free && tree && tree_flops < plan.flops_per_vector)) {
    plan.path = SumPath::kTree;
    plan.flops_per_vector = tree_flops;
    char text[120];
    std::snprintf(text, sizeof text, "sum by a tree, each distance and E off by at most %.0e of itself",
                  kFarBound);
    plan.text = text;
  }
  return plan;
}

bool IsOneSweep(const Options& options, const SumPlan& plan) {
  return plan.path == SumPath::kTree || (plan.path == SumPath::kLine && options.window_m == 0.0);
}

}  // namespace cairn::landmark_learning
