// What must hold in every world, at every step. The first thing that does not is kept.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "coordinator/core.h"
#include "tests/simulation/toy.h"

namespace cairn::simulation {

class Checks {
 public:
  void Fail(const std::string& what) {
    if (violation_.empty()) violation_ = what;
  }
  const std::string& violation() const { return violation_; }

  void AddJob(const std::string& id, const proto::Job& job);
  // A job as it stands after an event: it moves by one round at a time, forward, and as the undisturbed one
  // does.
  void See(const coordinator::Job& job, std::uint64_t incarnation);
  void SeePersist(const coordinator::Persist& persist, std::uint64_t incarnation, double now_s);
  void SeeDurable(const proto::Checkpoint& checkpoint);
  // The newest checkpoint was damaged: what is left is this.
  void SeeDamaged(const proto::Checkpoint& checkpoint);
  void SeeResult(const std::string& id, std::uint32_t stage, const Hash& result);
  void SeeEnd(const coordinator::Job& job);
  // More blobs than this the job can never need.
  std::size_t MostBlobs(const std::string& id) const;

 private:
  using Place = std::pair<std::uint32_t, std::uint64_t>;  // stage; round + 1, or 0 before START is answered
  struct Known {
    ToyTruth truth;
    std::uint32_t stages = 0;
    bool bad = false;
    Place durable{0, 0};
    Place seen{0, 0};
    std::uint64_t incarnation = 0;
    std::uint64_t number = 0;  // of the last checkpoint begun
    std::map<std::uint32_t, Hash> published;
  };
  std::map<std::string, Known> jobs_;
  std::string violation_;
};

// One line, for the trace.
std::string Describe(const coordinator::Event& event);
std::string Describe(const coordinator::Action& action);

}  // namespace cairn::simulation
