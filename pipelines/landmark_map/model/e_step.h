// The E-step ([TBF98] section 4.1) over one time slice of one robot's steps: alpha forward, beta backward,
// their product the belief from which the expected counts are taken.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pipelines/common/motion.h"
#include "pipelines/landmark_map/model/perception.h"
#include "pipelines/landmark_map/model/steps.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

// No path fits what a robot did and saw: from this start, under this map. What is thrown names robot, step
// and observation.
class NoPathError : public InputError {
 public:
  using InputError::InputError;
};

struct EStepModel {
  GridSpec grid;
  MotionNoise noise;
  ErrorShape shape = ErrorShape::kGaussian;
  double prune = 1e-3;        // [TBF98] section 5, selective computation: of the largest probability
  Box limit;                  // beliefs are cut to it; empty: no limit
  double memory_bytes = 4e9;  // alpha tables of one slice may take so much
  const Perception* perception = nullptr;  // nullptr: no map yet, observations are ignored
  bool keep_kernels = false;               // [TBF98] section 5, caching: from Forward to Backward
  // Without the selective memorization of [TBF98] section 5: every heading holds all of `limit`.
  bool whole_tables = false;
};

// Steps first <= t < end of a robot.
struct Slice {
  const RobotSteps& steps;
  int first, end;
  std::string robot;  // its name, for messages
};

// Copies of a belief that are in memory besides the kept alphas: beta, the product, and what moving needs.
inline constexpr double kBeliefCopies = 5.0;

// What a step costs whatever its size, in cells (work.h).
inline constexpr double kStepCells = 4000.0;

// alpha^(t) for the slice's steps, each normalised; log_likelihood: sum of the logarithms of the normalisers;
// work: see work.h; kernels: those of the slice's motion increments, where they are kept.
struct Alphas {
  std::vector<LayeredGrid> tables;
  std::vector<MotionKernel> kernels;
  double log_likelihood = 0.0;
  double work = 0.0;

  std::int64_t Cells() const;
};

// The same without the tables before the last one.
struct Frontier {
  int end = 0;        // the step after the last one
  LayeredGrid alpha;  // of the last one
};

// The belief at step 0 before its observations: all mass at the origin, or ([TBF98] section 8) spread evenly
// over all headings and all places from which the way leads to where the map can explain the first
// observation of a landmark that it holds. Elsewhere only the chance of a false observation speaks for a
// place, which selective computation drops.
LayeredGrid DiracStart(const GridSpec& grid);
LayeredGrid UniformStart(const EStepModel& model, const Slice& slice);

// Both halves of UniformStart: the places under each heading, and a belief spread evenly over such boxes.
std::vector<Box> StartBoxes(const EStepModel& model, const Slice& slice);
LayeredGrid UniformOver(const std::vector<Box>& boxes);

// By how many cells odometry may have led a robot astray from step 0 to `step`, at most: so much wider than
// the places that see the observation is UniformStart.
int MotionMargin(const EStepModel& model, const RobotSteps& steps, int step);

// [TBF98] eqs 15 and 16. `before`: alpha of step first - 1; for first = 0 the belief at the start.
// Throws NoPathError that names robot, step and observation where the evidence is impossible under the model,
// or the robot has left `model.limit`.
// Throws InputError where the tables would need more than `model.memory_bytes`.
Alphas Forward(const EStepModel& model, const Slice& slice, const LayeredGrid& before, Progress& progress);

// The same from slice.first on until `work` is used up, a step at least and slice.end at most.
Frontier ForwardFor(const EStepModel& model, const Slice& slice, LayeredGrid before, double work,
                    Progress& progress);

// [TBF98] eqs 17 and 18, from the slice's last step to its first. `beta`: of the last step, on the support of
// its alpha; returned: beta of step first - 1 on `before`'s support (for first = 0: empty). Shows `visitor`
// what it passes, last step first.
struct Visitor {
  std::function<void(int step, const LayeredGrid& belief)> step;  // alpha * beta: [TBF98] eq. 13
  // The heading's error on the motion increment to `step`; may be empty. Without a map there is nothing to
  // learn of it, and no call.
  std::function<void(int step, const HalfTurn& posterior)> increment;
};
// Throws NoPathError where alpha and beta have no pose in common.
LayeredGrid Backward(const EStepModel& model, const Slice& slice, const Alphas& alphas,
                     const LayeredGrid& before, LayeredGrid beta, Progress& progress, const Visitor& visitor);

// The same without Backward's pass: beta is 1 wherever alpha is above zero, and the belief is alpha.
LayeredGrid ForwardOnly(const Slice& slice, const Alphas& alphas, const LayeredGrid& before,
                        const Visitor& visitor);

// beta of the last step of all: 1 wherever `support` is above zero.
LayeredGrid UniformBeta(const LayeredGrid& support);

}  // namespace cairn::landmark_map
