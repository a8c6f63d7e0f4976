#include "coordinator/cli/output/log_text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace cairn::cli {
namespace {

wire::LogLine Line(std::uint64_t number, const std::string& level) {
  wire::LogLine line;
  line.set_number(number);
  line.set_utc("2026-11-21T14:20:05Z");
  line.set_level(level);
  line.set_text("task 3 of \"map\" failed");
  return line;
}

TEST(LogText, SaysWhenAndWhatAndHowBad) {
  EXPECT_EQ(LineText(Line(1, "warning")), "2026-11-21T14:20:05Z  warning: task 3 of \"map\" failed\n");
  EXPECT_EQ(LineText(Line(1, "info")), "2026-11-21T14:20:05Z  task 3 of \"map\" failed\n");
}

TEST(LogText, SaysHowManyLinesAreGone) {
  EXPECT_EQ(GoneText(Line(1, "info")), "");
  EXPECT_EQ(GoneText(Line(313, "info")), "(312 earlier lines are gone: the oldest go first)\n");
}

TEST(LogText, JsonIsOneLineThatHoldsTheSame) {
  const std::string text = LineJson(Line(7, "alarm"));
  EXPECT_EQ(text.find('\n'), text.size() - 1);
  const nlohmann::json json = nlohmann::json::parse(text);
  EXPECT_EQ(json.at("number"), 7);
  EXPECT_EQ(json.at("level"), "alarm");
  EXPECT_EQ(json.at("utc"), "2026-11-21T14:20:05Z");
  EXPECT_EQ(json.at("text"), "task 3 of \"map\" failed");
}

}  // namespace
}  // namespace cairn::cli
