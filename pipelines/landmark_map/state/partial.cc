#include "pipelines/landmark_map/state/partial.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "pipelines/common/handed_over.h"

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
    const Association a = Associate(where.layers[seen.type], std::min(seen.type, rules.types), *landmarks_,
                                    rules.grid.cell_m, reach);
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

Blob SummaryOf(const Blob& partial) {
  Blob summary;
  for (const auto& [name, array] : partial.fields()) {
    const bool wanted = name == "first" || name.starts_with("pose/") || name.starts_with("association/") ||
                        name.starts_with("belief/");
    if (!wanted) continue;
    // An array may lie in a mapped file beside the partial's tables, all of which it keeps there.
    summary.Put(name,
                Array::FromBytes(array.type(), array.item_bytes(), array.shape(), array.bytes()).value());
  }
  return summary;
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

RoundSum::RoundSum(LayeredGrid no_counts, std::size_t robots)
    : counts_(std::move(no_counts)),
      log_likelihood_of_(robots, 0.0),
      work_(robots, 0.0),
      increments_(robots),
      first_path_m_(robots, 0.0),
      summaries_(robots),
      guessed_(robots, 0),
      confirmed_(robots, 0) {}

namespace {

constexpr double kMostCount = 1e15;

LayeredGrid CountsIn(const Blob& partial) {
  LayeredGrid counts = LayeredGrid::Load("counts/", partial);
  for (const Layer& layer : counts.layers) RequireAllWithin("counts", layer.values, 0.0, kMostCount);
  return counts;
}

}  // namespace

void RoundSum::Add(const Blob& partial) {
  if (!partial.Has("log_likelihood")) return;
  const LayeredGrid counts = CountsIn(partial);
  RequireSize("the layers of a partial", counts.layers.size(), counts_.layers.size());
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
  if (partial.Has("pose/x_m")) summaries_[robot].push_back(SummaryOf(partial));
  if (partial.Has("confirmed")) {
    ++guessed_[robot];
    confirmed_[robot] += partial.Scalar<std::int32_t>("confirmed");
  }
}

Blob RoundSum::ToBlob() const { return BlobOf(*this); }

RoundSum RoundSum::FromBlob(const Blob& blob, std::size_t robots) {
  RoundSum sum({}, robots);
  TakeFields("", blob, &sum);
  for (const Layer& layer : sum.counts_.layers) RequireAllWithin("counts", layer.values, 0.0, kMostCount);
  for (const std::size_t of : {sum.log_likelihood_of_.size(), sum.work_.size(), sum.increments_.size(),
                               sum.guessed_.size(), sum.confirmed_.size(), sum.first_path_m_.size()})
    if (of != robots) throw InputError("a sum over other robots");
  return sum;
}

std::vector<Blob> RoundSum::SummariesOf(std::size_t robot) const {
  std::vector<Blob> summaries = summaries_[robot];
  std::ranges::sort(summaries, {}, [](const Blob& b) { return b.Scalar<std::int32_t>("first"); });
  return summaries;
}

}  // namespace cairn::landmark_map
