#include "pipelines/forward_map/flip_gains.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "schema/error.h"

namespace cairn::forward_map {
namespace {

// Ratios whose product is taken before its logarithm: far from the range of doubles, for each lies between
// floor / peak and its inverse.
constexpr int kRatiosOfLog = 8;

template <class Key, class Value>
void Group(std::span<const Key> key_of, std::span<const Value> values, std::size_t keys,
           std::vector<std::uint64_t>* first, std::vector<Value>* grouped) {
  first->assign(keys + 1, 0);
  for (const Key key : key_of) ++(*first)[static_cast<std::size_t>(key) + 1];
  for (std::size_t k = 0; k < keys; ++k) (*first)[k + 1] += (*first)[k];
  std::vector<std::uint64_t> next(first->begin(), first->end() - 1);
  grouped->resize(values.size());
  for (std::size_t n = 0; n < values.size(); ++n)
    (*grouped)[next[static_cast<std::size_t>(key_of[n])]++] = values[n];
}

}  // namespace

FlipGains::FlipGains(std::int32_t cells, std::vector<SensorModel> models)
    : models_(std::move(models)), occupied_(static_cast<std::size_t>(cells)) {
  window_cell_.first.push_back(0);
}

void FlipGains::Add(double z_m, std::size_t model_index, std::span<const Crossing> beam) {
  const SensorModel& model = models_[model_index];
  const double first_m = z_m - kReach * model.sigma_m, reach_m = ReachOf(z_m, model);
  const auto number = static_cast<std::uint32_t>(readings_.size());
  Reading reading{.floor = model.p_rand / model.z_max_m,
                  .none = (1 - model.p_rand) * Normal(z_m - model.z_max_m, model.no_echo_m),
                  .sum = 0,
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
  std::vector<Obstacle> fixed;
  for (std::uint32_t order = 0; order < window_of_beam_.size(); ++order) {
    const auto [cell, distance_m] = window_of_beam_[order];
    const double weight = (1 - model.p_rand) * model.p_hit * Normal(z_m - distance_m, model.sigma_m);
    if (cell == kElsewhere) {
      fixed.push_back({order, weight});
      continue;
    }
    window_cell_.value.push_back(cell);
    window_entry_.push_back({number, order, weight});
  }
  longest_ = std::max(longest_, beam.size());
  before_end_.push_back(before_cell_.size());
  window_cell_.first.push_back(window_cell_.value.size());
  readings_.push_back(reading);
  obstacles_.push_back(std::move(fixed));
}

void FlipGains::Transpose() {
  const std::size_t cells = occupied_.size();
  std::vector<std::uint32_t> reading_of;
  reading_of.reserve(before_cell_.size());
  for (std::uint32_t r = 0; r < readings_.size(); ++r) reading_of.resize(before_end_[r], r);
  Group<std::int32_t, std::uint32_t>(before_cell_, reading_of, cells, &before_.first, &before_.value);
  before_cell_ = {};
  before_end_ = {};
  Group<std::int32_t, Entry>(window_cell_.value, window_entry_, cells, &window_.first, &window_.value);
  window_entry_ = {};
}

void FlipGains::Start(std::span<const std::uint8_t> occupied) {
  CAIRN_DEMAND(occupied.size() == occupied_.size(), "a map of the tile's cells");
  for (const SensorModel& model : models_) {
    std::vector<double> power = {1};
    while (power.size() < longest_ + 3) power.push_back(power.back() * (1 - model.p_hit));
    power_.push_back(std::move(power));
  }
  Transpose();
  for (std::size_t cell = 0; cell < occupied_.size(); ++cell)
    if (!window_.Of(cell).empty()) near_ends_.push_back(static_cast<std::int32_t>(cell));
  more_.resize(readings_.size());
  less_.resize(readings_.size());
  for (std::size_t cell = 0; cell < occupied_.size(); ++cell)
    if (occupied[cell] != 0) Change(cell);
  for (std::uint32_t r = 0; r < readings_.size(); ++r) Refresh(r);
}

void FlipGains::Refresh(std::uint32_t index) {
  Reading& reading = readings_[index];
  const double q = 1 - models_[reading.model].p_hit;
  double sum = 0, passed = 1;
  for (Obstacle& obstacle : obstacles_[index]) {
    obstacle.sum_before = sum;
    obstacle.passed = passed;
    sum += passed * obstacle.weight;
    passed *= q;
  }
  reading.sum = sum + passed * reading.none;
  if (reading.sum == 0) {  // random whatever lies before
    more_[index] = less_[index] = 0;
    return;
  }
  const std::vector<double>& power = power_[reading.model];
  const auto before = static_cast<std::size_t>(reading.before);
  const double now = reading.floor + power[before] * reading.sum;
  more_[index] = std::log((reading.floor + power[before + 1] * reading.sum) / now);
  less_[index] = before == 0 ? 0 : std::log((reading.floor + power[before - 1] * reading.sum) / now);
}

double FlipGains::SumWith(const Reading& reading, std::span<const Obstacle> obstacles,
                          const Entry& entry) const {
  const double q = 1 - models_[reading.model].p_hit;
  std::size_t k = 0;
  while (k < obstacles.size() && obstacles[k].order < entry.order) ++k;
  if (k == 0) return entry.weight + q * reading.sum;
  const Obstacle& nearer = obstacles[k - 1];
  const double before = nearer.sum_before + nearer.passed * nearer.weight, passed = nearer.passed * q;
  // What follows loses a factor q. The difference is exact enough: the sum is at least q times S.
  return before + passed * entry.weight + q * (reading.sum - before);
}

double FlipGains::SumWithout(const Reading& reading, std::span<const Obstacle> obstacles,
                             const Entry& entry) const {
  const double q = 1 - models_[reading.model].p_hit;
  double sum = 0, passed = 1;
  for (const Obstacle& obstacle : obstacles) {
    if (obstacle.order == entry.order) continue;
    sum += passed * obstacle.weight;
    passed *= q;
  }
  return sum + passed * reading.none;
}

double FlipGains::RatioOf(const Entry& entry, bool occupied) const {
  const Reading& reading = readings_[entry.reading];
  const std::span<const Obstacle> obstacles = obstacles_[entry.reading];
  const double passed = power_[reading.model][static_cast<std::size_t>(reading.before)];
  const double sum = occupied ? SumWithout(reading, obstacles, entry) : SumWith(reading, obstacles, entry);
  return (reading.floor + passed * sum) / (reading.floor + passed * reading.sum);
}

double FlipGains::GainOf(std::int32_t cell) const {
  const auto c = static_cast<std::size_t>(cell);
  const bool occupied = occupied_[c] != 0;
  const std::vector<double>& step = occupied ? less_ : more_;
  double gain = 0;
  for (const std::uint32_t reading : before_.Of(c)) gain += step[reading];
  double product = 1;
  int factors = 0;
  for (const Entry& entry : window_.Of(c)) {
    product *= RatioOf(entry, occupied);
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
  for (const Entry& entry : window_.Of(cell)) {
    std::vector<Obstacle>& obstacles = obstacles_[entry.reading];
    const auto at = std::ranges::lower_bound(obstacles, entry.order, {}, &Obstacle::order);
    if (occupied_[cell] != 0)
      obstacles.insert(at, {entry.order, entry.weight});
    else
      obstacles.erase(at);
  }
}

void FlipGains::Flip(std::int32_t cell) {
  const auto c = static_cast<std::size_t>(cell);
  Change(c);
  for (const std::uint32_t reading : before_.Of(c)) Refresh(reading);
  for (const Entry& entry : window_.Of(c)) Refresh(entry.reading);
}

bool FlipGains::Seen(std::int32_t cell) const {
  const auto c = static_cast<std::size_t>(cell);
  return !before_.Of(c).empty() || !window_.Of(c).empty();
}

std::vector<FlipGains::Look> FlipGains::LooksAt(std::int32_t cell) const {
  const auto c = static_cast<std::size_t>(cell);
  std::vector<Look> looks;
  for (const std::uint32_t r : before_.Of(c)) {
    const Reading& reading = readings_[r];
    const double passed = power_[reading.model][static_cast<std::size_t>(reading.before)] * reading.sum;
    looks.push_back({r, 0, passed / (reading.floor + passed)});
  }
  for (const Entry& entry : window_.Of(c)) {
    const Reading& reading = readings_[entry.reading];
    const double q = 1 - models_[reading.model].p_hit;
    double reached = power_[reading.model][static_cast<std::size_t>(reading.before)],
           later = reached * reading.sum;
    const double all = reading.floor + later;
    for (const Obstacle& obstacle : obstacles_[entry.reading]) {
      if (obstacle.order > entry.order) break;
      later -= reached * obstacle.weight;
      if (obstacle.order == entry.order)
        looks.push_back({entry.reading, reached * obstacle.weight / all, std::max(0.0, later) / all});
      reached *= q;
    }
  }
  std::ranges::sort(looks, {}, &Look::reading);
  return looks;
}

std::vector<std::int32_t> FlipGains::Sharing(std::int32_t cell) const {
  std::vector<std::int32_t> cells;
  for (const Entry& entry : window_.Of(static_cast<std::size_t>(cell))) {
    const auto more = window_cell_.Of(entry.reading);
    cells.insert(cells.end(), more.begin(), more.end());
  }
  std::ranges::sort(cells);
  cells.erase(std::ranges::unique(cells).begin(), cells.end());
  std::erase(cells, cell);
  return cells;
}

std::size_t FlipGains::byte_count() const {
  return readings_.size() * (sizeof(Reading) + sizeof(obstacles_[0]) + 2 * sizeof(double)) +
         before_.value.size() * sizeof(std::uint32_t) +
         window_.value.size() * (sizeof(Entry) + sizeof(std::int32_t));
}

}  // namespace cairn::forward_map
