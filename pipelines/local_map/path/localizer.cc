#include "pipelines/local_map/path/localizer.h"

#include <algorithm>
#include <cmath>

#include "pipelines/local_map/traces/frame.h"

namespace cairn::local_map {
namespace {

constexpr double kBeyond_m = 0.3;  // of a trace's ends its features still tell something
constexpr double kSurer = 0.9;     // of a range, so that a narrower one counts
constexpr double kLattice_m = 0.3;
constexpr double kSds = 3;  // of a match or a connection make a range

bool IsOn(const EdgeTrace& trace, const Position& at, double aside_m) {
  const double cell_m = trace.cell_m();
  return std::abs(at.u_m) <= aside_m && at.z_m >= trace.first_z() * cell_m - kBeyond_m &&
         at.z_m <= trace.end_z() * cell_m + kBeyond_m;
}

double Widest(const SearchWindow& range) { return std::max(range.z_m, range.u_m); }

// A position in place of another: one that is surer, or that contradicts it.
bool IsBetter(const Held& held, const Position& at, double range_m) {
  const double off = std::hypot(at.z_m - held.at.z_m, at.u_m - held.at.u_m);
  return range_m < kSurer * Widest(held.range) || off > Widest(held.range) + range_m;
}

// The mean of what is held and of what matching says, each by how sure it is.
void ApproachBy(double match_m, double sd_m, double least_m, double* at_m, double* range_m) {
  if (!std::isfinite(sd_m)) return;
  const double held = (*range_m / kSds) * (*range_m / kSds), noise = sd_m * sd_m;
  const double gain = held / (held + noise);
  *at_m += gain * (match_m - *at_m);
  *range_m = std::max(least_m, kSds * std::sqrt((1 - gain) * held));
}

}  // namespace

TraceLocalizer::TraceLocalizer(const LocalGrids& grids, const LocalizerOptions& options, std::size_t capacity)
    : options_(options) {
  held_.reserve(capacity);
  order_.reserve(capacity);
  for (ImmediateTrace& around : around_) around = ImmediateRoom(grids);
}

void TraceLocalizer::Begin(int trace, const std::optional<Position>& at, const SearchWindow& range) {
  if (held_.size() <= static_cast<std::size_t>(trace)) held_.resize(static_cast<std::size_t>(trace) + 1);
  if (at) held_[static_cast<std::size_t>(trace)] = Held{.at = *at, .range = range};
}

void TraceLocalizer::Update(const LocalGrids& grids, const TraceGraph& graph, double more_m) {
  made_.fill(false);
  if (held_.size() < graph.size()) held_.resize(graph.size());
  Move(grids, graph, more_m);
  HandOn(grids, graph);
  Activate(graph);
  for (std::size_t t = 0; t < held_.size(); ++t)
    if (held_[t] && held_[t]->active) {
      const auto trace = static_cast<int>(t);
      if (!held_[t]->corrected && !CorrectWithCrossing(grids, graph, trace))
        Correct(grids, graph, &*held_[t], trace);
      if (!held_[t]->corrected) continue;
      uncorrected_m_ = 0;
      lost_ = false;
    }
}

void TraceLocalizer::Move(const LocalGrids& grids, const TraceGraph& graph, double more_m) {
  const Pose now = grids.pose();
  const Pose before = before_.value_or(now);
  before_ = now;
  const Point by{now.x_m - before.x_m, now.y_m - before.y_m};
  const double distance_m = std::hypot(by.x_m, by.y_m);
  const double wider = options_.range_per_m * distance_m + kSds * more_m;
  uncorrected_m_ += distance_m;
  lost_ |= kSds * more_m > options_.most_m || uncorrected_m_ > options_.lost_m;
  const double most_m = lost_ ? options_.lost_most_m : options_.most_m;
  for (std::size_t t = 0; t < held_.size(); ++t) {
    if (!held_[t]) continue;
    Held& held = *held_[t];
    const Position step = TraceFrame{graph.node(static_cast<int>(t)).quarter, {}}.At(by, 1);
    held.at = {held.at.z_m + step.z_m, held.at.u_m + step.u_m};
    // [DM98] section 4.3: the range of possible corrections grows with the way.
    held.range = {std::min(held.range.z_m + wider, most_m), std::min(held.range.u_m + wider, most_m)};
    held.corrected = false;
  }
}

// Positions that active traces give to those they are connected with: where there is none, or where the one
// there is less sure or contradicts it, and matching says nothing of it or not that it is clearly better.
void TraceLocalizer::HandOn(const LocalGrids& grids, const TraceGraph& graph) {
  for (std::size_t t = 0; t < held_.size(); ++t) {
    if (!held_[t] || !held_[t]->active) continue;
    for (const int c : graph.node(static_cast<int>(t)).connections) {
      const Connection& connection = graph.connection(c);
      const bool forth = connection.from == static_cast<int>(t);
      const int other = forth ? connection.to : connection.from;
      const Position at = forth ? Through(connection, held_[t]->at) : Back(connection, held_[t]->at);
      if (!IsOn(graph.node(other).trace, at, options_.aside_m)) continue;
      const double range = Widest(held_[t]->range) + kSds * connection.sd_m;
      std::optional<Held>& there = held_[static_cast<std::size_t>(other)];
      if (there && !IsBetter(*there, at, range)) continue;
      Held offered{.at = at, .range = {range, range}, .active = there && there->active};
      Correct(grids, graph, &offered, other);
      if (there) {
        Held own = *there;
        Correct(grids, graph, &own, other);
        if (own.corrected && (!offered.corrected || own.similarity > offered.similarity + options_.better))
          continue;
      }
      // [DM98] section 4.3: a position may override that of the trace which the robot enters.
      there = offered;
    }
  }
}

void TraceLocalizer::Activate(const TraceGraph& graph) {
  order_.clear();
  for (std::size_t t = 0; t < held_.size(); ++t) {
    if (!held_[t]) continue;
    held_[t]->active = false;
    if (IsOn(graph.node(static_cast<int>(t)).trace, held_[t]->at, options_.aside_m))
      order_.push_back(static_cast<int>(t));
  }
  const auto aside = [&](int t) { return std::abs(held_[static_cast<std::size_t>(t)]->at.u_m); };
  std::ranges::sort(order_, [&](int a, int b) { return aside(a) != aside(b) ? aside(a) < aside(b) : a < b; });
  for (std::size_t k = 0; k < std::min(order_.size(), options_.most_active); ++k)
    held_[static_cast<std::size_t>(order_[k])]->active = true;
}

void TraceLocalizer::Correct(const LocalGrids& grids, const TraceGraph& graph, Held* held, int trace) {
  const TraceGraph::Node& node = graph.node(trace);
  const OnTrace on{node.trace, Around(grids, node.quarter), held->at};
  const bool wide = lost_ && Widest(held->range) > options_.most_m;
  // [DM98] section 4.3: within a trace, corrections are tried at every time cycle.
  const Match match = wide ? Search(on, held->range) : local_map::Correct(on, held->range, options_.match);
  held->similarity = match.sides_after;
  if (wide && match.usable() && match.sides_after >= options_.least_similarity) {
    held->at = {match.z_m, match.u_m};
    held->range = {options_.most_m, options_.most_m};
  }
  Take(match, held);
}

// [DM98] section 4.2, 'a natural extension': what z rests on in the one trace tells u in the other.
bool TraceLocalizer::CorrectWithCrossing(const LocalGrids& grids, const TraceGraph& graph, int trace) {
  if (lost_) return false;
  Held& held = *held_[static_cast<std::size_t>(trace)];
  for (const int c : graph.node(trace).connections) {
    const Connection& connection = graph.connection(c);
    if (connection.quarter % 2 == 0) continue;
    const bool forth = connection.from == trace;
    const int other = forth ? connection.to : connection.from;
    std::optional<Held>& there = held_[static_cast<std::size_t>(other)];
    if (!there || !there->active || there->corrected) continue;
    const Position at = forth ? Through(connection, held.at) : Back(connection, held.at);
    if (std::hypot(at.z_m - there->at.z_m, at.u_m - there->at.u_m) > options_.agree_m) continue;
    const TraceGraph::Node &one = graph.node(trace), &two = graph.node(other);
    const SearchWindow range{std::max(held.range.z_m, there->range.u_m),
                             std::max(held.range.u_m, there->range.z_m)};
    const int left = (connection.quarter == 1) == forth ? 1 : -1;
    const PairMatch pair =
        CorrectPair({one.trace, Around(grids, one.quarter), held.at},
                    {two.trace, Around(grids, two.quarter), there->at}, left, range, options_.match);
    if (!pair.first.usable() || !pair.second.usable()) continue;
    held.similarity = pair.first.sides_after;
    there->similarity = pair.second.sides_after;
    Take(pair.first, &held);
    Take(pair.second, &*there);
    return held.corrected;
  }
  return false;
}

void TraceLocalizer::Take(const Match& match, Held* held) const {
  if (!match.usable() || match.sides_after < options_.least_similarity) return;
  held->corrected = true;
  ApproachBy(match.z_m, match.sd_z_m, options_.least_m, &held->at.z_m, &held->range.z_m);
  ApproachBy(match.u_m, match.sd_u_m, options_.least_m, &held->at.u_m, &held->range.u_m);
}

// Over a wide range z cannot be told before u nor u before z: both are tried from a lattice of places, and
// the best match of all counts, if z is told by it too.
Match TraceLocalizer::Search(const OnTrace& on, const SearchWindow& range) const {
  Match best;
  double most = 0;
  const auto steps = [](double range_m) { return static_cast<int>(std::ceil(range_m / kLattice_m)); };
  for (int z = -steps(range.z_m); z <= steps(range.z_m); ++z) {
    for (int u = -steps(range.u_m); u <= steps(range.u_m); ++u) {
      OnTrace there = on;
      there.at = {on.at.z_m + z * kLattice_m, on.at.u_m + u * kLattice_m};
      Match match = local_map::Correct(there, {kLattice_m, kLattice_m}, options_.match);
      const double score = match.known * (match.along_after + match.sides_after);
      if (match.verdict == Verdict::kUnknown || !std::isfinite(match.sd_z_m) || score <= most) continue;
      most = score;
      match.verdict = Verdict::kCorrected;
      best = match;
    }
  }
  return best;
}

const ImmediateTrace& TraceLocalizer::Around(const LocalGrids& grids, int quarter) {
  const auto q = static_cast<std::size_t>(quarter);
  if (!made_[q]) MakeImmediate(grids, quarter, around_[q]);
  made_[q] = true;
  return around_[q];
}

}  // namespace cairn::local_map
