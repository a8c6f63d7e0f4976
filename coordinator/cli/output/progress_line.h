// How far a job is, as one line for people.
#pragma once

#include <string>

#include "schema/wire.pb.h"

namespace cairn::cli {

// "1:05", "2:03:00".
std::string Duration(double seconds);

// What is left of its stage: "0:10", or "0:05 to 0:40" where the data decide what work is to come; nothing
// where it is unknown.
std::string LeftText(const wire::JobInfo& info);

// The part of a stage that is done, from 0 to 1; below 0 where it cannot be said.
double PartDone(const wire::JobInfo& info);

// "museum 1/2 landmarks [######------] about 0:07 left, 12/20 tasks, iteration 3, log-likelihood -512.3", at
// most `width` columns; what is left is of the stage.
std::string ProgressLine(const wire::JobInfo& info, int width);

}  // namespace cairn::cli
