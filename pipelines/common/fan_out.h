// Candidate starts of one job advance together: each has a State and tasks as if it were alone, and a round
// holds the tasks of all, so that many workers have something to do.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipelines/pipeline.h"

namespace cairn {

// Merges the steps of candidates into one: the state holds candidate K's own, its names prefixed "start/K/";
// the tasks follow in the order of candidates, each with its candidate's number as the parameter `start`. A
// candidate without tasks waits for the others. None may hold a result. What each expects to follow is added
// up: as many rounds as the longest has.
Step FanOut(std::vector<Step> candidates);

// How many candidates a state holds; 0 where FanOut did not make it. Throws InputError where it cannot be.
int StartsIn(const State& state);

// Candidate `start` of a round that FanOut made: what its own Advance would get to see. Refers to its
// arguments. Throws InputError where the round has not as many partials as the state says.
class OneStart : public Partials, public Inputs {
 public:
  OneStart(const State& merged, int start, Partials& partials, const Inputs& inputs);

  const State& state() const { return state_; }
  bool waits() const { return tasks_ == 0; }

  std::size_t size() const override { return tasks_; }
  BlobPtr Get(std::size_t index) override { return partials_.Get(first_ + index); }

  // The candidate's own blobs by their names in its state, else the stage's inputs.
  bool Has(const std::string& name) const override;
  BlobPtr Get(const std::string& name) const override;

 private:
  State state_;
  std::string prefix_;
  std::size_t first_ = 0, tasks_ = 0;
  Partials& partials_;
  const Inputs& inputs_;
};

}  // namespace cairn
