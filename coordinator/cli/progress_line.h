// How far a job is, as one line for people.
#pragma once

#include <string>

#include "schema/wire.pb.h"

namespace cairn::cli {

// "1:05", "2:03:00".
std::string Duration(double seconds);

// The part of a stage that is done, from 0 to 1; below 0 where it cannot be said.
double PartDone(const wire::JobInfo& info);

// "landmarks 1/2 [######------] 0:07 left, 12/20 tasks, iteration 3, log-likelihood -512.3", at most `width`
// columns. `elapsed_s`: since this stage was seen first, from `part_then` on; the remaining time goes by what
// was done since.
std::string ProgressLine(const wire::JobInfo& info, double elapsed_s, double part_then, int width);

}  // namespace cairn::cli
