#include "pipelines/localization/traverse.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "pipelines/localization/sensing.h"
#include "schema/error.h"

namespace cairn::localization {
namespace {

constexpr std::uint32_t kTurnSubstream = 2;  // 0: starts and displacements; 1: what is sensed

// Distance travelled until each sample of a run.
std::vector<double> WayTo(const std::vector<Position>& positions) {
  std::vector<double> travelled(positions.size(), 0.0);
  for (std::size_t k = 1; k < positions.size(); ++k)
    travelled[k] = travelled[k - 1] + DistanceM(positions[k], positions[k - 1]);
  return travelled;
}

std::size_t StartOf(const Options& options, const std::vector<double>& travelled, Rng& rng) {
  if (options.traverses == 0 || options.travelled_m == 0.0 || travelled.back() <= options.travelled_m)
    return 0;
  // [Thr98] section 5.2.4: robots set out anywhere.
  const double at_m = rng.Uniform(0.0, travelled.back() - options.travelled_m);
  return static_cast<std::size_t>(std::ranges::lower_bound(travelled, at_m) - travelled.begin());
}

// What odometry makes of a displacement.
Position Measured(const Position& from, const Position& to, double ratio, Rng& rng) {
  const double sd_m = ratio * DistanceM(from, to);
  return {to.x_m - from.x_m + sd_m * rng.Normal(), to.y_m - from.y_m + sd_m * rng.Normal()};
}

Position Turned(const Position& p, double by_rad) {
  const double c = std::cos(by_rad), s = std::sin(by_rad);
  return {c * p.x_m - s * p.y_m, s * p.x_m + c * p.y_m};
}

// The same, as a robot that faced `from_rad` and now faces `to_rad` has it: with an error of its turn.
OwnMotion AsItFaced(const Position& displacement, double from_rad, double to_rad, double ratio, Rng& rng) {
  const double turn_rad = std::remainder(to_rad - from_rad, 2.0 * std::numbers::pi);
  return {Turned(displacement, -from_rad), turn_rad + ratio * std::abs(turn_rad) * rng.Normal()};
}

// All that odometry says from one sample to another, as the robot faced at the first.
OwnMotion Together(const std::vector<OwnMotion>& odometry, std::size_t from, std::size_t to) {
  OwnMotion all;
  for (std::size_t k = from + 1; k <= to; ++k) {
    all.turn_rad += odometry[k].turn_rad;
    const Position moved = Turned(odometry[k].moved, all.turn_rad);
    all.moved = {all.moved.x_m + moved.x_m, all.moved.y_m + moved.y_m};
  }
  return all;
}

Localized::Step StepOf(const BeliefSpace& space, const std::vector<double>& belief,
                       const Localized::Lead& lead) {
  Localized::Step step{EstimateOf(space.positions(), belief), lead, {}, {}};
  const double least = kKeptShare * *std::ranges::max_element(belief);
  double sum = 0.0;
  for (const double b : belief) sum += b >= least ? b : 0.0;
  for (std::size_t position = 0; position < belief.size(); ++position) {
    if (belief[position] < least) continue;
    step.position.push_back(static_cast<std::int32_t>(position));
    step.probability.push_back(static_cast<float>(belief[position] / sum));
  }
  return step;
}

// P(f_i = 1) of a robot that believes so, of the bits of `group`.
std::vector<double> Foretold(const std::vector<double>& map, std::size_t features, const FeatureGroup& group,
                             const std::vector<double>& belief) {
  std::vector<double> ones(group.size(), 0.0);
  for (std::size_t k = 0; k < belief.size(); ++k)
    for (std::size_t i = 0; i < group.size(); ++i) ones[i] += belief[k] * map[k * features + group.first + i];
  return ones;
}

// How much better the belief foretold each bit than one that knows nothing, and by how much it should have.
Localized::Lead LeadOf(const std::vector<double>& here, const std::vector<double>& anywhere,
                       std::span<const double> feature) {
  Localized::Lead lead;
  for (std::size_t i = 0; i < here.size(); ++i) {
    const double of_one = std::log(here[i] / anywhere[i]),
                 of_zero = std::log((1.0 - here[i]) / (1.0 - anywhere[i]));
    if (!std::isfinite(of_one) || !std::isfinite(of_zero)) continue;  // certain: prior_count is 0
    lead.nats += feature[i] * of_one + (1.0 - feature[i]) * of_zero;
    lead.expected_nats += here[i] * of_one + (1.0 - here[i]) * of_zero;
  }
  return lead;
}

// What is sensed at stop number `stop`.
FeatureGroup LookedAt(const Options& options, const Source& source, const BeliefSpace& space,
                      const std::vector<double>& map, const std::vector<double>& belief, std::size_t stop) {
  const std::vector<FeatureGroup>& groups = source.groups;
  if (groups.size() == 1 || options.look == "all") return {0, source.features()};
  if (options.look == "turn") return groups[stop % groups.size()];
  return groups[BestLook(space.positions(), belief, map, source.features(), groups)];
}

[[noreturn]] void Impossible(const Source& source, const Traverse& traverse, const Stop& stop,
                             const char* what) {
  const auto run = static_cast<std::size_t>(source.runs[traverse.run].index);
  throw InputError("run '" + source.run_names[run] + "', sample " + std::to_string(stop.sample) + ": " +
                   what);
}

}  // namespace

std::size_t TraverseCount(const Options& options, const Source& source) {
  return options.traverses > 0 ? static_cast<std::size_t>(options.traverses) : source.runs.size();
}

Traverse MakeTraverse(const Options& options, const Source& source, std::size_t number, std::uint64_t seed) {
  Traverse traverse{.run = number % source.runs.size(), .start = 0, .stops = {}};
  const Run& run = source.runs[traverse.run];
  const std::vector<double> travelled = WayTo(run.positions);
  Rng rng(seed, number), turn_rng(seed, number, kTurnSubstream);
  traverse.start = StartOf(options, travelled, rng);
  const double end_m = options.travelled_m > 0.0 ? options.travelled_m : travelled.back();
  std::size_t last = traverse.start;
  for (std::size_t k = traverse.start + 1; k < travelled.size(); ++k) {
    const double travelled_m = travelled[k] - travelled[traverse.start];
    if (travelled_m > end_m) break;
    if (travelled_m < static_cast<double>(traverse.stops.size() + 1) * options.every_m) continue;
    Stop stop{k, travelled_m, {}, {}};
    if (!run.odometry.empty()) {
      stop.own = Together(run.odometry, last, k);
      stop.displacement = Turned(stop.own.moved, run.heading_rad[last]);
    } else {
      stop.displacement = Measured(run.positions[last], run.positions[k], options.odometry_ratio, rng);
    }
    if (run.odometry.empty() && !run.heading_rad.empty()) {
      stop.own = AsItFaced(stop.displacement, run.heading_rad[last], run.heading_rad[k],
                           options.odometry_ratio, turn_rng);
    }
    traverse.stops.push_back(stop);
    last = k;
  }
  if (traverse.stops.empty()) {
    throw InputError("run '" + source.run_names[static_cast<std::size_t>(run.index)] +
                     "' has no stop: every_m is more than its way or than travelled_m");
  }
  return traverse;
}

Localized Localize(const Options& options, const Source& source, const BeliefSpace& space,
                   const std::vector<double>& map, double least_sd_m, const Traverse& traverse, Rng rng,
                   Progress& progress) {
  const Run& run = source.runs[traverse.run];
  const std::size_t features = source.features();
  const Motion motion{options.motion_m, options.motion_ratio, least_sd_m,
                      options.motion_heading_deg * std::numbers::pi / 180.0};
  const bool drives = options.heading == "unknown", knows = !drives && source.headings();
  std::vector<double> belief =
      options.window_m > 0.0 ? space.Near(run.positions[traverse.start], options.window_m) : space.Anywhere();
  std::vector<double> anywhere;  // facing as it does
  const auto face = [&](const Stop& stop) {
    anywhere = space.Anywhere();
    if (knows) static_cast<void>(space.KeepFacing(run.heading_rad[stop.sample], &anywhere));
    if (knows && !space.KeepFacing(run.heading_rad[stop.sample], &belief))
      Impossible(source, traverse, stop, "no position that it may be at was seen facing as it does");
  };
  face({traverse.start, 0.0, {}, {}});
  Localized localized{{StepOf(space, belief, {})}};
  // [Thr98] table 1
  for (const Stop& stop : traverse.stops) {
    progress.Tick();
    if (!(drives ? space.Drive(stop.own, motion, options.lost, &belief)
                 : space.Move(stop.displacement, motion, options.lost, &belief)))
      Impossible(source, traverse, stop, "it has left all positions of the map (lost = 0)");
    face(stop);
    const auto row = run.output.begin() + static_cast<std::ptrdiff_t>(stop.sample * features);
    std::vector<double> feature(row, row + static_cast<std::ptrdiff_t>(features));
    if (options.sensing == "sampled") feature = Drawn(feature, rng);
    const FeatureGroup group = LookedAt(options, source, space, map, belief, localized.steps.size() - 1);
    const Localized::Lead lead =
        LeadOf(Foretold(map, features, group, belief), Foretold(map, features, group, anywhere),
               std::span(feature).subspan(group.first, group.size()));
    if (!Sense(Likelihood(map, feature, group, options.trust), &belief))
      Impossible(source, traverse, stop, "what it senses is impossible wherever it may be (prior_count = 0)");
    localized.steps.push_back(StepOf(space, belief, lead));
  }
  return localized;
}

}  // namespace cairn::localization
