#include "tests/simulation/checks.h"

#include <algorithm>

namespace cairn::simulation {
namespace {

std::string Text(const std::pair<std::uint32_t, std::uint64_t>& place) {
  return "stage " + std::to_string(place.first) + " round " + std::to_string(place.second) + "-";
}

}  // namespace

void Checks::AddJob(const std::string& id, const proto::Job& job) {
  if (jobs_.contains(id)) return;
  Known& known = jobs_[id];
  known.stages = static_cast<std::uint32_t>(job.stages_size());
  known.bad = job.stages(0).options().contains("bad");
  known.truth = RunToy(job);
}

void Checks::See(const coordinator::Job& job, std::uint64_t incarnation) {
  Known& known = jobs_.at(job.id);
  const Place place{job.stage, job.step ? job.round + 1 : 0};
  if (incarnation != known.incarnation) {
    if (place < known.durable)
      Fail(job.id + " came back at " + Text(place) + ", durable was " + Text(known.durable));
  } else if (place != known.seen) {
    const bool next_round = place == Place{known.seen.first, known.seen.second + 1};
    const bool next_stage = place == Place{known.seen.first + 1, 0};
    if (!next_round && !next_stage) Fail(job.id + " went from " + Text(known.seen) + " to " + Text(place));
  }
  known.incarnation = incarnation;
  if (place == known.seen) return;
  known.seen = place;
  if (job.step && coordinator::HashOfStep(*job.step) != known.truth.steps[{job.stage, job.round}])
    Fail(job.id + " has another step than the undisturbed job at " + Text(place));
  if (job.stage > 0 && job.results.at(job.stage - 1) != known.truth.results.at(job.stage - 1))
    Fail(job.id + " has another result than the undisturbed job");
}

void Checks::SeePersist(const coordinator::Persist& persist, std::uint64_t, double) {
  Known& known = jobs_.at(persist.checkpoint.job_id());
  if (persist.checkpoint.number() == 0) Fail("a checkpoint without a number");
  known.number = persist.checkpoint.number();
}

void Checks::SeeDurable(const proto::Checkpoint& checkpoint) {
  Known& known = jobs_.at(checkpoint.job_id());
  const Place place{checkpoint.stage(), checkpoint.has_step() ? checkpoint.round() + 1 : 0};
  if (place < known.durable) Fail(checkpoint.job_id() + " saved an earlier round after a later one");
  known.durable = place;
  if (checkpoint.state() != proto::JOB_DONE) return;
  if (known.published.size() != known.stages)
    Fail(checkpoint.job_id() + " is done before its results are published");
}

void Checks::SeeDamaged(const proto::Checkpoint& checkpoint) {
  jobs_.at(checkpoint.job_id()).durable = {checkpoint.stage(),
                                           checkpoint.has_step() ? checkpoint.round() + 1 : 0};
}

void Checks::SeeResult(const std::string& id, std::uint32_t stage, const Hash& result) {
  Known& known = jobs_.at(id);
  if (known.truth.results.at(stage) != result)
    Fail(id + " published another result than the undisturbed job's");
  known.published[stage] = result;
}

void Checks::SeeEnd(const coordinator::Job& job) {
  const Known& known = jobs_.at(job.id);
  if (known.bad) {
    if (!job.input_error || job.reason.find("bad input") == std::string::npos)
      Fail(job.id + " has bad input, but ended otherwise: " + job.reason);
    return;
  }
  if (job.state != proto::JOB_DONE) Fail(job.id + " is not done: " + job.reason);
  if (known.published.size() != known.stages)
    Fail(job.id + " is done, but not all its results are published");
}

std::size_t Checks::MostBlobs(const std::string& id) const {
  const Known& known = jobs_.at(id);
  // Input and results; partials, shared and kept blobs of the step, of two checkpoints, and of the one under
  // way.
  return 1 + known.stages + 4 * (known.truth.most_tasks + 2);
}

}  // namespace cairn::simulation
