// What is known of a pair of samples before anything is sensed: how far apart they were taken, and how much a
// robot that is at one believes in the other.
#pragma once

#include <vector>

namespace cairn::landmark_learning {

// Where samples were taken, [samples] in the order of all other arrays. Neighbours in that order should be
// neighbours in space, as those of a run are: tiles of pairs out of reach are skipped.
struct Places {
  std::vector<double> x_m, y_m;
  std::vector<double> along_m;  // way travelled until there

  int size() const { return static_cast<int>(x_m.size()); }
};

enum class BeliefShape {
  kUniform,   // over the samples within `width_m`
  kGaussian,  // of standard deviation `width_m`, cut off at three of them
};

// Bel_prior around the true position. Its rows need not add up to one: E_posterior does not care, and E_prior
// divides by their sums.
struct Belief {
  BeliefShape shape = BeliefShape::kUniform;
  double width_m = 2.0;  // infinite: globally uncertain

  double ReachM() const { return shape == BeliefShape::kGaussian ? 3.0 * width_m : width_m; }
};

// e(xi*, xi), in metres, but for the square.
enum class ErrorKind { kDistance, kSquaredDistance, kAlong };

// Samples first <= k < end.
struct Range {
  int first, end;
  int size() const { return end - first; }
};

inline constexpr int kTileSamples = 8;

// The least box around some places.
struct Box {
  double low_x_m, high_x_m, low_y_m, high_y_m;
};
Box BoxAround(const Places& places, const Range& range);

// Samples that a strip of truths reaches: whole tiles, but for the end of the set.
struct Stretch {
  Range samples;
  bool all;  // Bel_prior is one for each of the pairs, and no table of it is needed
};

// What Fill works in, used again from call to call.
template <class Real>
struct Columns {
  std::vector<Real> x, y, along;
};

// Every pair of a true position and a sample for which it may be taken. In training both are of one set.
class Pairs {
 public:
  // `truths` and `samples` must outlive this.
  Pairs(const Places& truths, const Places& samples, const Belief& belief, ErrorKind error);

  const Places& samples() const { return samples_; }
  const Belief& belief() const { return belief_; }

  // All samples in reach of any of `truths`, in order; and the first of them to the last.
  void Reach(const Range& truths, std::vector<Stretch>* stretches) const;
  Range ReachOf(const Range& truths) const;

  // Bel_prior and e times it, each [truths][stride]; columns from samples.first on, filled up to whole tiles.
  // `belief` is left as it is where the stretch is `all`.
  template <class Real>
  void Fill(const Range& truths, const Stretch& stretch, int stride, Columns<Real>* columns, Real* belief,
            Real* weighted) const;

 private:
  Range TilesAround(const Box& truths) const;

  const Places &true_, &samples_;
  Belief belief_;
  ErrorKind error_;
  std::vector<Box> tiles_;  // of samples
  std::vector<Box> until_;  // high: of this tile and those before; low: of this one and those after
};

}  // namespace cairn::landmark_learning
