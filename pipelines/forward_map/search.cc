#include "pipelines/forward_map/search.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <queue>

namespace cairn::forward_map {
namespace {

constexpr double kLeastGain = 1e-9;  // nats; below it is rounding
// Pairs are of cells within kPairReach columns and rows, and none whose first flip loses more than kDepth
// nats: others were found to gain next to nothing, and there are many.
constexpr std::int32_t kPairReach = 3;
constexpr double kDepth = 2;
constexpr std::size_t kCellsOfTick = 64;  // looked at between two ticks
constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

struct Proposed {
  double gain;
  std::int32_t cell;
  // The largest gain first; of equal ones the first cell.
  bool operator<(const Proposed& other) const {
    return gain != other.gain ? gain < other.gain : cell > other.cell;
  }
};

}  // namespace

Patch Patch::Empty(std::int32_t columns, std::int32_t rows) {
  Patch patch{columns, rows, {}};
  patch.rimmed.resize(static_cast<std::size_t>(columns + 2) * static_cast<std::size_t>(rows + 2));
  return patch;
}

std::vector<std::uint8_t> Patch::Inside() const {
  std::vector<std::uint8_t> inside;
  for (std::int32_t cell = 0; cell < cells(); ++cell) inside.push_back(rimmed[Rimmed(cell)]);
  return inside;
}

double MapSearch::PriorGainOf(std::int32_t cell) const {
  const std::size_t at = patch_.Rimmed(cell), row = static_cast<std::size_t>(patch_.columns + 2);
  const std::uint8_t now = patch_.rimmed[at];
  int unlike = 0;
  for (const std::size_t other : {at - row, at - 1, at + 1, at + row}) unlike += patch_.rimmed[other] != now;
  const double smoother = prior_.smoothness * (2 * unlike - 4);
  return smoother + (now != 0 ? -prior_.logit : prior_.logit);
}

MapSearch::MapSearch(FlipGains* gains, Patch patch, const MapPrior& prior)
    : gains_(gains), patch_(std::move(patch)), prior_(prior) {
  lost_at_.assign(static_cast<std::size_t>(patch_.cells()), kNever);
  swapped_at_.assign(static_cast<std::size_t>(patch_.cells()), kNever);
}

void MapSearch::Try(std::int32_t cell) {
  gains_->Flip(cell);
  patch_.rimmed[patch_.Rimmed(cell)] ^= 1;
}

void MapSearch::Flip(std::int32_t cell) {
  Try(cell);
  gains_->Keep(cell);
}

bool MapSearch::AsWhen(std::int32_t cell, std::uint64_t kept) const {
  // Smoothness looks at neighbours, of which the readings know nothing.
  return prior_.smoothness == 0 && kept != kNever && !gains_->ChangedSince(cell, kept);
}

double MapSearch::Look(std::int32_t cell) {
  const double gain = GainOf(cell);
  if (gain <= kLeastGain) lost_at_[static_cast<std::size_t>(cell)] = gains_->kept();
  return gain;
}

std::vector<std::int32_t> MapSearch::Candidates() const {
  const bool prior_may_occupy = prior_.logit > 0 || prior_.smoothness > 0;
  const std::vector<std::int32_t>& near_ends = gains_->near_ends();
  auto near = near_ends.begin();
  std::vector<std::int32_t> cells;
  cells.reserve(near_ends.size());
  for (std::int32_t cell = 0; cell < patch_.cells(); ++cell) {
    const bool is_near = near != near_ends.end() && *near == cell;
    if (is_near) ++near;
    if (is_near || prior_may_occupy || gains_->occupied()[static_cast<std::size_t>(cell)] != 0)
      cells.push_back(cell);
  }
  return cells;
}

std::vector<std::int32_t> MapSearch::Neighbours(std::int32_t cell) const {
  std::vector<std::int32_t> cells;
  const std::int32_t column = cell % patch_.columns, row = cell / patch_.columns;
  for (std::int32_t j = std::max(0, row - 1); j <= std::min(patch_.rows - 1, row + 1); ++j) {
    for (std::int32_t i = std::max(0, column - 1); i <= std::min(patch_.columns - 1, column + 1); ++i)
      if (i != column || j != row) cells.push_back(j * patch_.columns + i);
  }
  return cells;
}

// [Thr01] section 3.3, the M-step: hill climbing in the space of all maps
double MapSearch::Climb(const Tick& tick) {
  double sum = 0;
  for (bool gained = true; gained;) {
    gained = false;
    std::vector<Proposed> proposals;
    std::size_t looked_at = 0;
    for (const std::int32_t cell : Candidates()) {
      if (++looked_at % kCellsOfTick == 0) tick();
      if (AsWhen(cell, lost_at_[static_cast<std::size_t>(cell)])) continue;
      const double gain = Look(cell);
      if (gain > kLeastGain) proposals.push_back({gain, cell});
    }
    // What a proposal gains now may differ from what it did when it was made: it is looked at again when its
    // turn comes, and goes back into the queue where another one is better.
    std::priority_queue<Proposed> queue({}, std::move(proposals));
    while (!queue.empty()) {
      if (++looked_at % kCellsOfTick == 0) tick();
      const Proposed now{Look(queue.top().cell), queue.top().cell};
      queue.pop();
      if (now.gain <= kLeastGain) continue;
      if (!queue.empty() && now < queue.top()) {
        queue.push(now);
        continue;
      }
      Flip(now.cell);
      sum += now.gain;
      gained = true;
    }
  }
  return sum;
}

// Flips `cell`, which gains `gain`, with the one of `others` that gains most after it, or neither; returns
// what is gained.
double MapSearch::FlipWithBestOf(std::int32_t cell, double gain, const std::vector<std::int32_t>& others) {
  if (others.empty()) return 0;
  Try(cell);
  Proposed best{GainOf(others.front()), others.front()};
  for (const std::int32_t other : others) best = std::max(best, {GainOf(other), other});
  if (gain + best.gain > kLeastGain) {
    gains_->Keep(cell);
    Flip(best.cell);
    return gain + best.gain;
  }
  Try(cell);
  return 0;
}

double MapSearch::Swaps(const Tick& tick) {
  double sum = 0;
  for (std::int32_t cell = 0; cell < patch_.cells(); ++cell) {
    if (occupied(cell) == 0) continue;
    tick();
    std::vector<std::int32_t> others = Neighbours(cell);
    std::erase_if(others, [&](std::int32_t other) { return occupied(other) != 0; });
    std::uint64_t& tried_at = swapped_at_[static_cast<std::size_t>(cell)];
    const auto as_when = [&](std::int32_t one) { return AsWhen(one, tried_at); };
    if (as_when(cell) && std::ranges::all_of(others, as_when)) continue;
    tried_at = gains_->kept();
    sum += FlipWithBestOf(cell, GainOf(cell), others);
  }
  return sum;
}

bool MapSearch::IsNear(std::int32_t a, std::int32_t b) const {
  return std::abs(a % patch_.columns - b % patch_.columns) <= kPairReach &&
         std::abs(a / patch_.columns - b / patch_.columns) <= kPairReach;
}

double MapSearch::Pairs(const Tick& tick) {
  double sum = 0;
  for (const std::int32_t cell : Candidates()) {
    const double gain = GainOf(cell);
    if (gain < -kDepth) continue;
    tick();
    std::vector<std::int32_t> others = gains_->Sharing(cell);
    std::erase_if(others, [&](std::int32_t other) { return !IsNear(cell, other); });
    sum += FlipWithBestOf(cell, gain, others);
  }
  return sum;
}

double MapSearch::Run(const Moves& moves, const Tick& tick) {
  double sum = Climb(tick);
  while (true) {
    double more = 0;
    if (moves.swaps) more += Swaps(tick);
    if (moves.pairs) more += Pairs(tick);
    if (more <= 0) return sum;
    sum += more + Climb(tick);
  }
}

}  // namespace cairn::forward_map
