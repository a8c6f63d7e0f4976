#include "coordinator/server/metrics.h"

#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <set>
#include <sstream>

namespace cairn::coordinator {
namespace {

Metrics SomeMetrics() {
  Metrics metrics;
  metrics.version = "0.1.0";
  metrics.compiler = "GNU 12 \"odd\\\"";
  metrics.census.jobs = {{"done", 2}, {"running", 1}};
  metrics.census.workers = {{"busy", 3}};
  metrics.census.tasks_running = 6;
  metrics.census.waiting_work_s = 12.5;
  metrics.tally.tasks_done = 1ull << 53;
  metrics.tally.rounds.Add(0.002);
  metrics.tally.rounds.Add(1e6);
  metrics.refused = {{"key", 7}};
  metrics.store_bytes = 123'456'789'012;
  metrics.last_checkpoint_utc_s = 1'700'000'000.25;
  return metrics;
}

bool HasLine(const std::string& page, const std::string& line) {
  return ("\n" + page).find("\n" + line + "\n") != std::string::npos;
}

TEST(MetricsText, WritesEachValueSoThatItIsReadAsTheSame) {
  const std::string page = MetricsText(SomeMetrics());
  for (const char* line :
       {"cairn_jobs{state=\"done\"} 2", "cairn_tasks{state=\"running\"} 6", "cairn_waiting_work_seconds 12.5",
        "cairn_tasks_done_total 9007199254740992", "cairn_store_bytes 123456789012",
        "cairn_store_limit_bytes +Inf", "cairn_store_writable 1",
        "cairn_last_checkpoint_timestamp_seconds 1700000000.25", "cairn_refusals_total{reason=\"key\"} 7",
        "cairn_refusals_total{reason=\"store\"} 0",
        "cairn_build_info{version=\"0.1.0\",compiler=\"GNU 12 \\\"odd\\\\\\\"\"} 1"})
    EXPECT_TRUE(HasLine(page, line)) << line << "\n" << page;
}

TEST(MetricsText, AHistogramsBucketsAddUp) {
  const std::string page = MetricsText(SomeMetrics());
  for (const char* line :
       {"cairn_round_duration_seconds_bucket{le=\"0.001\"} 0",
        "cairn_round_duration_seconds_bucket{le=\"0.003\"} 1",
        "cairn_round_duration_seconds_bucket{le=\"10000\"} 1",
        "cairn_round_duration_seconds_bucket{le=\"+Inf\"} 2", "cairn_round_duration_seconds_sum 1000000.002",
        "cairn_round_duration_seconds_count 2"})
    EXPECT_TRUE(HasLine(page, line)) << line << "\n" << page;
}

// A reader as strict as the format: HELP, TYPE, then that metric's samples and no other's.
TEST(MetricsText, EveryLineIsOfTheFormat) {
  static const std::regex kHelp(R"(# HELP ([a-z_]+) [A-Z0-9].*\.)");
  static const std::regex kType(R"(# TYPE ([a-z_]+) (gauge|counter|histogram))");
  static const std::regex kSample(
      R"re(([a-z_]+)(\{[a-z]+="([^"\\]|\\["\\n])*"(,[a-z]+="([^"\\]|\\["\\n])*")*\})? (\+Inf|[0-9.e+-]+))re");
  std::istringstream page(MetricsText(SomeMetrics()));
  std::set<std::string> seen;
  std::string line, name, type;
  std::smatch match;
  bool typed = false;
  for (; std::getline(page, line);) {
    if (std::regex_match(line, match, kHelp)) {
      name = match[1];
      EXPECT_TRUE(seen.insert(name).second) << "twice: " << name;
      typed = false;
    } else if (std::regex_match(line, match, kType)) {
      EXPECT_EQ(match[1], name);
      type = match[2];
      typed = true;
      EXPECT_EQ(type == "counter", name.ends_with("_total")) << name;
    } else {
      ASSERT_TRUE(std::regex_match(line, match, kSample)) << line;
      EXPECT_TRUE(typed) << line;
      const std::string of = match[1];
      const bool part =
          type == "histogram" && (of == name + "_bucket" || of == name + "_sum" || of == name + "_count");
      EXPECT_TRUE(type == "histogram" ? part : of == name) << line;
    }
  }
  EXPECT_GE(seen.size(), 19u);
}

// | `name` | type | labels | meaning |
TEST(MetricsText, ThePageOfTheManualListsWhatThereIs) {
  std::ifstream manual(CAIRN_SOURCE_DIR "/docs/monitoring.md");
  static const std::regex kRow(R"re(\| `(cairn_[a-z_]+)` \| ([a-z]+) \|.*\| (.*) \|)re");
  std::set<std::string> told, there;
  std::smatch match;
  for (std::string line; std::getline(manual, line);)
    if (std::regex_match(line, match, kRow)) told.insert(match[1].str() + " " + match[2].str());
  static const std::regex kType(R"(# TYPE (.*))");
  std::istringstream page(MetricsText({}));
  for (std::string line; std::getline(page, line);)
    if (std::regex_match(line, match, kType)) there.insert(match[1]);
  EXPECT_EQ(told, there);
}

}  // namespace
}  // namespace cairn::coordinator
