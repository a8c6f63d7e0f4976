// A toy pipeline whose blobs are nothing but their hashes: each is a pure function of the task that made it.
// What it computes means nothing; a task that was given wrong inputs, or partials in another order, gives
// another hash.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "schema/hash.h"
#include "schema/job.pb.h"
#include "schema/wire.pb.h"

namespace cairn::simulation {

struct ToyAnswer {
  Hash partial;             // RUN
  proto::Step step;         // START, ADVANCE
  std::vector<Hash> blobs;  // that come with it
  bool input_error = false;
};

// What a worker answers to `assign`.
ToyAnswer ComputeToy(const wire::Assign& assign);

// A job of `stages` stages; `rounds` and `tasks` are upper bounds, drawn from the seed stage by stage.
proto::Job MakeToyJob(std::uint64_t seed, int stages, int rounds, int tasks, bool input_error);

// What the job gives when nothing disturbs it.
struct ToyTruth {
  std::map<std::pair<std::uint32_t, std::uint64_t>, Hash>
      steps;                  // (stage, round) -> hash of the step planning it
  std::vector<Hash> results;  // of each stage
  std::size_t most_tasks = 0;
};
ToyTruth RunToy(const proto::Job& job);

}  // namespace cairn::simulation
