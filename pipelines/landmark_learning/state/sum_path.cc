#include "pipelines/landmark_learning/state/sum_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "pipelines/landmark_learning/error_sum/far_field.h"
#include "pipelines/landmark_learning/error_sum/line_sums.h"
#include "schema/error.h"

namespace cairn::landmark_learning {
namespace {

// Samples projected onto the line through the first one and the one that is farthest from it.
struct OnLine {
  Positions positions;
  double off_m = 0.0;  // from the leftmost to the rightmost of them, across the line
  double length_m = 0.0;
};

OnLine Projected(const Positions& positions) {
  const auto count = static_cast<std::size_t>(positions.size());
  const double x0 = positions.x_m[0], y0 = positions.y_m[0];
  OnLine line;
  double ux = 1.0, uy = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const double dx = positions.x_m[k] - x0, dy = positions.y_m[k] - y0, distance = std::hypot(dx, dy);
    if (distance <= line.length_m) continue;
    line.length_m = distance;
    ux = dx / distance;
    uy = dy / distance;
  }
  double low = 0.0, high = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const double dx = positions.x_m[k] - x0, dy = positions.y_m[k] - y0, across = dy * ux - dx * uy;
    line.positions.x_m.push_back(dx * ux + dy * uy);
    low = std::min(low, across);
    high = std::max(high, across);
  }
  line.positions.y_m.assign(count, 0.0);
  line.positions.along_m = positions.along_m;
  line.off_m = high - low;
  return line;
}

// Of many strips of true positions, some tell.
double PairsInReach(const Pairs& pairs, int true_positions) {
  constexpr int kStrips = 2048;
  const int step = std::max(1, true_positions / kTileSamples / kStrips) * kTileSamples;
  double sum = 0.0, looked_at = 0.0;
  std::vector<Stretch> stretches;
  for (int first = 0; first < true_positions; first += step) {
    const IndexRange strip{first, std::min(true_positions, first + kTileSamples)};
    pairs.Reach(strip, &stretches);
    looked_at += strip.size();
    for (const Stretch& stretch : stretches)
      sum += static_cast<double>(strip.size()) * stretch.samples.size();
  }
  return sum * true_positions / looked_at;
}

// What LineSums could do here: at all, and exactly.
struct LineCase {
  bool possible = false, exact = false;
  double bound = 0.0;
  OnLine line;
};

LineCase LookAtLine(const Belief& belief, const ErrorRule& error, const Positions& positions) {
  constexpr double kRounding = 1e-12;  // what is off a line by so much of its length is off by rounding
  LineCase found;
  if (belief.shape != BeliefShape::kUniform || belief.LooksAtHeadings() || error == ErrorKind::kTable ||
      error == ErrorKind::kPosteriorMass)
    return found;
  const bool global = std::isinf(belief.ReachM());
  if (global && !(error == ErrorKind::kDistance)) {
    found.possible = found.exact = true;  // the distance travelled is a line, a square the sum of two
  } else if (!(error == ErrorKind::kAlong)) {
    found.line = Projected(positions);
    found.possible = true;
    found.exact = found.line.off_m <= kRounding * found.line.length_m;
  }
  return found;
}

std::string LineText(const LineCase& found, double bound) {
  return found.exact ? fmt::format("sum along the line, relative error below {:.1e}", bound)
                     : fmt::format("sum along the line, distances up to {:.3g} m short", found.line.off_m);
}

}  // namespace

Belief BeliefOf(const Options& options) {
  constexpr double kDeg = std::numbers::pi / 180.0;
  return {options.belief == "gaussian" ? BeliefShape::kGaussian : BeliefShape::kUniform,
          options.window_m > 0.0 ? options.window_m : std::numeric_limits<double>::infinity(),
          options.heading_window_deg < 180.0 ? options.heading_window_deg * kDeg : std::numbers::pi};
}

ErrorRule ErrorOf(const Options& options) {
  if (options.error == "table" || options.error == "travel") return ErrorKind::kTable;
  if (options.error == "kl") return {ErrorKind::kPosteriorMass, options.smooth_m};
  if (options.error == "squared") return ErrorKind::kSquaredDistance;
  return options.error == "along" ? ErrorKind::kAlong : ErrorKind::kDistance;
}

double FlopsPerVector(const Options& options, SumPath path, const Positions& positions) {
  const Belief belief = BeliefOf(options);
  if (path == SumPath::kPairs)
    return 8.0 * PairsInReach(Pairs(positions, positions, belief, ErrorOf(options)), positions.size());
  // Of a sample; in the time of which a core does so many of the pairs'. The tree's are three times what they
  // measure at, as pairs can be cut into tasks and are exact.
  if (path == SumPath::kTree) return 40'000.0 * positions.size();
  return (std::isinf(belief.ReachM()) ? 450.0 : 1200.0) * positions.size();
}

namespace {

SumPlan Line(const Belief& belief, const ErrorRule& error, const Positions& positions, LineCase found) {
  const std::vector<double>& t = error == ErrorKind::kAlong        ? positions.along_m
                                 : found.line.positions.size() > 0 ? found.line.positions.x_m
                                                                   : positions.x_m;
  const double bound = LineSums(t, belief.ReachM(), false).Bound();
  return {SumPath::kLine, std::move(found.line.positions), LineText(found, bound)};
}

SumPlan Tree() {
  return {SumPath::kTree,
          {},
          fmt::format("sum by a tree, each distance and E off by at most {:.0e} of itself", kFarBound)};
}

}  // namespace

SumPlan PlanSum(const Options& options, const Positions& positions) {
  const SumPlan pairs{SumPath::kPairs, {}, "sum over all pairs in reach"};
  if (options.sum == "pairs" || (options.sum == "auto" && options.batch > 0)) return pairs;
  const Belief belief = BeliefOf(options);
  const ErrorRule error = ErrorOf(options);
  const bool tree = belief.shape == BeliefShape::kUniform && !belief.LooksAtHeadings() &&
                    std::isinf(belief.ReachM()) && error == ErrorKind::kDistance;
  if (options.sum == "tree") {
    if (!tree) throw InputError("sum = tree: it takes distances, and window_m = 0: nothing known before");
    return Tree();
  }
  LineCase found = LookAtLine(belief, error, positions);
  if (options.sum == "line") {
    if (!found.possible)
      throw InputError(
          "sum = line: it takes a uniform belief in samples that face whichever way, and distances, and "
          "errors along the path only where nothing is known before");
    return Line(belief, error, positions, std::move(found));
  }
  const double flops = FlopsPerVector(options, SumPath::kPairs, positions);
  if (found.exact && FlopsPerVector(options, SumPath::kLine, positions) < flops)
    return Line(belief, error, positions, std::move(found));
  return tree && FlopsPerVector(options, SumPath::kTree, positions) < flops ? Tree() : pairs;
}

bool IsOneSweep(const Options& options, const SumPlan& plan) {
  return plan.path == SumPath::kTree || (plan.path == SumPath::kLine && options.window_m == 0.0);
}

}  // namespace cairn::landmark_learning
