// What a process must fix before it computes, so that the same call gives the same bits everywhere.
#pragma once

#include "schema/hash.h"

namespace cairn {

// Once, first thing in every process that computes: the blocking of Eigen's products, and with it their order
// of summation, follows the CPU's cache sizes unless they are given.
void FixNumericsOfProcess();
// In every thread that computes: round to nearest, keep subnormal numbers (MXCSR on x86-64).
void FixNumericsOfThread();

// A hash over what a fixed set of numeric calls gives here: exp, log, sin, cos, atan2, tanh, pow, sqrt, fma,
// sums in fixed order, an Eigen product, Rng. Machines whose hashes differ cannot share a job.
Hash NumericSelfTest();

}  // namespace cairn
