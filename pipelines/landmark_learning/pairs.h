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

// Every pair of a true position and a sample for which it may be taken. In training both are of one set.
class Pairs {
 public:
  Pairs(const Places& truths, const Places& samples, const Belief& belief, ErrorKind error)
      : true_(truths), samples_(samples), belief_(belief), error_(error) {}

  const Places& samples() const { return samples_; }

  // Bel_prior and e times it, each [truths][samples].
  template <class Real>
  void Fill(const Range& truths, const Range& samples, Real* belief, Real* weighted) const;

  // Whether any pair of the two sets is within reach: false only where none is.
  bool Reaches(const Range& truths, const Range& samples) const;

 private:
  const Places &true_, &samples_;
  Belief belief_;
  ErrorKind error_;
};

}  // namespace cairn::landmark_learning
