#include "pipelines/local_map/traces/superposed.h"

#include <array>
#include <cmath>
#include <span>

#include "schema/error.h"

namespace cairn::local_map {
namespace {

constexpr int kFine = 4;  // steps of a profile in a cell

// One similarity of all features of a trace; 0: unknown.
class Vector {
 public:
  explicit Vector(const ImmediateTrace& now) : size_(now.trace.features().size()) {
    CAIRN_DEMAND(size_ <= kMaxFeatures, "a trace that is laid upon another has kMaxFeatures at most");
  }
  std::size_t size() const { return size_; }
  void Put(std::size_t k, float left, float right) {
    left_[k] = left;
    right_[k] = right;
  }
  Total Sum(const ScoreOptions& options) {
    return TotalOf(std::span(left_).first(size_), std::span(right_).first(size_), options.scheme,
                   options.trim);
  }

 private:
  std::size_t size_;
  std::array<float, kMaxFeatures> left_, right_;
};

// similarity(recorded feature, feature now) -> {left, right}, of the features that lie upon each other.
template <class Similarity>
Total SumOver(const OnTrace& on, int shift, const ScoreOptions& options, const Similarity& similarity) {
  Vector vector(on.now);
  const auto& features = on.now.trace.features();
  for (std::size_t k = 0; k < features.size(); ++k) {
    const Feature* recorded = on.recorded.Find(on.now.trace.first_z() + static_cast<int>(k) + shift);
    const auto [left, right] = recorded ? similarity(*recorded, features[k]) : std::pair(0.0F, 0.0F);
    vector.Put(k, left, right);
  }
  return vector.Sum(options);
}

// Catmull and Rom's cubic between the middle two of four samples: smooth, so that a peak can lie between
// them.
double Between(double a, double b, double c, double d, double t) {
  return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

// The cubic between whole_score(shift) at whole shifts, and edges across the way, which know fractions.
template <class Score>
Profile ProfileAlong(const OnTrace& on, double range_m, const ScoreOptions& options,
                     const Score& whole_score) {
  Profile profile(on.recorded.cell_m() / kFine, range_m);
  const double first = on.ShiftOf(on.at.z_m - profile.reach() * profile.step_m());
  const int low = static_cast<int>(std::floor(first)) - 1, count = 2 * profile.reach() / kFine + 5;
  std::array<double, 2 * Profile::kReach / kFine + 5> whole{};
  for (int k = 0; k < count; ++k) whole[static_cast<std::size_t>(k)] = whole_score(low + k);
  for (int step = -profile.reach(); step <= profile.reach(); ++step) {
    const double shift = on.ShiftOf(on.at.z_m + step * profile.step_m()), below = std::floor(shift);
    const auto k = static_cast<std::size_t>(below - low);
    profile[step] = Between(whole[k - 1], whole[k], whole[k + 1], whole[k + 2], shift - below) +
                    CrossScore(on, shift, options);
  }
  return profile;
}

}  // namespace

double EdgeScore(const OnTrace& on, int shift, const ScoreOptions& options) {
  const SimilarityOptions& s = options.similarity;
  return SumOver(on, shift, options,
                 [&](const Feature& recorded, const Feature& now) {
                   return std::pair(EdgeSimilarity(recorded.left, now.left, s),
                                    EdgeSimilarity(recorded.right, now.right, s));
                 })
      .sum;
}

double WidthScore(const OnTrace& on, int shift, const ScoreOptions& options) {
  return options.width_weight * SumOver(on, shift, options, [&](const Feature& recorded, const Feature& now) {
                                  return std::pair(WidthSimilarity(recorded, now, options.similarity), 0.0F);
                                }).sum;
}

double CrossScore(const OnTrace& on, double shift, const ScoreOptions& options) {
  const auto& features = on.now.trace.features();
  Vector vector(on.now);
  for (std::size_t k = 0; k < features.size(); ++k) {
    const double z = on.now.trace.first_z() + static_cast<double>(k) + shift;
    vector.Put(k, CrossSimilarity(on.recorded, features[k].left, z, true, options.similarity),
               CrossSimilarity(on.recorded, features[k].right, z, false, options.similarity));
  }
  return options.cross_weight * vector.Sum(options).sum;
}

Total SidesScore(const OnTrace& on, int shift, double u_m, const ScoreOptions& options) {
  const double left_m = u_m - on.now.robot.u_m;  // of one z axis from the other
  return SumOver(on, shift, options, [&](const Feature& recorded, const Feature& now) {
    return std::pair(SideSimilarity(recorded.left, now.left, left_m, options.similarity),
                     SideSimilarity(recorded.right, now.right, -left_m, options.similarity));
  });
}

Profile AlongProfile(const OnTrace& on, double range_m, const ScoreOptions& options) {
  return ProfileAlong(on, range_m, options, [&](int shift) {
    return EdgeScore(on, shift, options) + WidthScore(on, shift, options);
  });
}

Profile AlongProfileAt(const OnTrace& on, double u_m, double range_m, const ScoreOptions& options) {
  return ProfileAlong(on, range_m, options, [&](int shift) {
    return EdgeScore(on, shift, options) + SidesScore(on, shift, u_m, options).sum;
  });
}

Profile SidesProfile(const OnTrace& on, double dz_m, double range_m, const ScoreOptions& options) {
  Profile profile(on.recorded.cell_m() / kFine, range_m);
  const auto shift = static_cast<int>(std::lround(on.ShiftOf(on.at.z_m + dz_m)));
  for (int step = -profile.reach(); step <= profile.reach(); ++step)
    profile[step] = SidesScore(on, shift, on.at.u_m + step * profile.step_m(), options).sum;
  return profile;
}

}  // namespace cairn::local_map
