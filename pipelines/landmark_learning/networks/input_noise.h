// Noise on what networks see while they learn, so that they do not learn the training run's own noise by
// heart: on average a penalty on how strongly outputs depend on inputs (C. M. Bishop, Training with noise is
// equivalent to Tikhonov regularization, Neural Computation 7(1), 1995).
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/landmark_learning/error_sum/pairs.h"

namespace cairn::landmark_learning {

struct InputNoise {
  double deviation = 0.0;  // in that of the input; 0: none
  std::uint64_t seed = 0;
  std::int64_t step = 0;
};

// The inputs of `samples` out of `inputs`: [all samples][width], with noise where there is some. A sample's
// noise depends on its number, the seed and the step alone: whatever block it is looked at from, it is the
// same. It is read off a table of 65,536 normal numbers from a position drawn for the sample.
class InputRows {
 public:
  InputRows(const float* inputs, const IndexRange& samples, int width, const InputNoise& noise);
  const float* data() const { return noisy_.empty() ? clean_ : noisy_.data(); }  // [samples][width]

 private:
  const float* clean_;
  std::vector<float> noisy_;
};

}  // namespace cairn::landmark_learning
