// Candidates as the rounds of a search hold them: each the State of an EM of its own.
#pragma once

#include <string>
#include <vector>

#include "pipelines/landmark_map/search.h"
#include "pipelines/landmark_map/state/options.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

inline constexpr const char* kFailure = "failure";  // why a candidate could not go on: in partials and states

// EM from odometry alone. `step`: with the State of any candidate, which it keeps but for the first
// robot's odometry.
void BeginFrom(const StartingPoint& start, const Options& options, const std::vector<std::string>& robots,
               const Settings& settings, const RobotSteps& first_robot, cairn::Step* step);

// What a candidate's State says of where it started, kept in the State after it.
void KeepStart(const State& before, State* after);

// EM of the first robot has ended in `step`: its tasks are now one more E-step of that robot, for which
// landmark each observation is of.
void PlanAssociations(const Options& options, const std::vector<std::string>& robots, cairn::Step* step);
bool AwaitsAssociations(const State& state);
// Takes them from that E-step. `inputs`: the candidate's.
// Throws NoPathError where no path fits.
void KeepAssociations(const Options& options, Partials& partials, const Inputs& inputs, cairn::Step* step);
// The State as it was before, for what comes after the search.
void DropAssociations(State* state);

// What became of the candidates, and those that come next. `steps`: of each, as its own Advance left it;
// `inputs`: of the round that held them all.
class CandidateRounds {
 public:
  CandidateRounds(const Options& options, std::vector<cairn::Step> steps, const Inputs& inputs);

  const std::vector<Candidate>& candidates() const { return candidates_; }
  const Settings& settings() const { return settings_; }
  // What all candidates should have taken so far, reckoned from sizes.
  double Seconds() const;
  // How often the search went on; whether it did from a best candidate with the map of this one.
  int waves() const;
  bool WentOnFrom(int candidate) const;
  // The first robot's, from one observation to the next.
  double MeanIncrementM() const;
  // Adds what is proposed, planned; refits are of `best`. Where it is found no more often, `beyond` starts
  // follow.
  void GoOnFrom(int best, int beyond, const std::vector<Proposal>& proposals);

  std::vector<cairn::Step> Take() && { return std::move(steps_); }

 private:
  bool WentOn(std::size_t candidate) const;
  BlobPtr BlobOf(std::size_t candidate, const std::string& name) const;
  cairn::Step Refit(int parent, std::size_t without) const;

  const Options& options_;
  std::vector<cairn::Step> steps_;
  const Inputs& inputs_;
  std::vector<std::string> robots_;
  Settings settings_;
  std::vector<Candidate> candidates_;
};

}  // namespace cairn::landmark_map
