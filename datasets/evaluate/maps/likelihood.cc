#include "datasets/evaluate/maps/likelihood.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace cairn::datasets {
namespace {

constexpr double kFarthestSd = 6;      // cells further behind a reading do not matter to it
constexpr double kWidestSigmaM = 0.5;  // that is fitted
constexpr double kNarrowestSigmaM = 0.005;
constexpr double kNegligible = 1e-6;  // a cell less probable is none
constexpr std::size_t kMostTraining = 2000;

double Normal(double x_m, double sigma_m) {
  const double u = x_m / sigma_m;
  return std::exp(-0.5 * u * u) / (sigma_m * std::sqrt(2 * std::numbers::pi));
}

bool InCone(const Pose& from, double half_rad, double reach_m, Point at) {
  const double dx = at.x_m - from.x_m, dy = at.y_m - from.y_m, distance = std::hypot(dx, dy);
  const double along = dx * std::cos(from.heading_rad) + dy * std::sin(from.heading_rad);
  return distance <= reach_m && along >= std::cos(half_rad) * distance;
}

// Every n-th of the readings that the map was made of, so that kMostTraining are left.
std::vector<ScoredReading> TrainingReadings(const BeamReader& reader, const ScoredSensor& sensor) {
  std::vector<std::size_t> known;
  for (std::size_t scan = 0; scan < sensor.poses.size(); ++scan) {
    if (sensor.held_out[scan] != 0) continue;
    for (std::size_t beam = 0; beam < sensor.beams.size(); ++beam)
      known.push_back(scan * sensor.beams.size() + beam);
  }
  std::vector<ScoredReading> readings;
  const std::size_t count = std::min(known.size(), kMostTraining);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = known[i * known.size() / count];
    readings.push_back(reader.Read(sensor, at / sensor.beams.size(), at % sensor.beams.size()));
  }
  return readings;
}

double SumOf(const std::vector<ScoredReading>& readings, const ReadingModel& model) {
  double sum = 0;
  for (const ScoredReading& reading : readings) sum += LogDensity(reading, model);
  return sum;
}

// The parameters on scales on which steps are alike: logits, a logarithm.
using Scaled = std::array<double, 3>;
double FromLogit(double x) { return 1 / (1 + std::exp(-x)); }
double Logit(double p) { return std::log(p / (1 - p)); }
ReadingModel ModelOf(const Scaled& at) {
  return {std::clamp(FromLogit(at[0]), 0.001, 0.999), std::clamp(FromLogit(at[1]), 0.0001, 0.999),
          std::clamp(std::exp(at[2]), kNarrowestSigmaM, kWidestSigmaM)};
}

}  // namespace

double LogDensity(const ScoredReading& reading, const ReadingModel& model) {
  double reached = 1, hit = 0;  // reached: prod (1 - q_j p_hit) of the cells before
  for (const MetCell& cell : reading.cells) {
    if (reading.echo && cell.distance_m > reading.z_m + kFarthestSd * model.sigma_m) break;
    const double q = cell.q * model.p_hit;
    if (reading.echo && std::abs(cell.distance_m - reading.z_m) <= kFarthestSd * model.sigma_m)
      // [Thr01] eqs 4, 9
      hit += reached * q * Normal(reading.z_m - cell.distance_m, model.sigma_m);
    reached *= 1 - q;
  }
  const double told = reading.echo ? hit : reached * Normal(0, kNoEchoSdM);
  // [Thr01] eqs 4 to 9
  return std::log(model.p_rand / reading.max_range_m + (1 - model.p_rand) * told);
}

BeamReader::BeamReader(const Occupancy& map) : map_(map) {
  double sum = 0, known = 0;
  for (const double p : map.probability) {
    if (std::isnan(p)) continue;
    sum += p;
    known += 1;
  }
  unknown_ = known > 0 ? sum / known : 0.5;
}

ScoredReading BeamReader::Read(const ScoredSensor& sensor, std::size_t scan, std::size_t beam) const {
  ScoredReading reading;
  const double z_m = sensor.range_m[scan * sensor.beams.size() + beam];
  reading.echo = !std::isnan(z_m);
  reading.max_range_m = sensor.max_range_m;
  reading.z_m = reading.echo ? z_m : sensor.max_range_m;
  const double reach_m =
      std::min(sensor.max_range_m, reading.z_m + (reading.echo ? kFarthestSd * kWidestSigmaM : 0));
  const Pose from = sensor.BeamPose(scan, beam);
  if (sensor.opening_rad > 0) AddCone(from, sensor.opening_rad / 2, reach_m, &reading);
  AddRay(from, sensor.opening_rad / 2, reach_m, &reading);
  std::ranges::stable_sort(reading.cells, {}, &MetCell::distance_m);
  return reading;
}

void BeamReader::Add(std::int64_t column, std::int64_t row, double distance_m, ScoredReading* reading) const {
  const double p = map_.probability[map_.box.Index(column, row)];
  const double q = std::isnan(p) ? unknown_ : p;
  if (q > kNegligible) reading->cells.push_back({distance_m, q});
}

