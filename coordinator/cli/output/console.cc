#include "coordinator/cli/output/console.h"

#include <spdlog/sinks/ansicolor_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "coordinator/cli/output/output.h"
#include "coordinator/cli/output/progress_line.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

int Columns() {
  winsize size = {};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col < 20) return 80;
  return size.ws_col - 1;
}

std::shared_ptr<spdlog::logger> MakeLogger(const Invocation& call) {
  spdlog::sink_ptr sink;
  if (call.log_json)
    sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
  else
    sink = std::make_shared<spdlog::sinks::ansicolor_sink<spdlog::details::console_mutex>>(
        Terminal(), spdlog::color_mode::automatic);
  auto logger = std::make_shared<spdlog::logger>("cairn", sink);
  // In a JSON line the message is a JSON text already.
  logger->set_pattern(call.log_json ? R"({"time":"%Y-%m-%dT%H:%M:%S.%e%z","level":"%l","message":%v})"
                                    : "%T %^%l%$ %v");
  logger->set_level(call.verbose || call.log_json ? spdlog::level::info : spdlog::level::warn);
  return logger;
}

spdlog::level::level_enum ToSpdlog(Console::Level level) {
  if (level == Console::Level::kInfo) return spdlog::level::info;
  return level == Console::Level::kWarning ? spdlog::level::warn : spdlog::level::err;
}

// Bytes that are no UTF-8 are replaced: a log line never fails.
std::string JsonText(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

Console::Console(const Invocation& call) : terminal_(isatty(STDERR_FILENO) != 0 && !call.log_json) {
  logger_ = MakeLogger(call);
  json_ = call.log_json;
}

Console::~Console() { Clear(); }

void Console::Clear() {
  if (drawn_) std::fputs("\r\x1b[K", Terminal());
  drawn_ = false;
}

void Console::Log(Level level, const std::string& line) {
  Clear();
  logger_->log(ToSpdlog(level), "{}", json_ ? JsonText(line) : Escaped(line));
}

coordinator::LogSink Console::Sink() {
  return [this](Level level, const std::string& line) { Log(level, line); };
}

void Console::Progress(const wire::JobInfo& info) {
  if (terminal_) {
    std::fprintf(Terminal(), "\r%s\x1b[K", Escaped(ProgressLine(info, Columns())).c_str());
    drawn_ = true;
    return;
  }
  if (info.tasks() == 0 && info.note().empty()) return;  // nothing to say yet
  const Clock::time_point now = Clock::now();
  const bool fresh = info.note() != last_note_ || now - last_line_ > std::chrono::seconds(10);
  if (!fresh || now - last_line_ < std::chrono::seconds(1)) return;
  last_line_ = now;
  last_note_ = info.note();
  const std::string line = ProgressLine(info, 0);
  if (json_)
    logger_->log(spdlog::level::info, "{}", JsonText(line));
  else
    std::fprintf(stderr, "%s\n", line.c_str());
}

}  // namespace cairn::cli
