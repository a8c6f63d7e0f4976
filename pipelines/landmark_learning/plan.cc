#include "pipelines/landmark_learning/plan.h"

#include "pipelines/landmark_learning/block_task.h"

namespace cairn::landmark_learning {
namespace {

void Add(const char* kind, const Range& block, proto::Step* plan) {
  Task& task = *plan->add_tasks();
  task.set_index(static_cast<std::uint32_t>(plan->tasks_size() - 1));
  task.set_kind(kind);
  task.set_cost(static_cast<std::uint64_t>(block.size()));
  (*task.mutable_params())["first"].set_i(block.first);
  (*task.mutable_params())["end"].set_i(block.end);
  for (const char* name : {"data", "weights"}) {
    proto::InputRef& input = *task.add_inputs();
    input.set_name(name);
    input.set_blob(plan->state().blobs().at(name));
  }
}

}  // namespace

void Planner::Plan(const Training& training, Step* step) const {
  const int samples = data_.training.size(), networks = static_cast<int>(options_.networks);
  for (const Range& block : Blocks(samples, samples, networks)) Add("gradient", block, &step->plan);
  if (Validates(training.descent.step)) {
    for (const Range& block : Blocks(data_.held_out.size(), samples, networks))
      Add("validate", block, &step->plan);
  }
  step->plan.set_rounds_left(static_cast<std::uint32_t>(options_.steps - training.descent.step));
}

bool Planner::Validates(std::int64_t steps_done) const {
  return data_.held_out.size() > 0 && steps_done % options_.validate_every == 0;
}

}  // namespace cairn::landmark_learning
