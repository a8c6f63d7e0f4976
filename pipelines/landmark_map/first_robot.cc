#include "pipelines/landmark_map/first_robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "pipelines/common/handed_over.h"
#include "pipelines/landmark_map/search.h"
#include "pipelines/landmark_map/state/schedule.h"
#include "schema/kinds/landmark_map.h"
#include "schema/kinds/log.h"

namespace cairn::landmark_map {
namespace {

constexpr const char* kNow = "first/now";
constexpr const char* kRounds = "first/rounds";
constexpr const char* kCostOfTrial = "first/cost";
constexpr const char* kAlike = "first/alike";
constexpr const char* kTrial = "trial";  // parameter of its tasks

std::string NameOf(std::size_t trial, const char* what) { return fmt::format("first/{}/{}", trial, what); }

// [place]: the robot that stands there.
std::vector<std::size_t> OrderLedBy(std::size_t first, std::size_t robots) {
  std::vector<std::size_t> order{first};
  for (std::size_t r = 0; r < robots; ++r)
    if (r != first) order.push_back(r);
  return order;
}

// [robot]: where it stands.
std::vector<std::size_t> PlacesIn(const std::vector<std::size_t>& order) {
  std::vector<std::size_t> places(order.size());
  for (std::size_t place = 0; place < order.size(); ++place) places[order[place]] = place;
  return places;
}

// The same fields, robot/N/… of robot `to[N]`, and so what names robots by their numbers.
Blob Renumbered(const Blob& blob, const std::vector<std::size_t>& to) {
  Blob renumbered;
  for (const auto& [name, array] : blob.fields())
    if (!name.starts_with("robot/") && !name.starts_with("truth/robot/")) renumbered.Put(name, array);
  for (std::size_t r = 0; r < to.size(); ++r) {
    for (const char* group : {"robot/", "truth/robot/"}) {
      renumbered.PutAll(fmt::format("{}{}/", group, to[r]), blob.Sub(fmt::format("{}{}/", group, r)));
    }
  }
  std::vector<std::string> numbers{"fit/worst_robot", "holes/robot"};
  for (std::size_t r = 0; r < to.size(); ++r)
    numbers.push_back(fmt::format("robot/{}/robot_observations/robot", r));
  for (const std::string& name : numbers) {
    if (!renumbered.Has(name)) continue;
    std::vector<std::int32_t> of;
    for (const std::int32_t robot : renumbered.Get<std::int32_t>(name)) {
      RequireWithin(name, std::int64_t{robot}, 0, std::ssize(to) - 1);
      of.push_back(static_cast<std::int32_t>(to[static_cast<std::size_t>(robot)]));
    }
    renumbered.PutVector(name, of);
  }
  return renumbered;
}

Array NamesInOrder(const Blob& log, const std::vector<std::size_t>& order) {
  const std::vector<std::string> names = log.Texts("robots");
  std::vector<std::string> ordered;
  for (const std::size_t r : order) ordered.push_back(names[r]);
  return Array::Texts(ordered);
}

// Which landmark each row of all robots is of.
std::vector<std::int32_t> AssociationsIn(const Blob& result) {
  std::vector<std::int32_t> all;
  for (const auto& robot : Read<kinds::LandmarkMap>(result).robot) {
    const auto& of = robot.map_landmark.OrNone();
    all.insert(all.end(), of.begin(), of.end());
  }
  return all;
}

bool AreAlike(const Blob& a, const Blob& b, double alike) {
  Candidate one, other;
  one.associations = AssociationsIn(a);
  other.associations = AssociationsIn(b);
  return SameMap(one, other, alike);
}

// As ScoreOf, of the last E-step of all robots.
double ScoreOfAll(const Blob& result, const Settings& settings) {
  const auto history = result.Get<double>("history/log_likelihood");
  return history.back() -
         std::log(settings.places) * static_cast<double>(result.Get<double>("map/landmark_x_m").size());
}

}  // namespace

std::vector<std::size_t> FirstRobots(const Options& options, const Inputs& inputs) {
  constexpr std::size_t kByDefault = 2;
  if (inputs.Has("map") || options.incremental || options.iterations == 0) return {0};
  const Blob& blob = *inputs.Get("log");
  const Settings settings = Resolve(options, blob);
  if (IterationsApart(settings) == 0 || settings.starts < 2) return {0};
  const auto log = Read<kinds::Log>(blob);
  using Rank = std::tuple<std::ptrdiff_t, double, std::size_t>;  // most looks, shortest way, in the log
  std::vector<Rank> ranks;
  for (std::size_t r = 0; r < log.robot.size(); ++r) {
    const RobotSteps steps = MakeSteps(log.robot[r], log.robots[r], settings.steps, nullptr);
    if (!steps.observations.empty())
      ranks.emplace_back(-std::ssize(steps.observations), steps.DistanceTravelled().back(), r);
  }
  std::ranges::sort(ranks);
  // Of more, two that look much need not be better than the log's first (EXPERIMENTS.md).
  const std::size_t by_default = ranks.size() == kByDefault ? kByDefault : 1;
  const std::size_t most =
      options.first_robots > 0 ? static_cast<std::size_t>(options.first_robots) : by_default;
  if (most == 1 || ranks.empty()) return {0};
  std::vector<std::size_t> robots;
  for (std::size_t k = 0; k < std::min(most, ranks.size()); ++k) robots.push_back(std::get<2>(ranks[k]));
  return robots;
}

LedBy::LedBy(std::size_t first, const Inputs& inputs) : inputs_(inputs), log_(inputs.Get("log")) {
  if (first == 0) return;
  const std::vector<std::size_t> order = OrderLedBy(first, log_->Texts("robots").size());
  Blob led = Renumbered(*log_, PlacesIn(order));
  led.Put("robots", NamesInOrder(*log_, order));
  log_ = std::make_shared<const Blob>(std::move(led));
}

Blob InOrderOf(const Blob& log, std::size_t first, const Blob& result) {
  Blob ordered = Renumbered(result, OrderLedBy(first, log.Texts("robots").size()));
  ordered.Put("robots", log.at("robots"));
  ordered.Put("log_hash", Array::Text(log.SourceHash().Hex()));
  return ordered;
}

FirstRobotTrials::FirstRobotTrials(const std::vector<std::size_t>& robots) {
  for (const std::size_t robot : robots) trials_.push_back({.robot = robot, .failure = {}});
}

std::optional<FirstRobotTrials> FirstRobotTrials::Load(const State& state, std::size_t robots) {
  const auto& scalars = state.scalars();
  if (!scalars.contains(kNow)) return std::nullopt;
  FirstRobotTrials trials;
  for (std::size_t k = 0; scalars.contains(NameOf(k, "robot")); ++k) {
    Trial& trial = trials.trials_.emplace_back();
    const std::int64_t robot = scalars.at(NameOf(k, "robot")).i();
    RequireWithin("the first robot", robot, 0, static_cast<std::int64_t>(robots) - 1);
    trial.robot = static_cast<std::size_t>(robot);
    trial.failure = scalars.at(NameOf(k, "failure")).s();
    trial.score_nats = scalars.at(NameOf(k, "score_nats")).d();
    const auto result = state.blobs().find(NameOf(k, "result"));
    if (result != state.blobs().end()) trial.result = result->second;
  }
  const std::int64_t now = scalars.at(kNow).i();
  RequireWithin("the trial of a first robot", now, 0, std::ssize(trials.trials_) - 1);
  trials.now_ = static_cast<std::size_t>(now);
  trials.rounds_ = scalars.at(kRounds).d();
  trials.cost_ = scalars.at(kCostOfTrial).d();
  trials.alike_ = scalars.at(kAlike).d();
  return trials;
}

void FirstRobotTrials::Store(cairn::Step* step) const {
  State& state = *step->plan.mutable_state();
  auto& scalars = *state.mutable_scalars();
  scalars[kNow].set_i(static_cast<std::int64_t>(now_));
  scalars[kRounds].set_d(rounds_);
  scalars[kCostOfTrial].set_d(cost_);
  scalars[kAlike].set_d(alike_);
  for (std::size_t k = 0; k < trials_.size(); ++k) {
    scalars[NameOf(k, "robot")].set_i(static_cast<std::int64_t>(trials_[k].robot));
    scalars[NameOf(k, "failure")].set_s(trials_[k].failure);
    scalars[NameOf(k, "score_nats")].set_d(trials_[k].score_nats);
    if (!trials_[k].result.empty()) (*state.mutable_blobs())[NameOf(k, "result")] = trials_[k].result;
  }
  for (Task& task : *step->plan.mutable_tasks())
    (*task.mutable_params())[kTrial].set_i(static_cast<std::int64_t>(now_));
  // One robot's search may take several times another's.
  constexpr double kLeast = 0.3, kMost = 4.0;
  const auto to_come = static_cast<double>(trials_.size() - now_ - 1);
  ExpectRounds(to_come * rounds_, to_come * cost_, 0.0, &step->plan, kLeast, kMost);
}

void FirstRobotTrials::Expect(const proto::Step& plan) {
  rounds_ = 1.0 + RoundsLater(plan);
  cost_ = CostLater(plan);
  for (const Task& task : plan.tasks()) cost_ += static_cast<double>(task.cost());
}

void FirstRobotTrials::Ended(Blob result, const Settings& settings, cairn::Step* step) {
  Trial& trial = trials_[now_];
  trial.score_nats = ScoreOfAll(result, settings);
  alike_ = settings.alike;
  trial.result = step->Share(std::move(result));
}

void FirstRobotTrials::Failed(const std::string& why, const Blob& log) {
  Trial& trial = trials_[now_];
  trial.failure =
      trial.robot == 0 ? why : fmt::format("robot '{}' first: {}", log.Texts("robots")[trial.robot], why);
}

std::string FirstRobotTrials::Note(const Blob& log, const std::string& of_round) const {
  return fmt::format("robot '{}' first: {}", log.Texts("robots")[trials_[now_].robot], of_round);
}

bool FirstRobotTrials::Next() { return ++now_ < trials_.size(); }

Blob FirstRobotTrials::Best(const Blob& log, const Inputs& inputs, const cairn::Step& step) const {
  const auto result_of = [&](std::size_t k) {
    for (const BlobPtr& blob : step.blobs)
      if (blob->ContentHash().Binary() == trials_[k].result) return blob;
    return inputs.Get(NameOf(k, "result"));
  };
  const Trial* best = nullptr;
  for (const Trial& trial : trials_)
    if (trial.failure.empty() && (best == nullptr || trial.score_nats > best->score_nats)) best = &trial;
  if (best == nullptr) throw InputError(std::ranges::min(trials_, {}, &Trial::robot).failure);
  Blob kept = *result_of(static_cast<std::size_t>(best - trials_.data()));
  const auto search = FieldsIn<kinds::LandmarkMap::Search>("search/", kept);
  std::vector<std::int32_t> robots, same_map;
  std::vector<double> scores;
  double lead_nats = search.lead_nats.Or(std::numeric_limits<double>::infinity());
  std::string ahead = "the others gave the same map";
  for (std::size_t k = 0; k < trials_.size(); ++k) {
    const Trial& trial = trials_[k];
    robots.push_back(static_cast<std::int32_t>(trial.robot));
    scores.push_back(trial.failure.empty() ? trial.score_nats : std::numeric_limits<double>::quiet_NaN());
    same_map.push_back(trial.failure.empty() && AreAlike(kept, *result_of(k), alike_) ? 1 : 0);
    if (same_map.back() != 0 || !trial.failure.empty()) continue;
    ahead = "its map is the likeliest";
    lead_nats = std::min(lead_nats, best->score_nats - trial.score_nats);
  }
  kept.PutScalar<std::int32_t>("search/first_robot", static_cast<std::int32_t>(best->robot));
  kept.PutVector("search/tried_robot", robots);
  kept.PutVector("search/tried_score_nats", scores);
  kept.PutVector("search/tried_same_map", same_map);
  if (std::isfinite(lead_nats)) kept.PutScalar<double>("search/lead_nats", lead_nats);
  kept.Put("search/why", Array::Text(fmt::format("{}; {} robots were tried as the first, those that looked "
                                                 "from most places: '{}' is it, {}",
                                                 kept.Text("search/why"), trials_.size(),
                                                 log.Texts("robots")[best->robot], ahead)));
  return kept;
}

bool IsOfTrial(const Task& task) { return task.params().contains(kTrial); }

}  // namespace cairn::landmark_map
