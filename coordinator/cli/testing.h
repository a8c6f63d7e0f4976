// For tests: what a command line prints, and how it ends.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "coordinator/cli/app.h"

namespace cairn::cli {

struct Said {
  int code;
  std::string out, complaint;  // what went to stdout, to stderr
};

inline Said Cairn(std::vector<std::string> words) {
  words.insert(words.begin(), "cairn");
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = Main(static_cast<int>(arguments.size()), arguments.data());
  return {code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

}  // namespace cairn::cli
