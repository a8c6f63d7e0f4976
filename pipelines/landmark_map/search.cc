#include "pipelines/landmark_map/search.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <utility>

namespace cairn::landmark_map {
namespace {

// The nearest of `to` for each of `from`, -1 where there is none of its type.
std::vector<int> Nearest(const std::vector<Landmark>& from, const std::vector<Landmark>& to) {
  std::vector<int> nearest;
  for (const Landmark& l : from) {
    double best = std::numeric_limits<double>::infinity();
    int winner = -1;
    for (std::size_t k = 0; k < to.size(); ++k) {
      const double distance = std::hypot(to[k].x_m - l.x_m, to[k].y_m - l.y_m);
      if (to[k].type != l.type || distance >= best) continue;
      best = distance;
      winner = static_cast<int>(k);
    }
    nearest.push_back(winner);
  }
  return nearest;
}

}  // namespace

std::vector<StartingPoint> StartingPoints(const Settings& settings) {
  constexpr double kShorter = 0.4;  // of the first half's prefix
  const double sigma = settings.noise.heading_drift_rad_per_m;
  if (settings.starts < 2) return {{0.0, settings.growth_start}};
  std::vector<StartingPoint> points;
  const int starts = sigma > 0.0 ? settings.starts : 2;
  const int drifts = (starts + 1) / 2;
  for (int k = 0; k < starts; ++k) {
    const double steps_off = k % drifts - 0.5 * (drifts - 1);
    points.push_back(
        {steps_off * DriftStep(starts) * sigma, settings.growth_start * (k < drifts ? 1.0 : kShorter)});
  }
  return points;
}

double ScoreOf(const Candidate& candidate, const Settings& settings) {
  if (candidate.failure) return -std::numeric_limits<double>::infinity();
  const double sigma = settings.noise.heading_drift_rad_per_m;
  const double drift = sigma > 0.0 ? candidate.drift_rad_per_m / sigma : 0.0;
  return candidate.log_likelihood - 0.5 * drift * drift -
         std::log(settings.places) * static_cast<double>(candidate.landmarks.size());
}

bool SameMap(const std::vector<Landmark>& a, const std::vector<Landmark>& b) {
  if (a.size() != b.size()) return false;
  const std::vector<int> there = Nearest(a, b), back = Nearest(b, a);
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (there[k] < 0 || back[static_cast<std::size_t>(there[k])] != static_cast<int>(k)) return false;
  }
  return true;
}

Choice Choose(const std::vector<Candidate>& candidates, const Settings& settings) {
  std::vector<double> scores;
  Choice choice;
  for (const Candidate& candidate : candidates) {
    scores.push_back(ScoreOf(candidate, settings));
    if (scores.back() > scores[static_cast<std::size_t>(choice.best)])
      choice.best = static_cast<int>(scores.size()) - 1;
  }
  const Candidate& best = candidates[static_cast<std::size_t>(choice.best)];
  if (best.failure) throw InputError(*best.failure);
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (candidates[k].failure || SameMap(best.landmarks, candidates[k].landmarks)) continue;
    const double lead = scores[static_cast<std::size_t>(choice.best)] - scores[k];
    if (!choice.lead_nats || lead < *choice.lead_nats) choice.lead_nats = lead;
  }
  return choice;
}

std::vector<Proposal> ProposalsAround(const std::vector<Candidate>& candidates, int best,
                                      const Settings& settings) {
  constexpr std::size_t kRefits = 8;
  const Candidate& centre = candidates[static_cast<std::size_t>(best)];
  const double step = DriftStep(settings.starts) * settings.noise.heading_drift_rad_per_m;
  std::vector<Proposal> proposals;
  for (const double off : {-1.0, -0.5, 0.5, 1.0}) {
    const StartingPoint start{centre.start.drift_rad_per_m + off * step, centre.start.prefix};
    const bool tried = std::ranges::any_of(candidates, [&](const Candidate& c) {
      return std::abs(c.start.drift_rad_per_m - start.drift_rad_per_m) < 0.25 * step;
    });
    if (!tried && step > 0.0) proposals.push_back({start, {}});
  }
  std::vector<std::size_t> order(centre.landmarks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return std::pair(centre.landmarks[k].count, k); });
  for (std::size_t k = 0; k < std::min(kRefits, order.size()); ++k)
    proposals.push_back({centre.start, order[k]});
  return proposals;
}

Blob ToBlob(const std::vector<Candidate>& candidates, const Choice& choice, const Settings& settings) {
  const std::vector<Landmark>& best = candidates[static_cast<std::size_t>(choice.best)].landmarks;
  std::vector<double> start, prefix, drift, likelihood, score;
  std::vector<std::int32_t> landmarks, same, refit_of;
  for (const Candidate& c : candidates) {
    refit_of.push_back(c.refit_of);
    start.push_back(c.start.drift_rad_per_m);
    prefix.push_back(c.start.prefix);
    drift.push_back(c.drift_rad_per_m);
    likelihood.push_back(c.failure ? std::numeric_limits<double>::quiet_NaN() : c.log_likelihood);
    score.push_back(ScoreOf(c, settings));
    landmarks.push_back(static_cast<std::int32_t>(c.landmarks.size()));
    same.push_back(!c.failure && SameMap(best, c.landmarks) ? 1 : 0);
  }
  Blob blob;
  blob.PutVector("start_drift_rad_per_m", start);
  blob.PutVector("start_prefix", prefix);
  blob.PutVector("refit_of", refit_of);
  blob.PutVector("drift_rad_per_m", drift);
  blob.PutVector("log_likelihood", likelihood);
  blob.PutVector("landmarks", landmarks);
  blob.PutVector("score_nats", score);
  blob.PutVector("same_map", same);
  blob.PutScalar<std::int32_t>("best", choice.best);
  if (choice.lead_nats) blob.PutScalar<double>("lead_nats", *choice.lead_nats);
  return blob;
}

std::string Sentence(const std::vector<Candidate>& candidates, const Choice& choice) {
  char text[160];
  if (choice.lead_nats) {
    std::snprintf(text, sizeof text, "candidate %d of %zu is best, %.1f nats ahead of the next different map",
                  choice.best + 1, candidates.size(), *choice.lead_nats);
  } else {
    std::snprintf(text, sizeof text, "candidate %d of %zu is best, all found the same map", choice.best + 1,
                  candidates.size());
  }
  return text;
}

}  // namespace cairn::landmark_map
