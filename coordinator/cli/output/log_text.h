// Lines of a job's log, for people and for programs.
#pragma once

#include <string>

#include "schema/wire.pb.h"

namespace cairn::cli {

// "2026-11-21T14:20:05Z  warning: task 3 of …\n"; what is no warning goes without the word.
std::string LineText(const wire::LogLine& line);

// One JSON object, on one line.
std::string LineJson(const wire::LogLine& line);

// "(312 earlier lines are gone …)\n" where the first line that is kept is not the job's first; else empty.
std::string GoneText(const wire::LogLine& first);

}  // namespace cairn::cli
