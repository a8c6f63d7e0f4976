#include "coordinator/cli/output/console.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

namespace cairn::cli {
namespace {

std::string Logged(const Invocation& call, const std::vector<std::string>& lines) {
  testing::internal::CaptureStderr();
  {
    Console console(call);
    for (const std::string& line : lines) console.Log(Console::Level::kWarning, line);
  }
  return testing::internal::GetCapturedStderr();
}

TEST(Console, WhateverItLogsAsJsonIsAnObjectALineInUtf8) {
  const std::vector<std::string> lines = {"plain",
                                          "two\nlines\r",
                                          "\"quoted\" \\ \x1b[31m",
                                          "no UTF-8: \xff\xc3",
                                          "\xc3\xa4 {\"level\":\"error\"}",
                                          "%v %n {} {0}",
                                          std::string("a\0b", 3),
                                          "end",
                                          ""};
  Invocation json;
  json.log_json = true;
  std::istringstream said(Logged(json, lines));
  std::vector<nlohmann::json> read;
  for (std::string line; std::getline(said, line);) read.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(read.size(), lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    EXPECT_EQ(read[i].size(), 3u);
    EXPECT_EQ(read[i].at("level"), "warning");
    EXPECT_EQ(read[i].at("time").get<std::string>().substr(0, 2), "20");
  }
  for (const std::size_t i : {0u, 1u, 2u, 4u, 5u, 6u, 7u}) EXPECT_EQ(read[i].at("message"), lines[i]);
  EXPECT_EQ(read[3].at("message"), "no UTF-8: \xef\xbf\xbd\xef\xbf\xbd")
      << "nlohmann's parser takes UTF-8 alone";
}

TEST(Console, ElseALineIsForPeople) {
  const std::string said = Logged({}, {"plain"});
  EXPECT_TRUE(said.ends_with("plain\n") && !said.starts_with("{")) << said;
}

}  // namespace
}  // namespace cairn::cli
