// What a person sees while something runs: on a terminal a line that is drawn again and again, elsewhere
// plain lines about once a second; log lines between. All on stderr, so that stdout holds facts alone.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "coordinator/cli/common/invocation.h"
#include "coordinator/store/log.h"
#include "schema/wire.pb.h"

namespace spdlog {
class logger;
}

namespace cairn::cli {

class Console {
 public:
  using Level = coordinator::Severity;

  explicit Console(const Invocation& call);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  void Progress(const wire::JobInfo& info);
  void Log(Level level, const std::string& line);
  // Takes the progress line away; the next Progress() draws it again.
  void Clear();
  // For a coordinator's log lines, while this lives.
  coordinator::LogSink Sink();

 private:
  using Clock = std::chrono::steady_clock;

  bool terminal_;
  bool json_ = false;
  bool drawn_ = false;
  std::shared_ptr<spdlog::logger> logger_;
  Clock::time_point last_line_{};
  std::string last_note_;
};

}  // namespace cairn::cli
