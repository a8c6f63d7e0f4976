#include "pipelines/landmark_map/refinement/row_associations.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace cairn::landmark_map {
namespace {

constexpr double kGateSigmas = 4.0;

// exp(-d^2 / 2), d in standard deviations along the ray of what was seen and across it.
double LikelihoodOf(const Landmark& landmark, const RefinedPath::Pose& pose, double range_m,
                    double bearing_rad, const ObservationNoise& noise) {
  const double dx = landmark.x_m - pose.x_m, dy = landmark.y_m - pose.y_m;
  const double ray = pose.heading_rad + bearing_rad;
  const double along = std::cos(ray) * dx + std::sin(ray) * dy - range_m;
  const double across = -std::sin(ray) * dx + std::cos(ray) * dy;
  const ObservationWidths widths = noise.At(range_m, 0.0);
  const double a = along / widths.along_m, b = across / widths.across_m;
  return std::exp(-0.5 * (a * a + b * b));
}

}  // namespace

int LandmarkNamed(const std::vector<Landmark>& landmarks, int identity) {
  const auto found = std::ranges::find(landmarks, identity, &Landmark::type);
  return found == landmarks.end() ? -1 : static_cast<int>(found - landmarks.begin());
}

RowAssociations RowsOfEm(const AssociatedPath& path, const kinds::Log::Observations& seen,
                         const std::vector<Landmark>& landmarks) {
  RowAssociations rows;
  for (std::size_t i = 0; i < path.steps.row_observation.size(); ++i) {
    const std::int32_t used = path.steps.row_observation[i];
    const auto k = static_cast<std::size_t>(used);
    const bool before = used < 0 && seen.landmark[i] >= 0 && seen.time_s[i] < path.steps.time_s[0];
    const int named = before ? LandmarkNamed(landmarks, seen.landmark[i]) : -1;
    rows.landmark.push_back(used < 0 ? named : path.associated.landmark[k]);
    rows.probability.push_back(used < 0 ? (named < 0 ? 0.0 : 1.0) : path.associated.probability[k]);
  }
  return rows;
}

RowAssociations RowsSeenFrom(const RefinedPath& refined, RowAssociations rows,
                             const kinds::Log::Observations& seen, const std::vector<Landmark>& landmarks,
                             const ObservationNoise& noise, double until_s) {
  const auto time = seen.time_s.values(), range = seen.range_m.values(), bearing = seen.bearing_rad.values();
  const auto identity = seen.landmark.values();
  const double missed = std::exp(-0.5 * kGateSigmas * kGateSigmas);
  for (std::size_t begin = 0, end = 0; begin < time.size() && time[begin] <= until_s; begin = end) {
    const RefinedPath::Pose pose = refined.At(time[begin]);
    std::vector<std::tuple<double, std::size_t, std::int32_t>> pairs;  // the best first
    for (end = begin; end < time.size() && time[end] == time[begin]; ++end) {
      if (identity[end] >= 0 || std::isnan(range[end])) continue;
      rows.landmark[end] = -1;
      rows.probability[end] = 0.0;
      std::vector<double> likelihood;
      double all = missed;
      for (const Landmark& landmark : landmarks) {
        likelihood.push_back(LikelihoodOf(landmark, pose, range[end], bearing[end], noise));
        all += likelihood.back();
      }
      for (std::size_t l = 0; l < landmarks.size(); ++l) {
        if (likelihood[l] >= 0.5 * all)
          pairs.emplace_back(-likelihood[l] / all, end, static_cast<std::int32_t>(l));
      }
    }
    std::ranges::sort(pairs);
    const auto shown = [&](std::int32_t landmark) {
      const auto from = rows.landmark.begin() + static_cast<std::ptrdiff_t>(begin);
      return std::find(from, rows.landmark.begin() + static_cast<std::ptrdiff_t>(end), landmark);
    };
    for (const auto& [unlikely, row, landmark] : pairs) {
      if (shown(landmark) != rows.landmark.begin() + static_cast<std::ptrdiff_t>(end)) continue;
      rows.landmark[row] = landmark;
      rows.probability[row] = -unlikely;
    }
  }
  return rows;
}

std::vector<bool> WithoutDoubles(const std::vector<Landmark>& landmarks, int names,
                                 const std::vector<const kinds::Log::Observations*>& seen,
                                 const std::vector<RowAssociations>& rows, double reach_m) {
  constexpr std::int64_t kLeast = 2;
  constexpr double kTogether = 0.1;  // of the rarer one's images show both: they are two
  const std::size_t n = landmarks.size();
  std::vector<std::int64_t> count(n, 0), together(n * n, 0);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto time = seen[r]->time_s.values();
    for (std::size_t i = 0; i < time.size(); ++i) {
      const std::int32_t a = rows[r].landmark[i];
      if (a < 0) continue;
      ++count[static_cast<std::size_t>(a)];
      for (std::size_t k = i + 1; k < time.size() && time[k] == time[i]; ++k) {
        const std::int32_t b = rows[r].landmark[k];
        if (b >= 0)
          ++together[static_cast<std::size_t>(std::min(a, b)) * n + static_cast<std::size_t>(std::max(a, b))];
      }
    }
  }
  const auto is_named = [&](std::size_t l) { return landmarks[l].type < names; };
  std::vector<bool> keep(n, true);
  for (std::size_t a = 0; a < n; ++a) {
    if (!is_named(a)) keep[a] = keep[a] && count[a] >= kLeast;
    for (std::size_t b = a + 1; b < n; ++b) {
      if ((is_named(a) && is_named(b)) || !keep[a] || !keep[b]) continue;
      if (std::hypot(landmarks[a].x_m - landmarks[b].x_m, landmarks[a].y_m - landmarks[b].y_m) > reach_m)
        continue;
      // That which may go.
      const bool is_a = is_named(b) || (!is_named(a) && count[a] < count[b]);
      const auto rarer = static_cast<double>(is_named(a) || is_named(b) ? count[is_a ? a : b]
                                                                        : std::min(count[a], count[b]));
      if (static_cast<double>(together[a * n + b]) <= kTogether * rarer) keep[is_a ? a : b] = false;
    }
  }
  return keep;
}

}  // namespace cairn::landmark_map
