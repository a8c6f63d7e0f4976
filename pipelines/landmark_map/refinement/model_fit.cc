#include "pipelines/landmark_map/refinement/model_fit.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "schema/kinds/landmark_map.h"

namespace cairn::landmark_map {
namespace {

std::vector<ModelFit::Width> WidthsOf(const LeastSquaresProblem& nominal,
                                      const LeastSquaresProblem& problem) {
  const bool contacts = std::ranges::any_of(problem.sightings, &Sighting::contact);
  const bool at_a_distance = !std::ranges::all_of(problem.sightings, &Sighting::contact);
  std::vector<ModelFit::Width> widths;
  if (at_a_distance) {
    widths.push_back({"range", nominal.noise.range_m, problem.noise.range_m});
    widths.push_back({"bearing", nominal.noise.bearing_rad, problem.noise.bearing_rad});
  }
  if (contacts) widths.push_back({"contact", nominal.noise.contact_m, problem.noise.contact_m});
  return widths;
}

// Of a robot's observations, in the order of time: where it saw a landmark first and last.
struct Seen {
  std::size_t first = 0, last = 0;
};

using SeenLandmarks = std::map<int, Seen>;

struct RobotSeen {
  std::vector<double> time_s;  // of its observations
  SeenLandmarks landmarks;
};

std::vector<RobotSeen> SeenOf(const LeastSquaresProblem& problem) {
  std::vector<RobotSeen> robots(problem.robots.size());
  for (const Sighting& sighting : problem.sightings) {
    const auto r = static_cast<std::size_t>(sighting.robot);
    const std::size_t i = robots[r].time_s.size();
    robots[r].time_s.push_back(problem.robots[r].time_s[static_cast<std::size_t>(sighting.node)]);
    robots[r].landmarks.try_emplace(sighting.landmark, i, i).first->second.last = i;
  }
  return robots;
}

std::size_t SeenOnBothSides(const SeenLandmarks& landmarks, std::size_t at) {
  return static_cast<std::size_t>(std::ranges::count_if(
      landmarks, [at](const auto& entry) { return entry.second.first <= at && entry.second.last > at; }));
}

// What another robot saw of both sides ties them, too: as many landmarks as of the side of which it saw
// fewer. Whether its own path holds there, its own times tell.
std::size_t TiedByOther(const SeenLandmarks& landmarks, std::size_t at, const SeenLandmarks& others) {
  std::size_t before = 0, after = 0;
  for (const auto& [landmark, seen] : landmarks) {
    if (!others.contains(landmark)) continue;
    before += seen.first <= at;
    after += seen.last > at;
  }
  return std::min(before, after);
}

void FindFewestCommon(const LeastSquaresProblem& problem, ModelFit* fit) {
  constexpr std::size_t kEnds = 10;  // a tenth
  const std::vector<RobotSeen> robots = SeenOf(problem);
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const auto& [time_s, landmarks] = robots[r];
    const std::size_t end = time_s.size() / kEnds;
    std::set<std::size_t> changes = {
        end};  // but from the beginning on the count is another one behind these alone
    for (const auto& [landmark, seen] : landmarks) changes.insert({seen.first, seen.last});
    for (const std::size_t at : changes) {
      if (at < end || at + 1 + end >= time_s.size()) continue;
      std::size_t common = SeenOnBothSides(landmarks, at);
      for (std::size_t other = 0; other < robots.size(); ++other)
        if (other != r) common = std::max(common, TiedByOther(landmarks, at, robots[other].landmarks));
      if (fit->fewest_common >= 0 && static_cast<std::int64_t>(common) >= fit->fewest_common) continue;
      fit->fewest_common = static_cast<std::int64_t>(common);
      fit->fewest_common_s = time_s[at];
    }
  }
}

void CountByLandmark(const LeastSquaresProblem& problem, const std::vector<double>& sigmas, ModelFit* fit) {
  struct Count {
    std::int64_t misfits = 0, observations = 0;
  };
  std::vector<Count> counts(static_cast<std::size_t>(problem.landmarks));
  for (std::size_t i = 0; i < sigmas.size(); ++i) {
    Count& count = counts[static_cast<std::size_t>(problem.sightings[i].landmark)];
    ++count.observations;
    count.misfits += sigmas[i] >= kMisfitSigmas;
  }
  const auto most = std::ranges::max_element(counts, {}, &Count::misfits);
  if (most == counts.end() || most->misfits == 0) return;
  fit->misfit_landmark = static_cast<std::int32_t>(most - counts.begin());
  fit->landmark_misfits = most->misfits;
  fit->landmark_observations = most->observations;
}

}  // namespace

