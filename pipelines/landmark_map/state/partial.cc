#include "pipelines/landmark_map/state/partial.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string>

#include "pipelines/common/handed_over.h"
#include "pipelines/landmark_map/model/work.h"

namespace cairn::landmark_map {

PartialBuilder::PartialBuilder(const Settings& settings, const Slice& slice, int robot,
                               const std::vector<Landmark>* landmarks, LayeredGrid no_counts)
    : settings_(settings),
      slice_(slice),
      robot_(robot),
      landmarks_(landmarks),
      counts_(std::move(no_counts)) {
  if (landmarks_ == nullptr) return;
  const RobotSteps& steps = slice.steps;
  const auto seen =
      static_cast<std::size_t>(steps.first_observation[slice.end] - steps.first_observation[slice.first]);
  poses_.resize(static_cast<std::size_t>(slice.end - slice.first));
  association_.assign(seen, -1);
  association_probability_.assign(seen, 0.0);
}

void PartialBuilder::KeepBeliefs() { beliefs_.layers.resize(poses_.size()); }

void PartialBuilder::Add(int step, const LayeredGrid& belief) {
  const RobotSteps& steps = slice_.steps;
  for (int k = steps.first_observation[step]; k < steps.first_observation[step + 1]; ++k) {
    Count(steps.observations[k], settings_.map.grid, belief, &counts_);
  }
  increments_.AddHeading(HeadingOf(belief), step + 1 < slice_.end ? slice_.steps.path_m[step + 1] : 0.0);
  constexpr int kMostPoints = 2000;  // of a robot's path
  if (step % (1 + steps.size() / kMostPoints) == 0) {
    const Point mean = MeanPosition(belief, settings_.map.grid);
    path_.push_back({robot_, steps.time_s[static_cast<std::size_t>(step)], mean.x_m, mean.y_m});
  }
  if (keeps_start_ && step == 0) start_ = SupportOf(belief, robot_);
  if (landmarks_ == nullptr) return;
  const auto at = static_cast<std::size_t>(step - slice_.first);
  poses_[at] = Summarise(belief, settings_.map.grid);
  if (!beliefs_.layers.empty()) beliefs_.layers[at] = SumOverLayers(belief);
  AddAssociations(step, belief);
}

// How far from its landmark an observation may lie.
double PartialBuilder::ReachOf(int type) const {
  const MapRules& rules = settings_.map;
  constexpr double kAnywhere = 1e9;  // names do not lie, unless the log says so
  if (type >= rules.types) return std::max(1.5 * rules.core_m, 4.0 * rules.observation_m);
  return settings_.detection.false_ratio > 0.0 ? std::max(2.0 * rules.core_m, 5.0 * rules.observation_m)
                                               : kAnywhere;
}

void PartialBuilder::AddAssociations(int step, const LayeredGrid& belief) {
  const RobotSteps& steps = slice_.steps;
  const MapRules& rules = settings_.map;
  for (int k = steps.first_observation[step]; k < steps.first_observation[step + 1]; ++k) {
    const Observation& seen = steps.observations[k];
    LayeredGrid where;
    where.layers.resize(static_cast<std::size_t>(seen.type) + 1);
    Count(seen, rules.grid, belief, &where);
    const double reach = ReachOf(seen.type);
    const bool of_any = rules.partly_named && seen.type >= rules.types;
    const Association a =
        Associate(where.layers[seen.type], of_any ? kOfAnyType : std::min(seen.type, rules.types),
                  *landmarks_, rules.grid.cell_m, reach);
    const auto at = static_cast<std::size_t>(k - steps.first_observation[slice_.first]);
    association_[at] = a.landmark;
    association_probability_[at] = a.probability;
  }
}

double PartialBuilder::HeadingOf(const LayeredGrid& belief) const {
  const double angle = 2.0 * std::numbers::pi / settings_.map.grid.headings;
  double cosine = 0, sine = 0;
  for (std::size_t c = 0; c < belief.layers.size(); ++c) {
    const double mass = belief.layers[c].Sum();
    cosine += mass * std::cos(c * angle);
    sine += mass * std::sin(c * angle);
  }
  return std::atan2(sine, cosine);
}

void PartialBuilder::AddIncrement(int step, const HalfTurn& posterior) {
  increments_.AddIncrement(slice_.steps.IncrementTo(step), posterior, settings_.noise);
}

Blob PartialBuilder::Finish(const Alphas& alphas) const {
  Blob partial;
  counts_.Store("counts/", &partial);
  partial.PutScalar<double>("log_likelihood", alphas.log_likelihood);
  partial.PutScalar<double>("work", alphas.work);
  PutFields("increments/", increments_, &partial);
  PutRows("path/", path_, &partial);
  if (!start_.empty()) PutRows("start/", start_, &partial);
  partial.PutScalar<double>("first_path_m", slice_.steps.path_m[slice_.first]);
  partial.PutScalar<std::int32_t>("robot", robot_);
  partial.PutScalar<std::int32_t>("first", slice_.first);
  if (landmarks_ == nullptr) return partial;
  PutRows("pose/", poses_, &partial);
  partial.PutVector("association/landmark", association_);
  partial.PutVector("association/probability", association_probability_);
  if (!beliefs_.layers.empty()) beliefs_.StoreSparse("belief/", &partial);
  return partial;
}

Blob CopyOf(const Blob& blob) {
  Blob copy;
  for (const auto& [name, array] : blob.fields())
    copy.Put(name, Array::FromBytes(array.type(), array.item_bytes(), array.shape(), array.bytes()).value());
  return copy;
}

// An array may lie in a mapped file beside the partial's tables, all of which it keeps there.
Blob SummaryOf(const Blob& partial) {
  Blob summary;
  for (const auto& [name, array] : partial.fields()) {
    const bool wanted = name == "first" || name.starts_with("pose/") || name.starts_with("association/") ||
                        name.starts_with("belief/");
    if (wanted) summary.Put(name, array);
  }
  return CopyOf(summary);
}

namespace {

void CheckPoses(const std::vector<PoseSummary>& poses) {
  for (const PoseSummary& pose : poses) {
    RequirePoses("a mean pose", std::array{Pose{pose.x_m, pose.y_m, pose.heading_rad}});
    RequirePoses("a likely pose", std::array{Pose{pose.mode_x_m, pose.mode_y_m, pose.mode_heading_rad}});
    RequireAllWithin("the covariance of a pose", pose.covariance, -kFar_m * kFar_m, kFar_m * kFar_m);
  }
}

}  // namespace

void CheckSummaries(const std::vector<Blob>& summaries, const RobotSteps& steps, std::size_t landmarks) {
  std::int64_t step = 0;
  for (const Blob& summary : summaries) {
    RequireWithin("the first step of a slice", std::int64_t{summary.Scalar<std::int32_t>("first")}, step,
                  step);
    const auto poses = RowsIn<PoseSummary>(summary, "pose/");
    CheckPoses(poses);
    RequireWithin("the steps of a slice", std::ssize(poses), 0, steps.size() - step);
    const auto begin = static_cast<std::size_t>(step), end = begin + poses.size();
    const auto seen = static_cast<std::size_t>(steps.first_observation[end] - steps.first_observation[begin]);
    const auto landmark = summary.Get<std::int32_t>("association/landmark");
    const auto probability = summary.Get<double>("association/probability");
    RequireSize("association/landmark", landmark.size(), seen);
    RequireSize("association/probability", probability.size(), seen);
    RequireAllWithin("the landmark of an observation", landmark, std::int64_t{-1},
                     static_cast<std::int64_t>(landmarks) - 1);
    RequireAllWithin("the probability of a landmark", probability, 0.0, 1.0 + 1e-6);
    step = static_cast<std::int64_t>(end);
  }
  RequireSize("the poses of a robot", static_cast<std::size_t>(step), steps.time_s.size());
  RequireSize("the observations of a robot",
              static_cast<std::size_t>(steps.first_observation.back() - steps.first_observation.front()),
              steps.observations.size());
}

std::vector<double> Joined(const std::vector<Blob>& summaries, const char* name) {
  std::vector<double> all;
  for (const Blob& summary : summaries) {
    const auto values = summary.Get<double>(name);
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

Associated AssociatedIn(const std::vector<Blob>& summaries) {
  Associated all{{}, Joined(summaries, "association/probability")};
  for (const Blob& summary : summaries) {
    const auto values = summary.Get<std::int32_t>("association/landmark");
    all.landmark.insert(all.landmark.end(), values.begin(), values.end());
  }
  return all;
}

RoundSum::RoundSum(const Settings& settings, std::size_t robots)
    : rules_(settings.map),
      memory_mb_(settings.memory_mb),
      counts_(NoCounts(settings.map)),
      log_likelihood_of_(robots, 0.0),
      work_(robots, 0.0),
      increments_(robots),
      first_path_m_(robots, 0.0),
      summaries_(robots),
      guessed_(robots, 0),
      confirmed_(robots, 0) {}

void CheckCounts(const LayeredGrid& counts, const MapRules& rules) {
  constexpr double kMostCount = 1e15;
  RequireSize("the layers of counts", counts.layers.size(), static_cast<std::size_t>(rules.layers()));
  for (const Layer& layer : counts.layers) RequireAllWithin("counts", layer.values, 0.0, kMostCount);
}

void RoundSum::Add(const Blob& partial) {
  if (!partial.Has("log_likelihood")) return;
  const LayeredGrid counts = LayeredGrid::Load("counts/", partial);
  CheckCounts(counts, rules_);
  double cells = 0.0;
  for (std::size_t type = 0; type < counts.layers.size(); ++type)
    cells += static_cast<double>(Union(counts_.layers[type].box, counts.layers[type].box).cells());
  RequireMemory("the counts of a round", sizeof(double) * cells, memory_mb_);
  for (std::size_t type = 0; type < counts.layers.size(); ++type) {
    counts_.layers[type].Cover(counts.layers[type].box);
    counts_.layers[type].AddShifted(counts.layers[type], 0, 0, 1.0);
  }
  log_likelihood_ += partial.Scalar<double>("log_likelihood");
  const std::int64_t of = partial.Scalar<std::int32_t>("robot");
  RequireWithin("a partial's robot", of, 0, static_cast<std::int64_t>(work_.size()) - 1);
  const auto robot = static_cast<std::size_t>(of);
  log_likelihood_of_[robot] += partial.Scalar<double>("log_likelihood");
  work_[robot] += partial.Scalar<double>("work");
  increments_[robot].Join(FieldsIn<IncrementSums>("increments/", partial), first_path_m_[robot]);
  first_path_m_[robot] = partial.Scalar<double>("first_path_m");
  if (partial.Has("path/robot")) AppendRows("path/", partial, &path_);
  if (partial.Has("start/robot")) AppendRows("start/", partial, &start_);
  if (partial.Has("pose/x_m")) summaries_[robot].push_back(SummaryOf(partial));
  if (partial.Has("confirmed")) {
    ++guessed_[robot];
    confirmed_[robot] += partial.Scalar<std::int32_t>("confirmed");
  }
  Check();
}

Blob RoundSum::ToBlob() const { return BlobOf(*this); }

RoundSum RoundSum::FromBlob(const Settings& settings, const Blob& blob, std::size_t robots) {
  RoundSum sum(settings, robots);
  TakeFields("", blob, &sum);
  CheckCounts(sum.counts_, settings.map);
  for (const std::size_t of : {sum.log_likelihood_of_.size(), sum.work_.size(), sum.increments_.size(),
                               sum.guessed_.size(), sum.confirmed_.size(), sum.first_path_m_.size()})
    if (of != robots) throw InputError("a sum over other robots");
  sum.Check();
  return sum;
}

void RoundSum::Check() const {
  constexpr double kMostNats = 1e15;
  RequireWithin("log_likelihood", log_likelihood_, -kMostNats, kMostNats);
  RequireAllWithin("log_likelihood", log_likelihood_of_, -kMostNats, kMostNats);
  RequireAllWithin("work", work_, 0.0, kMostWork);
  RequireAllWithin("first_path_m", first_path_m_, 0.0, kFar_m);
  RequireAllWithin("slices that were guessed", guessed_, std::int64_t{0}, std::int64_t{1} << 40);
  CheckStart(start_, std::ssize(work_), rules_.grid.headings);
  for (const PathPoint& at : path_) {
    RequireWithin("the robot of a path", std::int64_t{at.robot}, 0, std::ssize(work_) - 1);
    RequirePoses("a path", std::array{Pose{at.x_m, at.y_m, 0.0}});
    RequireWithin("a path's time", at.time_s, -kMostNats, kMostNats);
  }
  for (std::size_t r = 0; r < guessed_.size(); ++r)
    RequireWithin("slices that were guessed right", confirmed_[r], 0, guessed_[r]);
}

std::vector<StartBox> RoundSum::StartOf(std::size_t robot) const {
  std::vector<StartBox> of;
  std::ranges::copy_if(start_, std::back_inserter(of),
                       [&](const StartBox& at) { return at.robot == static_cast<std::int32_t>(robot); });
  return of;
}

std::vector<Blob> RoundSum::SummariesOf(std::size_t robot) const {
  std::vector<Blob> summaries = summaries_[robot];
  std::ranges::sort(summaries, {}, [](const Blob& b) { return b.Scalar<std::int32_t>("first"); });
  return summaries;
}

}  // namespace cairn::landmark_map
