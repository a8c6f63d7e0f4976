#include "pipelines/landmark_map/search.h"

#include <cmath>
#include <cstdio>
#include <limits>

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

std::vector<double> StartDrifts(const Settings& settings) {
  constexpr double kReach = 2.0;  // standard deviations
  const double widest = kReach * settings.noise.heading_drift_rad_per_m;
  if (settings.starts < 2 || !(widest > 0.0)) return {0.0};
  std::vector<double> drifts;
  for (int k = 0; k < settings.starts; ++k)
    drifts.push_back(widest * (2.0 * k / (settings.starts - 1) - 1.0));
  return drifts;
}

double ScoreOf(const Candidate& candidate, const Settings& settings) {
  if (candidate.failure) return -std::numeric_limits<double>::infinity();
  const double drift = candidate.drift_rad_per_m / settings.noise.heading_drift_rad_per_m;
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

Blob ToBlob(const std::vector<Candidate>& candidates, const Choice& choice, const Settings& settings) {
  const std::vector<Landmark>& best = candidates[static_cast<std::size_t>(choice.best)].landmarks;
  std::vector<double> start, drift, likelihood, score;
  std::vector<std::int32_t> landmarks, same;
  for (const Candidate& c : candidates) {
    start.push_back(c.start_drift_rad_per_m);
    drift.push_back(c.drift_rad_per_m);
    likelihood.push_back(c.failure ? std::numeric_limits<double>::quiet_NaN() : c.log_likelihood);
    score.push_back(ScoreOf(c, settings));
    landmarks.push_back(static_cast<std::int32_t>(c.landmarks.size()));
    same.push_back(!c.failure && SameMap(best, c.landmarks) ? 1 : 0);
  }
  Blob blob;
  blob.PutVector("start_drift_rad_per_m", start);
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
    std::snprintf(text, sizeof text, "start %d of %zu is best, %.1f nats ahead of the next different map",
                  choice.best + 1, candidates.size(), *choice.lead_nats);
  } else {
    std::snprintf(text, sizeof text, "start %d of %zu is best, all found the same map", choice.best + 1,
                  candidates.size());
  }
  return text;
}

}  // namespace cairn::landmark_map
