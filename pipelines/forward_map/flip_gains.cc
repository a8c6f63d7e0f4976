#include "pipelines/forward_map/flip_gains.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "schema/error.h"

namespace cairn::forward_map {
namespace {

// Ratios whose product is taken before its logarithm: far from the range of doubles, for each lies between
// floor / peak and its inverse.
constexpr int kRatiosOfLog = 8;

template <class Value>
void Group(std::span<const std::int32_t> key_of, std::span<const Value> values, std::size_t keys,
           std::vector<std::uint64_t>* first, std::vector<Value>* grouped) {
  first->assign(keys + 1, 0);
  for (const std::int32_t key : key_of) ++(*first)[static_cast<std::size_t>(key) + 1];
  for (std::size_t k = 0; k < keys; ++k) (*first)[k + 1] += (*first)[k];
  std::vector<std::uint64_t> next(first->begin(), first->end() - 1);
  grouped->resize(values.size());
  for (std::size_t n = 0; n < values.size(); ++n)
    (*grouped)[next[static_cast<std::size_t>(key_of[n])]++] = values[n];
}

}  // namespace

FlipGains::FlipGains(std::int32_t cells, std::vector<SensorModel> models)
    : models_(std::move(models)), occupied_(static_cast<std::size_t>(cells)) {
  window_.first.push_back(0);
}

void FlipGains::Add(double z_m, std::size_t model_index, std::span<const Crossing> beam, End end) {
  const SensorModel& model = models_[model_index];
  const double first_m = z_m - kReach * model.sigma_m, reach_m = ReachOf(z_m, model);
  const double lost = model.p_lost * DensityOfNone(z_m, model, End::kInMap);
  // [Thr01] eqs 5, 6, 9
  Reading reading{.floor = model.p_rand / model.z_max_m + lost,
                  .none = model.p_sound() * DensityOfNone(z_m, model, end),
                  .model = static_cast<std::uint32_t>(model_index)};
  window_of_beam_.clear();
  for (const Crossing& crossing : beam) {
    if (crossing.distance_m > reach_m) continue;
    if (crossing.distance_m >= first_m)
      window_of_beam_.push_back(crossing);
    else if (crossing.cell == kElsewhere)
      ++reading.before;
    else
      before_cell_.push_back(crossing.cell);
  }
  std::ranges::sort(window_of_beam_, [](const Crossing& a, const Crossing& b) {
    return std::tie(a.distance_m, a.cell) < std::tie(b.distance_m, b.cell);
  });
  std::vector<std::uint32_t> fixed;
  for (const auto& [cell, distance_m] : window_of_beam_) {
    if (cell == kElsewhere) fixed.push_back(static_cast<std::uint32_t>(weight_.size()));
    window_.value.push_back(cell);
    // [Thr01] eqs 4, 9
    weight_.push_back(model.p_sound() * model.p_hit * Normal(z_m - distance_m, model.sigma_m));
  }
  longest_ = std::max(longest_, beam.size());
  before_end_.push_back(before_cell_.size());
  window_.first.push_back(window_.value.size());
  readings_.push_back(reading);
  obstacles_.push_back(std::move(fixed));
}

void FlipGains::Transpose() {
  const std::size_t cells = occupied_.size();
  std::vector<std::uint32_t> reading_of;
  reading_of.reserve(before_cell_.size());
  for (std::uint32_t r = 0; r < readings_.size(); ++r) reading_of.resize(before_end_[r], r);
  Group<std::uint32_t>(before_cell_, reading_of, cells, &before_.first, &before_.value);
  before_cell_ = {};
  before_end_ = {};
  std::vector<Place> places;
  std::vector<std::int32_t> cell_of;
  places.reserve(window_.value.size());
  cell_of.reserve(window_.value.size());
  for (std::uint32_t r = 0; r < readings_.size(); ++r) {
    for (std::uint64_t e = window_.first[r]; e < window_.first[r + 1]; ++e) {
      if (window_.value[e] == kElsewhere) continue;
      cell_of.push_back(window_.value[e]);
      places.push_back({r, static_cast<std::uint32_t>(e)});
    }
  }
  Group<Place>(cell_of, places, cells, &places_.first, &places_.value);
}

void FlipGains::Start(std::span<const std::uint8_t> occupied) {
  CAIRN_DEMAND(occupied.size() == occupied_.size(), "a map of the tile's cells");
  CAIRN_DEMAND(weight_.size() <= std::numeric_limits<std::uint32_t>::max(), "a tile of bounded work");
  for (const SensorModel& model : models_) {
    std::vector<double> power = {1};
    while (power.size() < longest_ + 3) power.push_back(power.back() * (1 - model.p_hit));
    power_.push_back(std::move(power));
  }
  Transpose();
  for (std::size_t cell = 0; cell < occupied_.size(); ++cell)
    if (!places_.Of(cell).empty()) near_ends_.push_back(static_cast<std::int32_t>(cell));
  other_.resize(weight_.size());
  answers_.resize(readings_.size());
  kept_at_.resize(readings_.size());
  for (std::size_t cell = 0; cell < occupied_.size(); ++cell)
    if (occupied[cell] != 0) Change(cell);
  for (std::uint32_t r = 0; r < readings_.size(); ++r) {
    RefreshWindow(r);
    RefreshAnswer(r);
  }
}

// S, and what it would be after each flip, from sums of what lies before an entry and behind it: all terms
// are positive, so that nothing cancels.
void FlipGains::RefreshWindow(std::uint32_t index) {
  Reading& reading = readings_[index];
  const double q = 1 - models_[reading.model].p_hit;
  const std::vector<std::uint32_t>& obstacles = obstacles_[index];
  const std::size_t count = obstacles.size();
  // tails_[k]: S of the obstacles from the k-th on, had none been passed.
  tails_.resize(count + 1);
  tails_[count] = reading.none;
  for (std::size_t k = count; k-- > 0;) tails_[k] = weight_[obstacles[k]] + q * tails_[k + 1];
  double before = 0, passed = 1;
  std::size_t entry = window_.first[index];
  for (std::size_t k = 0; k <= count; ++k) {
    const std::size_t end = k < count ? obstacles[k] : window_.first[index + 1];
    const double around = before + passed * q * tails_[k];
    for (; entry < end; ++entry) other_[entry] = around + passed * weight_[entry];
    if (k == count) break;
    other_[entry] = before + passed * tails_[k + 1];
    before += passed * weight_[entry];
    passed *= q;
    ++entry;
  }
  reading.sum = tails_[0];
}

void FlipGains::RefreshAnswer(std::uint32_t index) {
  const Reading& reading = readings_[index];
  const std::vector<double>& power = power_[reading.model];
  const auto before = static_cast<std::size_t>(reading.before);
  const double now = reading.floor + power[before] * reading.sum;
  Answer& answer = answers_[index];
  answer.constant = reading.floor / now;
  answer.slope = power[before] / now;
  if (reading.sum == 0) {  // random whatever lies before
    answer.more = answer.less = 0;
    return;
  }
  answer.more = std::log((reading.floor + power[before + 1] * reading.sum) / now);
  answer.less = before == 0 ? 0 : std::log((reading.floor + power[before - 1] * reading.sum) / now);
}

// [Thr01] eq. 12 with the terms that it leaves out: what a flip adds to log p(Z | m)
double FlipGains::GainOf(std::int32_t cell) const {
  const auto c = static_cast<std::size_t>(cell);
  double gain = 0;
  if (occupied_[c] != 0) {
    for (const std::uint32_t reading : before_.Of(c)) gain += answers_[reading].less;
  } else {
    for (const std::uint32_t reading : before_.Of(c)) gain += answers_[reading].more;
  }
  double product = 1;
  int factors = 0;
  for (const auto [reading, entry] : places_.Of(c)) {
    product *= answers_[reading].constant + answers_[reading].slope * other_[entry];
    if (++factors % kRatiosOfLog != 0) continue;
    gain += std::log(product);
    product = 1;
  }
  return gain + std::log(product);
}

void FlipGains::Change(std::size_t cell) {
  occupied_[cell] ^= 1;
  for (const std::uint32_t reading : before_.Of(cell))
    readings_[reading].before += occupied_[cell] != 0 ? 1 : -1;
  for (const auto [reading, entry] : places_.Of(cell)) {
    std::vector<std::uint32_t>& obstacles = obstacles_[reading];
    const auto at = std::ranges::lower_bound(obstacles, entry);
    if (occupied_[cell] != 0)
      obstacles.insert(at, entry);
    else
      obstacles.erase(at);
  }
}

void FlipGains::Flip(std::int32_t cell) {
  const auto c = static_cast<std::size_t>(cell);
  Change(c);
  for (const std::uint32_t reading : before_.Of(c)) RefreshAnswer(reading);
  for (const auto [reading, entry] : places_.Of(c)) {
    RefreshWindow(reading);
    RefreshAnswer(reading);
  }
}

void FlipGains::Keep(std::int32_t cell) {
  const auto c = static_cast<std::size_t>(cell);
  ++kept_;
  for (const std::uint32_t reading : before_.Of(c)) kept_at_[reading] = kept_;
  for (const auto [reading, entry] : places_.Of(c)) kept_at_[reading] = kept_;
}

bool FlipGains::ChangedSince(std::int32_t cell, std::uint64_t kept) const {
  const auto c = static_cast<std::size_t>(cell);
  for (const auto [reading, entry] : places_.Of(c))
    if (kept_at_[reading] > kept) return true;
  for (const std::uint32_t reading : before_.Of(c))
    if (kept_at_[reading] > kept) return true;
  return false;
}

bool FlipGains::Seen(std::int32_t cell) const {
  const auto c = static_cast<std::size_t>(cell);
  return !before_.Of(c).empty() || !places_.Of(c).empty();
}

std::vector<FlipGains::Look> FlipGains::LooksAt(std::int32_t cell) const {
  const auto c = static_cast<std::size_t>(cell);
  std::vector<Look> looks;
  for (const std::uint32_t r : before_.Of(c)) {
    const Reading& reading = readings_[r];
    const double passed = power_[reading.model][static_cast<std::size_t>(reading.before)] * reading.sum;
    looks.push_back({r, 0, passed / (reading.floor + passed)});
  }
  for (const auto [r, entry] : places_.Of(c)) {
    const Reading& reading = readings_[r];
    const double q = 1 - models_[reading.model].p_hit;
    double reached = power_[reading.model][static_cast<std::size_t>(reading.before)],
           later = reached * reading.sum;
    const double all = reading.floor + later;
    for (const std::uint32_t obstacle : obstacles_[r]) {
      if (obstacle > entry) break;
      later -= reached * weight_[obstacle];
      if (obstacle == entry)
        looks.push_back({r, reached * weight_[obstacle] / all, std::max(0.0, later) / all});
      reached *= q;
    }
  }
  std::ranges::sort(looks, {}, &Look::reading);
  return looks;
}

std::vector<std::int32_t> FlipGains::Sharing(std::int32_t cell) const {
  std::vector<std::int32_t> cells;
  for (const auto [reading, entry] : places_.Of(static_cast<std::size_t>(cell))) {
    const auto more = window_.Of(reading);
    cells.insert(cells.end(), more.begin(), more.end());
  }
  std::ranges::sort(cells);
  cells.erase(std::ranges::unique(cells).begin(), cells.end());
  std::erase_if(cells, [&](std::int32_t other) { return other == cell || other == kElsewhere; });
  return cells;
}

}  // namespace cairn::forward_map
