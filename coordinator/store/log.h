// Lines for people about what happens: a worker joined or was refused, a task is tried again, a job ended.
#pragma once

#include <functional>
#include <string>

namespace cairn::coordinator {

enum class Severity { kInfo, kWarning, kError };
using LogSink = std::function<void(Severity, const std::string& line)>;
// The same with the job that a line is about, or with an empty name.
using JobLogSink = std::function<void(Severity, const std::string& job, const std::string& line)>;

}  // namespace cairn::coordinator
