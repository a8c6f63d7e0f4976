#include "coordinator/cli/output/progress_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cairn::cli {
namespace {

constexpr int kBarWidth = 20;

double RoundPart(const wire::JobInfo& info) {
  return info.tasks() == 0 ? 0 : static_cast<double>(info.tasks_done()) / info.tasks();
}

std::string Bar(double part) {
  const int full = static_cast<int>(std::lround(part * kBarWidth));
  return "[" + std::string(static_cast<std::size_t>(full), '#') +
         std::string(static_cast<std::size_t>(kBarWidth - full), '-') + "]";
}

// Cut before a byte that continues a character of UTF-8.
std::string Cut(std::string text, int width) {
  if (width <= 0 || text.size() <= static_cast<std::size_t>(width)) return text;
  std::size_t end = static_cast<std::size_t>(width);
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  text.resize(end);
  return text;
}

}  // namespace

std::string Duration(double seconds) {
  const auto whole = static_cast<long long>(std::llround(std::max(0.0, seconds)));
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string LeftText(const wire::JobInfo& info) {
  constexpr double kSpan = 2;  // narrower ones are told as a figure
  if (info.eta_s() <= 0) return "";
  const auto text = [](double seconds) { return Duration(std::max(1.0, seconds)); };  // not "0:00 left"
  if (info.eta_most_s() <= kSpan * info.eta_least_s()) return text(info.eta_s());
  const std::string least = text(info.eta_least_s()), most = text(info.eta_most_s());
  return least == most ? most : least + " to " + most;
}

double PartDone(const wire::JobInfo& info) {
  if (info.rounds_left() == 0) return -1;
  const double done = static_cast<double>(info.round()) + RoundPart(info);
  const double all = static_cast<double>(info.round()) + info.rounds_left();
  return std::min(1.0, done / all);
}

std::string ProgressLine(const wire::JobInfo& info, int width) {
  std::string line =
      info.name() + " " + std::to_string(info.stage() + 1) + "/" + std::to_string(info.stages());
  if (info.stages() > 1) line += " " + info.stage_name();
  const double part = PartDone(info);
  if (part >= 0) line += " " + Bar(part);
  if (info.eta_s() > 0) line += " about " + LeftText(info) + " left,";
  line += " " + std::to_string(info.tasks_done()) + "/" + std::to_string(info.tasks()) + " tasks";
  if (!info.note().empty()) line += ", " + info.note();
  return Cut(line, width);
}

}  // namespace cairn::cli