ModelFit FitOf(const LeastSquaresProblem& nominal, const LeastSquaresProblem& problem,
               const LeastSquaresPoint& point) {
  constexpr std::size_t kWorst = 10;
  ModelFit fit;
  fit.widths = WidthsOf(nominal, problem);
  fit.repeats = problem.repeats;
  fit.tail_sigmas = problem.tail_sigmas;
  const std::vector<double> sigmas = SightingSigmas(problem, point);
  fit.off_m = SightingErrors_m(problem, point);
  std::int64_t run = 0;
  double run_from_s = 0;
  for (std::size_t i = 0; i < sigmas.size(); ++i) {
    const Sighting& seen = problem.sightings[i];
    const double time_s =
        problem.robots[static_cast<std::size_t>(seen.robot)].time_s[static_cast<std::size_t>(seen.node)];
    ++fit.observations;
    const bool goes_on = i > 0 && problem.sightings[i - 1].robot == seen.robot;
    if (!goes_on) run = 0;
    if (!(sigmas[i] >= kMisfitSigmas)) {
      run = 0;
      continue;
    }
    ++fit.misfits;
    if (run++ == 0) run_from_s = time_s;
    if (run > fit.longest_run) {
      fit.longest_run = run;
      fit.longest_run_from_s = run_from_s;
    }
    fit.worst.push_back({seen.robot, time_s, sigmas[i]});
  }
  CountByLandmark(problem, sigmas, &fit);
  double furthest = 0;
  const std::vector<std::vector<double>> edges = EdgeSigmas(problem, point);
  for (std::size_t r = 0; r < edges.size(); ++r) {
    for (std::size_t k = 0; k < edges[r].size(); ++k) {
      const bool broken = problem.robots[r].IsBroken(k);
      if (edges[r][k] < kJumpSigmas && !broken) continue;
      ++fit.odometry_misfits;
      const double far = broken ? std::numeric_limits<double>::max() : edges[r][k];
      if (far > furthest) {
        furthest = far;
        fit.worst_odometry_s = problem.robots[r].time_s[k + 1];
      }
    }
  }
  FindFewestCommon(problem, &fit);
  fit.sides = FindOneSided(problem, point);
  std::ranges::stable_sort(fit.worst, std::greater(), &ModelFit::Misfit::sigmas);
  fit.worst.resize(std::min(fit.worst.size(), kWorst));
  return fit;
}

Blob ModelFit::ToBlob(const std::vector<Landmark>& landmarks, int types) const {
  kinds::LandmarkMap::Fit fit;
  fit.kind = cairn::ColumnOf(widths, &Width::kind);
  fit.stated = cairn::ColumnOf(widths, &Width::stated);
  fit.found = cairn::ColumnOf(widths, &Width::found);
  fit.repeats_along = repeats.along;
  fit.repeats_across = repeats.across;
  fit.tail_sigmas = tail_sigmas;
  fit.observations = observations;
  fit.misfits = misfits;
  fit.longest_run = longest_run;
  fit.longest_run_from_s = longest_run_from_s;
  fit.odometry_misfits = odometry_misfits;
  fit.worst_odometry_s = worst_odometry_s;
  if (break_lead_nats) fit.odometry_break_lead_nats = *break_lead_nats;
  if (fewest_common >= 0) {
    fit.fewest_common = fewest_common;
    fit.fewest_common_s = fewest_common_s;
  }
  if (sides.one_sided > 0) {
    fit.one_sided = sides.one_sided;
    fit.two_sided = sides.two_sided;
    fit.one_sided_s = sides.at_s;
  }
  if (sides.most > 0) {
    fit.most_one_sided = sides.most;
    fit.most_one_sided_s = sides.most_at_s;
  }
  fit.worst_robot = cairn::ColumnOf(worst, &Misfit::robot);
  fit.worst_time_s = cairn::ColumnOf(worst, &Misfit::time_s);
  fit.worst_sigmas = cairn::ColumnOf(worst, &Misfit::sigmas);
  if (misfit_landmark >= 0) {
    const int type = landmarks[static_cast<std::size_t>(misfit_landmark)].type;
    fit.misfit_landmark = type < types ? type : -1;
    fit.landmark_misfits = landmark_misfits;
    fit.landmark_observations = landmark_observations;
  }
  return BlobOf(fit);
}

}  // namespace cairn::landmark_map
