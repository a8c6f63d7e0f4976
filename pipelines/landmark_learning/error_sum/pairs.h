// What is known of a pair of samples before anything is sensed: how far apart they were taken, and how much a
// robot that is at one believes in the other.
#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include "schema/array.h"

namespace cairn::landmark_learning {

// Where samples were taken, [samples] in the order of all other arrays. Neighbours in that order should be
// neighbours in space, as those of a run are: tiles of pairs out of reach are skipped.
struct Positions {
  std::vector<double> x_m, y_m;
  std::vector<double> along_m;         // distance travelled until there
  std::vector<std::int32_t> row = {};  // of the table of errors; empty where there is none
  Array table = {};                    // f32, [rows][rows]: e from the position of one row to that of another
  std::vector<double> cos_heading = {}, sin_heading = {};  // empty where it is not known

  int size() const { return static_cast<int>(x_m.size()); }
  static void Fields(const auto& field) {
    field("x_m", &Positions::x_m);
    field("y_m", &Positions::y_m);
    field("along_m", &Positions::along_m);
    field("row", &Positions::row);
    field("table", &Positions::table);
    field("cos_heading", &Positions::cos_heading);
    field("sin_heading", &Positions::sin_heading);
  }
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
  // Samples that face farther away from where the robot truly faces are not believed in; pi: whatever they
  // do.
  double heading_rad = std::numbers::pi;

  bool LooksAtHeadings() const { return heading_rad < std::numbers::pi; }
  double ReachM() const { return shape == BeliefShape::kGaussian ? 3.0 * width_m : width_m; }
};

// What a belief in xi costs where xi* is true: e(xi*, xi), in metres, but for the square and a table of
// another unit. Or, for kPosteriorMass, what E_posterior is made of is -log of the belief's mass around the
// true position, in nats.
enum class ErrorKind { kDistance, kSquaredDistance, kAlong, kTable, kPosteriorMass };

struct ErrorRule {
  ErrorKind kind = ErrorKind::kDistance;
  // kPosteriorMass: standard deviation of the bell that weighs the mass, one at its middle.
  double smooth_m = 1.0;

  ErrorRule(ErrorKind k, double smooth = 1.0) : kind(k), smooth_m(smooth) {}  // NOLINT: a kind is a rule
  friend bool operator==(const ErrorRule& rule, ErrorKind other) { return rule.kind == other; }
};

// -log of a mass u in [0, 1], and its derivative; beliefs that rule the truth out cost much, not infinitely.
struct MassCost {
  static constexpr double kLeast = 1e-6;
  static double Of(double u);
  static double Derivative(double u) { return -(1.0 - kLeast) / ((1.0 - kLeast) * u + kLeast); }
};

// Samples first <= k < end.
struct IndexRange {
  int first, end;
  int size() const { return end - first; }
};

inline constexpr int kTileSamples = 8;

// The least box around some positions.
struct Box {
  double low_x_m, high_x_m, low_y_m, high_y_m;
};
Box BoxAround(const Positions& positions, const IndexRange& range);

// Samples that a strip of true positions reaches: whole tiles, but for the end of the set.
struct Stretch {
  IndexRange samples;
  bool all;  // Bel_prior is one for each of the pairs, and no table of it is needed
};

// What Fill works in, used again from call to call.
template <class Real>
struct Columns {
  std::vector<Real> x, y, along, cos_heading, sin_heading;
};

// Every pair of a true position and a sample for which it may be taken. In training both are of one set.
class Pairs {
 public:
  // `true_positions` and `samples` must outlive this; they have headings where the belief looks at them.
  Pairs(const Positions& true_positions, const Positions& samples, const Belief& belief,
        const ErrorRule& error);

  const Positions& samples() const { return samples_; }
  const Belief& belief() const { return belief_; }
  const ErrorRule& error() const { return error_; }

  // All samples in reach of any of `true_positions`, in order; and the first of them to the last.
  void Reach(const IndexRange& true_positions, std::vector<Stretch>* stretches) const;
  IndexRange ReachOf(const IndexRange& true_positions) const;

  // Bel_prior and e times it (kPosteriorMass: the bell times it), each [true positions][stride]; columns from
  // samples.first on, filled up to whole tiles. `belief` is left as it is where the stretch is `all`.
  template <class Real>
  void Fill(const IndexRange& true_positions, const Stretch& stretch, int stride, Columns<Real>* columns,
            Real* belief, Real* weighted) const;

 private:
  IndexRange TilesAround(const Box& true_positions) const;
  // Bel_prior of a row of the table is zero where the samples face another way than the truth.
  template <class Real>
  void KeepThoseThatFaceAs(std::size_t truth, const Columns<Real>& columns, Real* belief,
                           Real* weighted) const;
  template <class Real>
  void LookUp(std::int32_t row, const IndexRange& samples, std::vector<Real>* errors) const;

  const Positions &true_, &samples_;
  Belief belief_;
  ErrorRule error_;
  std::vector<Box> tiles_;  // of samples
  std::vector<Box> until_;  // high: of this tile and those before; low: of this one and those after
};

}  // namespace cairn::landmark_learning