// Row by row: in each the centres between the cone's two edges.
void BeamReader::AddCone(const Pose& from, double half_rad, double reach_m, ScoredReading* reading) const {
  const GridBox& box = map_.box;
  double low = 0, high = 0, left = 0, right = 0;
  for (const double off : {-half_rad, 0.0, half_rad}) {
    const double x = 1.1 * reach_m * std::cos(from.heading_rad + off),
                 y = 1.1 * reach_m * std::sin(from.heading_rad + off);
    low = std::min(low, y);
    high = std::max(high, y);
    left = std::min(left, x);
    right = std::max(right, x);
  }
  const std::int64_t last_row = std::min(box.rows - 1, box.RowOf(from.y_m + high));
  const std::int64_t last_column = std::min(box.columns - 1, box.ColumnOf(from.x_m + right));
  for (std::int64_t row = std::max<std::int64_t>(0, box.RowOf(from.y_m + low)); row <= last_row; ++row) {
    for (std::int64_t column = std::max<std::int64_t>(0, box.ColumnOf(from.x_m + left));
         column <= last_column; ++column) {
      const Point at = box.Centre(column, row);
      if (InCone(from, half_rad, reach_m, at)) Add(column, row, DistanceM({from.x_m, from.y_m}, at), reading);
    }
  }
}

// Where the ray crosses the borders of columns and of rows, in order: between two of them it is in one cell.
// Of a cone's axis only cells whose centre the cone misses.
void BeamReader::AddRay(const Pose& from, double half_rad, double reach_m, ScoredReading* reading) const {
  const GridBox& box = map_.box;
  const double ux = std::cos(from.heading_rad), uy = std::sin(from.heading_rad);
  std::vector<double> borders{0, reach_m};
  const auto add = [&](double start, double origin, double u, std::int64_t count) {
    if (u == 0) return;
    const double a = (start - origin) / box.cell_m, b = (start + reach_m * u - origin) / box.cell_m;
    const double first = std::max(0.0, std::ceil(std::min(a, b)));
    const double last = std::min(static_cast<double>(count), std::floor(std::max(a, b)));
    for (double i = first; i <= last; ++i) borders.push_back((origin + i * box.cell_m - start) / u);
  };
  add(from.x_m, box.origin_x_m, ux, box.columns);
  add(from.y_m, box.origin_y_m, uy, box.rows);
  std::ranges::sort(borders);
  for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
    if (borders[i] < 0 || borders[i + 1] > reach_m || borders[i + 1] - borders[i] <= 0) continue;
    const double middle = (borders[i] + borders[i + 1]) / 2;
    const std::int64_t column = box.ColumnOf(from.x_m + middle * ux), row = box.RowOf(from.y_m + middle * uy);
    if (!box.Holds(column, row)) continue;
    if (half_rad == 0) {
      Add(column, row, middle, reading);
    } else if (!InCone(from, half_rad, reach_m, box.Centre(column, row))) {
      Add(column, row, middle, reading);
    }
  }
}

ReadingModel FitReadingModel(const std::vector<ScoredReading>& readings) {
  Scaled best{Logit(0.7), Logit(0.05), std::log(0.05)};
  if (readings.empty()) return ModelOf(best);
  double highest = SumOf(readings, ModelOf(best));
  for (double step = 1; step > 0.02; step /= 2) {
    for (bool better = true; better;) {
      better = false;
      for (std::size_t k = 0; k < best.size(); ++k) {
        for (const double off : {-step, step}) {
          Scaled at = best;
          at[k] += off;
          const double sum = SumOf(readings, ModelOf(at));
          if (sum <= highest + 1e-9 * std::abs(highest)) continue;
          highest = sum;
          best = at;
          better = true;
        }
      }
    }
  }
  return ModelOf(best);
}

std::optional<HeldOutScore> ScoreHeldOut(const Occupancy& map, const std::vector<ScoredSensor>& sensors) {
  const BeamReader reader(map);
  HeldOutScore score;
  double sum = 0;
  for (const ScoredSensor& sensor : sensors) {
    if (std::ranges::count(sensor.held_out, 1) == 0) continue;
    SensorLikelihood of{sensor.name, FitReadingModel(TrainingReadings(reader, sensor)), 0, 0};
    for (std::size_t scan = 0; scan < sensor.poses.size(); ++scan) {
      if (sensor.held_out[scan] == 0) continue;
      for (std::size_t beam = 0; beam < sensor.beams.size(); ++beam)
        of.log_likelihood += LogDensity(reader.Read(sensor, scan, beam), of.model);
      of.readings += static_cast<std::int64_t>(sensor.beams.size());
    }
    score.readings += of.readings;
    sum += of.log_likelihood;
    score.sensors.push_back(std::move(of));
  }
  if (score.readings == 0) return std::nullopt;
  score.log_likelihood_per_reading = sum / static_cast<double>(score.readings);
  return score;
}

}  // namespace cairn::datasets
