// Which of a service's jobs a command is about, where they are not named one by one.
#pragma once

#include <string>
#include <vector>

#include "schema/command_line/command.h"
#include "schema/wire.pb.h"

namespace cairn::cli {

struct JobChoice {
  std::string state, name;  // a state; a pattern, as of files; empty: any
};

std::vector<wire::JobInfo> Chosen(const JobChoice& choice, const std::vector<wire::JobInfo>& jobs);

}  // namespace cairn::cli
