#include "pipelines/landmark_learning/held_out_check.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "pipelines/landmark_learning/agreement.h"
#include "pipelines/landmark_learning/state/sum_path.h"

namespace cairn::landmark_learning {
namespace {

constexpr std::size_t kMostSamples = 500, kNearest = 5;

// Of one held-out sample, among the training samples.
struct Neighbours {
  std::vector<std::size_t> nearest;  // those that face alike first, where headings are known
  bool in_reach = false;
};

class HeldOutCheck {
 public:
  HeldOutCheck(const Options& options, const TrainingData& data, const Parameters<float>& networks)
      : belief_(BeliefOf(options)), held_out_(data.held_out), training_(data.training), networks_(networks) {
    in_order_.resize(held_out_.weight.size());
    std::iota(in_order_.begin(), in_order_.end(), std::size_t{0});
    std::ranges::stable_sort(in_order_, {}, [&](std::size_t k) { return held_out_.positions.along_m[k]; });
  }

  kinds::Networks::HeldOut Check() {
    const std::size_t all = in_order_.size(), picked = std::min(all, kMostSamples);
    std::vector<double> sensed, expected;
    std::size_t in_reach = 0, same = 0;
    for (std::size_t i = 0; i < picked; ++i) {
      const std::size_t at = i * all / picked;
      const Neighbours neighbours = NeighboursOf(in_order_[at]);
      same += IsCopy(at, neighbours.nearest) ? 1 : 0;
      if (!neighbours.in_reach) continue;
      ++in_reach;
      Append(OutputsOf(held_out_, {in_order_[at]}), &sensed);
      Append(OutputsOf(training_, neighbours.nearest), &expected);
    }
    kinds::Networks::HeldOut check;
    const auto of_all = [&](std::size_t count) {
      return static_cast<double>(count) / static_cast<double>(picked);
    };
    check.samples = static_cast<std::int64_t>(all);
    check.in_reach = std::llround(of_all(in_reach) * static_cast<double>(all));
    check.same_share = of_all(same);
    check.agreement_sigmas =
        AgreementSigmas(sensed, expected, static_cast<std::size_t>(networks_.shape.networks));
    return check;
  }

 private:
  bool FacesWithin(std::size_t held_out, std::size_t training, double least_cosine) const {
    const Positions &of = held_out_.positions, &to = training_.positions;
    if (of.cos_heading.empty() || to.cos_heading.empty()) return true;
    return of.cos_heading[held_out] * to.cos_heading[training] +
               of.sin_heading[held_out] * to.sin_heading[training] >=
           least_cosine;
  }

  Neighbours NeighboursOf(std::size_t held_out) const {
    using Away = std::pair<std::pair<bool, double>, std::size_t>;  // faces another way, how far off, which
    Neighbours neighbours;
    std::vector<Away> nearest;
    const double least_cosine = belief_.LooksAtHeadings() ? std::cos(belief_.heading_rad) : -2.0;
    for (std::size_t k = 0; k < training_.weight.size(); ++k) {
      const double away_m = std::hypot(training_.positions.x_m[k] - held_out_.positions.x_m[held_out],
                                       training_.positions.y_m[k] - held_out_.positions.y_m[held_out]);
      if (away_m <= belief_.ReachM() && FacesWithin(held_out, k, least_cosine)) neighbours.in_reach = true;
      const Away away{{!FacesWithin(held_out, k, 0.0), away_m}, k};
      if (nearest.size() == kNearest && !(away < nearest.back())) continue;
      nearest.insert(std::ranges::upper_bound(nearest, away), away);
      if (nearest.size() > kNearest) nearest.pop_back();
    }
    for (const Away& away : nearest) neighbours.nearest.push_back(away.second);
    return neighbours;
  }

  // A hundred times as alike to a sample near it as to those before and after it, and to no other of its own
  // run: of inputs of few values many are the same by chance.
  bool IsCopy(std::size_t at, const std::vector<std::size_t>& nearest) const {
    constexpr double kAsAlike = 0.01;
    double to_own = std::numeric_limits<double>::infinity();
    if (at > 0) to_own = Difference(in_order_[at], held_out_, in_order_[at - 1]);
    if (at + 1 < in_order_.size())
      to_own = std::min(to_own, Difference(in_order_[at], held_out_, in_order_[at + 1]));
    const auto is_as_alike = [&](const SampleSet& set) {
      return [&, this](std::size_t k) { return Difference(in_order_[at], set, k) <= kAsAlike * to_own; };
    };
    return to_own > 0.0 && std::ranges::any_of(nearest, is_as_alike(training_)) &&
           std::ranges::count_if(in_order_, is_as_alike(held_out_)) == 1;  // itself
  }

  // Of the inputs of a held-out sample and another one.
  double Difference(std::size_t held_out, const SampleSet& set, std::size_t other) const {
    const auto inputs = static_cast<std::size_t>(networks_.shape.inputs);
    double squares = 0.0;
    for (std::size_t i = 0; i < inputs; ++i) {
      const double d = held_out_.inputs()[held_out * inputs + i] - set.inputs()[other * inputs + i];
      squares += d * d;
    }
    return std::sqrt(squares);
  }

  // Their mean.
  std::vector<double> OutputsOf(const SampleSet& set, const std::vector<std::size_t>& samples) const {
    const auto inputs = static_cast<std::size_t>(networks_.shape.inputs);
    std::vector<double> mean(static_cast<std::size_t>(networks_.shape.networks), 0.0);
    for (const std::size_t k : samples) {
      const std::vector<float> output = Forward(networks_, set.inputs() + k * inputs, 1).output;
      for (std::size_t n = 0; n < mean.size(); ++n)
        mean[n] += output[n] / static_cast<double>(samples.size());
    }
    return mean;
  }

  static void Append(const std::vector<double>& row, std::vector<double>* rows) {
    rows->insert(rows->end(), row.begin(), row.end());
  }

  const Belief belief_;
  const SampleSet &held_out_, &training_;
  const Parameters<float>& networks_;
  std::vector<std::size_t> in_order_;  // held-out samples, as the robot came by
};

}  // namespace

kinds::Networks::HeldOut CheckHeldOut(const Options& options, const TrainingData& data,
                                      const Parameters<float>& networks) {
  if (data.held_out.size() == 0) return {};
  return HeldOutCheck(options, data, networks).Check();
}

}  // namespace cairn::landmark_learning
