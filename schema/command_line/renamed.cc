#include "schema/command_line/renamed.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <iterator>

namespace cairn::cli {
namespace {

struct Renamed {
  std::string_view of, before, now;
};

constexpr Renamed kRenamed[] = {
    {"landmark_learning", "truths", "true_positions"},
    {"landmark_map", "max_leg_m", "max_increment_m"},
    {"landmark_map", "polish", "refine"},
    {"local_map", "knot_m", "node_m"},
    {"local_map", "segment_sweeps", "segment_scans"},
    {"local_map", "warm_up_sweeps", "warm_up_scans"},
    {"local_map", "way_sd", "along_sd"},
    {"localization", "way_m", "travelled_m"},
    {"", "--log-json", "--log-format=json"},
    {"", "--press-m", "--contact-m"},
    {"--sensor", "press", "contact"},
};

}  // namespace

std::string NameNow(std::string_view of, const std::string& name) {
  const auto* it =
      std::ranges::find_if(kRenamed, [&](const Renamed& r) { return r.of == of && r.before == name; });
  return it == std::end(kRenamed) ? name : std::string(it->now);
}

void WarnOfOldName(const std::string& before, const std::string& now) {
  std::fprintf(stderr, "%s: warning: '%s' is called '%s' now; the next release knows it by that name alone\n",
               program_invocation_short_name, before.c_str(), now.c_str());
}

std::string ArgumentNow(const std::string& before_it, const std::string& argument) {
  const std::size_t equals = argument.starts_with("--") ? argument.find('=') : std::string::npos;
  std::string now;
  if (equals == std::string::npos) {
    now = NameNow(argument.starts_with("--") ? "" : before_it, argument);
  } else {
    const std::string flag = argument.substr(0, equals);
    now = NameNow("", flag) + "=" + NameNow(flag, argument.substr(equals + 1));
  }
  if (now != argument) WarnOfOldName(argument, now);
  return now;
}

std::vector<std::string> ArgumentsNow(std::vector<char*>* words) {
  std::vector<std::string> now(words->begin(), words->end());
  for (std::size_t i = 1; i < now.size() && now[i] != "--"; ++i) now[i] = ArgumentNow(now[i - 1], now[i]);
  for (std::size_t i = 0; i < now.size(); ++i) (*words)[i] = now[i].data();
  return now;
}

}  // namespace cairn::cli
