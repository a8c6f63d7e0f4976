#include "pipelines/landmark_map/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "schema/kinds/few_in_common.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::landmark_map {
namespace {

// How many observations are of the landmark of `to` that most observations of their landmark of `from` are
// of.
std::size_t InAgreement(const std::vector<std::int32_t>& from, const std::vector<std::int32_t>& to) {
  std::map<std::int32_t, std::map<std::int32_t, std::size_t>> shared;
  for (std::size_t k = 0; k < from.size(); ++k) ++shared[from[k]][to[k]];
  std::size_t agree = 0;
  for (const auto& [landmark, counts] : shared) {
    std::size_t most = 0;
    for (const auto& [other, count] : counts) most = std::max(most, count);
    agree += most;
  }
  return agree;
}

// Degrees of freedom of the drift's prior, Student's t: a data sheet's figure may be off by a factor, and the
// tails say so. A Gaussian takes 50 nats off a drift of ten standard deviations, this 8.
constexpr double kTail = 4.0;
constexpr double kFurthest = 8.0;                         // nominal standard deviations
constexpr double kMostTurn_rad = std::numbers::pi / 4.0;  // by a drift, from one observation to the next
constexpr double kShorter = 0.4;                          // the second half's prefix, of the first half's

}  // namespace

std::vector<StartingPoint> StartingPoints(const Settings& settings) {
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
  return candidate.log_likelihood - 0.5 * (kTail + 1.0) * std::log1p(drift * drift / kTail) -
         std::log(settings.places) * static_cast<double>(candidate.landmarks.size());
}

bool SameMap(const Candidate& a, const Candidate& b, double alike) {
  CAIRN_DEMAND(a.associations.size() == b.associations.size(), "maps of the same observations");
  const double least = alike * static_cast<double>(a.associations.size());
  return static_cast<double>(InAgreement(a.associations, b.associations)) >= least &&
         static_cast<double>(InAgreement(b.associations, a.associations)) >= least;
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
    if (candidates[k].refit_of < 0) ++choice.starts;
    if (candidates[k].failure) continue;
    if (SameMap(best, candidates[k], settings.alike)) {
      if (candidates[k].refit_of < 0) ++choice.support;
      continue;
    }
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

std::vector<Proposal> ProposalsBeyond(const std::vector<Candidate>& candidates, const Settings& settings,
                                      double increment_m) {
  const double step = DriftStep(settings.starts) * settings.noise.heading_drift_rad_per_m;
  std::vector<Proposal> proposals;
  if (!(step > 0.0)) return proposals;
  double tried = 0.0;
  for (const Candidate& c : candidates) tried = std::max(tried, std::abs(c.start.drift_rad_per_m));
  const double furthest = kFurthest * settings.noise.heading_drift_rad_per_m;
  const double last = std::min(std::min(2.0 * tried, furthest) + 0.5 * step, kMostTurn_rad / increment_m);
  for (double drift = tried + step; drift < last; drift += step) {
    for (const double prefix : {1.0, kShorter}) {
      for (const double side : {-1.0, 1.0})
        proposals.push_back({{side * drift, settings.growth_start * prefix}, {}});
    }
  }
  return proposals;
}

std::vector<Proposal> ProposalsAtOnce(const std::vector<Candidate>& candidates, const Settings& settings) {
  constexpr double kLittle = 0.1;  // of the data
  constexpr int kEachWay = 4;
  const double step = DriftStep(settings.starts) * settings.noise.heading_drift_rad_per_m;
  const bool tried =
      std::ranges::any_of(candidates, [](const Candidate& c) { return c.start.prefix == 1.0; });
  std::vector<Proposal> proposals;
  if (!(step > 0.0) || settings.growth_start >= kLittle || tried) return proposals;
  for (int k = -kEachWay; k <= kEachWay; ++k) proposals.push_back({{step * k / kEachWay, 1.0}, {}});
  return proposals;
}

bool LooksOpen(const Candidate& candidate) { return FindFewestInCommon({candidate.associations}).AreFew(); }

Blob ToBlob(const std::vector<Candidate>& candidates, const Choice& choice, const Settings& settings) {
  const Candidate& best = candidates[static_cast<std::size_t>(choice.best)];
  const auto column = [&](const auto& of) { return ColumnOf(candidates, of); };
  kinds::LandmarkMap::Search search;
  search.start_drift_rad_per_m = column([](const Candidate& c) { return c.start.drift_rad_per_m; });
  search.start_prefix = column([](const Candidate& c) { return c.start.prefix; });
  search.refit_of = column(&Candidate::refit_of);
  search.drift_rad_per_m = column(&Candidate::drift_rad_per_m);
  search.log_likelihood = column([](const Candidate& c) {
    return c.failure ? std::numeric_limits<double>::quiet_NaN() : c.log_likelihood;
  });
  search.landmarks = column([](const Candidate& c) { return static_cast<std::int32_t>(c.landmarks.size()); });
  search.score_nats = column([&](const Candidate& c) { return ScoreOf(c, settings); });
  search.same_map =
      column([&](const Candidate& c) { return !c.failure && SameMap(best, c, settings.alike) ? 1 : 0; });
  search.best = choice.best;
  search.support = choice.support;
  search.starts = choice.starts;
  if (choice.lead_nats) search.lead_nats = *choice.lead_nats;
  return BlobOf(search);
}

Blob OneStartOnly() {
  kinds::LandmarkMap::Search search;
  search.support = search.starts = 1;
  return BlobOf(search);
}

std::string Sentence(const std::vector<Candidate>& candidates, const Choice& choice) {
  const std::string ahead =
      choice.lead_nats ? fmt::format("{:.1f} nats ahead of the next different map", *choice.lead_nats)
                       : "all found the same map";
  return fmt::format("candidate {} of {} is best, {}; found from {} of {} starts", choice.best + 1,
                     candidates.size(), ahead, choice.support, choice.starts);
}

}  // namespace cairn::landmark_map
