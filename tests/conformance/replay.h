// Runs a stage as a fleet might: tasks in any order that their inputs permit, computed more than once, with
// everything written out and read back between two rounds.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "pipelines/testing/in_process.h"
#include "tests/conformance/cases.h"

namespace cairn::conformance {

// What a coordinator knows after a step: a checkpoint.
struct Moment {
  proto::Step plan;
  BlobsByHash store;  // the inputs, all blobs of this step and those before it
};

struct Trace {
  std::vector<Moment> moments;              // Start's first
  std::vector<std::string> plans;           // their canonical bytes, to compare
  std::vector<std::vector<Hash>> partials;  // by round and task
  BlobPtr result;
};

struct Policy {
  // Which of `n` tasks that are ready runs next; empty: the first.
  std::function<std::size_t(std::size_t n)> pick;
  int times = 1;  // how often each task is computed; every answer must equal the first
};

// From the start, or from a moment of an earlier trace (whose rounds are then missing in front).
Trace Replay(const Case& c, const InputMap& inputs, const Policy& policy = {});
Trace ReplayFrom(const Case& c, const InputMap& inputs, const Moment& moment, const Policy& policy = {});

// The same values at other addresses.
BlobPtr CopyElsewhere(const BlobPtr& blob);
InputMap CopyElsewhere(const InputMap& inputs);

}  // namespace cairn::conformance
