#include "pipelines/common/checked_readings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipelines/common/beam_cells.h"
#include "schema/kinds/grid_map.h"
#include "schema/kinds/log.h"

namespace cairn {
namespace {

constexpr double kFarthestSigmas = 6;
constexpr double kNegligible = 1e-9;
// The probabilities of an obstacle that maps may have whose cells are all alike.
constexpr std::array kAlike = {3e-4, 1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3};
// What the sensor may be like, in each map's own best way: sigma in units of what it is taken for.
constexpr std::array kHits = {0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 0.9};
constexpr std::array kRandoms = {0.02, 0.05, 0.1, 0.2, 0.4, 0.8};
constexpr std::array kSigmas = {1.0, 2.0, 4.0};

double NormalDensity(double x_m, double sigma_m) {
  const double t = x_m / sigma_m;
  if (std::abs(t) > kFarthestSigmas) return 0;
  return std::exp(-0.5 * t * t) * (std::numbers::inv_sqrtpi / (std::numbers::sqrt2 * sigma_m));
}

struct CheckedReading {
  double z_m = 0;
  bool ends_beyond = false;
  std::vector<MetCell> cells;  // q: NaN where nothing is known
};

// The cells up to where they may matter.
CheckedReading ReadingOf(const TakenReading& taken, double opening_rad, const GridBox& box,
                         std::span<const double> probability, const ReadingModel& model) {
  const bool echo = kinds::IsEcho(taken.range_m, model.z_max_m);
  const Pose& from = taken.from;
  CheckedReading reading;
  reading.z_m = echo ? taken.range_m : model.z_max_m;
  if (echo)
    reading.ends_beyond = !box.Holds(box.ColumnOf(from.x_m + taken.range_m * std::cos(from.heading_rad)),
                                     box.RowOf(from.y_m + taken.range_m * std::sin(from.heading_rad)));
  std::vector<BeamCell> cells;
  BeamCells(box, from, opening_rad, reading.z_m + kFarthestSigmas * kSigmas.back() * model.sigma_m, &cells);
  for (const BeamCell& cell : cells)
    reading.cells.push_back({cell.distance_m, probability[static_cast<std::size_t>(cell.cell)]});
  return reading;
}

// Calls `visit` with the place of each reading that could be taken.
template <class Visit>
void ForEachReading(const RangeScans& scans, const ReadingModel& model, const Visit& visit) {
  const auto range = scans.range_m.As<double>();
  const std::size_t beams = scans.beams.size();
  for (std::size_t s = 0; s < scans.scans(); ++s) {
    if (scans.checked[s] == 0) continue;
    for (std::size_t at = s * beams; at < (s + 1) * beams; ++at)
      if (model.no_echo || kinds::IsEcho(range[at], model.z_max_m)) visit(at);
  }
}

double SumOfLogs(const std::vector<CheckedReading>& readings, const ReadingModel& model) {
  double sum = 0;
  for (const CheckedReading& reading : readings)
    sum += std::log(DensityOf(reading.z_m, reading.cells, model, reading.ends_beyond));
  return sum;
}

// Looks for the candidate under which `sum` is highest, from `highest` on.
template <class Candidates, class Sum>
void Climb(const Candidates& candidates, const Sum& sum, double* best, double* highest) {
  for (const double candidate : candidates) {
    const double there = sum(candidate);
    if (!(there > *highest)) continue;
    *highest = there;
    *best = candidate;
  }
}

// Of the sensor that explains the readings best in this map.
double BestSumOfLogs(const std::vector<CheckedReading>& readings, const ReadingModel& start) {
  ReadingModel best = start;
  double highest = SumOfLogs(readings, best);
  const auto climb = [&](const auto& candidates, double ReadingModel::* field, double unit) {
    const auto sum = [&](double candidate) {
      ReadingModel model = best;
      model.*field = candidate * unit;
      return SumOfLogs(readings, model);
    };
    double found = best.*field / unit;
    Climb(candidates, sum, &found, &highest);
    best.*field = found * unit;
  };
  for (int round = 0; round < 2; ++round) {
    climb(kHits, &ReadingModel::p_hit, 1);
    climb(kRandoms, &ReadingModel::p_rand, 1);
    climb(kSigmas, &ReadingModel::sigma_m, start.sigma_m);
  }
  return highest;
}

// Of the map whose cells are all alike: what it makes of the readings at best, and its cells' probability
// then.
struct Alike {
  double q = 0, sum = -std::numeric_limits<double>::infinity();
};
Alike BestAlike(std::vector<CheckedReading> readings, ReadingModel model) {
  Alike best;
  const auto with = [&](double q) {
    for (CheckedReading& reading : readings)
      for (MetCell& cell : reading.cells) cell.q = q;
    return SumOfLogs(readings, model);
  };
  Climb(kAlike, with, &best.q, &best.sum);
  const auto with_random = [&](double p_rand) {
    model.p_rand = p_rand;
    return with(best.q);
  };
  double p_rand = model.p_rand;
  Climb(kRandoms, with_random, &p_rand, &best.sum);
  model.p_rand = p_rand;
  Climb(kAlike, with, &best.q, &best.sum);
  return best;
}

// As people read a map: many cells that are a little doubtful would stop any beam on its way.
void Decide(double alike, std::vector<CheckedReading>* readings) {
  for (CheckedReading& reading : *readings) {
    std::erase_if(reading.cells, [](const MetCell& cell) { return cell.q < 0.5; });
    for (MetCell& cell : reading.cells) cell.q = cell.q > 0.5 ? 1.0 : alike;
  }
}

}  // namespace

double DensityOf(double z_m, std::span<const MetCell> cells, const ReadingModel& model, bool ends_beyond) {
  const double no_echo = NormalDensity(z_m - model.z_max_m, model.no_echo_m);
  double reached = 1 - model.p_rand - model.p_lost;
  double density = model.p_rand / model.z_max_m + model.p_lost * no_echo;
  for (const MetCell& cell : cells) {
    const double hit = cell.q * model.p_hit;
    density += reached * hit * NormalDensity(z_m - cell.distance_m, model.sigma_m);
    reached *= 1 - hit;
    if (reached < kNegligible) break;
  }
  return density + reached * (ends_beyond ? 1 / model.z_max_m : no_echo);
}

RangeScans CheckedOnly(RangeScans scans) {
  for (std::size_t s = 0; s < scans.scans(); ++s)
    scans.held_out[s] = scans.held_out[s] != 0 || scans.checked[s] == 0 ? 1 : 0;
  return scans;
}

RangeScans WithoutChecked(RangeScans scans) {
  for (std::size_t s = 0; s < scans.scans(); ++s)
    scans.held_out[s] = scans.held_out[s] != 0 || scans.checked[s] != 0 ? 1 : 0;
  return scans;
}

void CheckedReadings::Add(const CheckedReadings& other) {
  readings += other.readings;
  log_likelihood += other.log_likelihood;
  ignorant += other.ignorant;
}

std::int64_t CountReadings(const RangeScans& part, const ReadingModel& model) {
  std::int64_t count = 0;
  ForEachReading(part, model, [&count](std::size_t) { ++count; });
  return count;
}

std::vector<TakenReading> TakeReadings(const RangeScans& part, const ReadingModel& model, std::int64_t before,
                                       std::int64_t all) {
  const std::size_t count = std::min(static_cast<std::size_t>(all), kMostChecked);
  const auto place = [&](std::size_t i) { return i * static_cast<std::size_t>(all) / count; };
  std::size_t next = 0, number = static_cast<std::size_t>(before);
  while (next < count && place(next) < number) ++next;
  std::vector<TakenReading> taken;
  const std::size_t beams = part.beams.size();
  ForEachReading(part, model, [&](std::size_t at) {
    if (next == count || place(next) != number++) return;
    taken.push_back({part.BeamPose(at / beams, at % beams), part.range_m.As<double>()[at]});
    ++next;
  });
  return taken;
}

CheckedReadings Check(std::span<const TakenReading> taken, double opening_rad, const GridBox& box,
                      std::span<const double> probability, const ReadingModel& model) {
  std::vector<CheckedReading> readings;
  for (const TakenReading& of : taken)
    readings.push_back(ReadingOf(of, opening_rad, box, probability, model));
  if (readings.empty()) return {};
  const Alike alike = BestAlike(readings, model);
  Decide(alike.q, &readings);
  return {static_cast<std::int64_t>(readings.size()), BestSumOfLogs(readings, model), alike.sum};
}

CheckedReadings Check(const RangeScans& scans, const GridBox& box, std::span<const double> probability,
                      const ReadingModel& model) {
  return Check(TakeReadings(scans, model, 0, CountReadings(scans, model)), scans.opening_rad, box,
               probability, model);
}

void PutCheck(const CheckedReadings& checked, Blob* result) {
  if (checked.readings == 0) return;
  const auto count = static_cast<double>(checked.readings);
  kinds::GridMap::Fit fit;
  fit.checked_readings = checked.readings;
  fit.checked_nats = checked.log_likelihood / count;
  fit.ignorant_nats = checked.ignorant / count;
  PutFields("fit/", fit, result);
}

}  // namespace cairn
