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
  bool fails = false;  // whoever tries it
};

// What a worker answers to `assign`.
ToyAnswer ComputeToy(const wire::Assign& assign);

enum class ToyKind {
  kGood,
  kBadInput,  // round 1 finds that the input is bad
  kPoisoned,  // a task of round 1, or its reduction, fails whoever tries it
  kHopeless,  // its chain of stages cannot be
};
// A job of `stages` stages; `rounds` and `tasks` are upper bounds, drawn from the seed stage by stage.
proto::Job MakeToyJob(std::uint64_t seed, int stages, int rounds, int tasks, ToyKind kind);

// What the job gives when nothing disturbs it.
struct ToyTruth {
  struct Round {
    Hash step;  // that plans it
    std::vector<Hash> partials;
  };
  std::map<std::pair<std::uint32_t, std::uint64_t>, Round> rounds;  // by stage and round
  std::vector<Hash> results;                                        // of each stage
  // Hashes of the plans that end the stages.
  std::vector<Hash> ends;
  std::size_t most_tasks = 0;
};
ToyTruth RunToy(const proto::Job& job);

// The number that its coordinator gave it; a real one puts it before the name (Server::NewJobId).
inline std::uint64_t NumberOf(const proto::Job& job) {
  return job.name().empty() ? 0 : std::stoull(job.name());
}

}  // namespace cairn::simulation
