#include "pipelines/common/fan_out.h"

#include <algorithm>
#include <set>

#include "pipelines/common/handed_over.h"
#include "pipelines/common/task_builder.h"

namespace cairn {
namespace {

std::string Prefix(int start) { return "start/" + std::to_string(start) + "/"; }

// The names of a map that begin with a prefix, without it.
template <class M>
void TakeOwn(const M& merged, const std::string& prefix, M* own) {
  for (const auto& [name, value] : merged) {
    if (name.starts_with(prefix)) (*own)[name.substr(prefix.size())] = value;
  }
}

void AddTasks(const proto::Step& candidate, int start, proto::Step* merged) {
  const auto first = static_cast<std::uint32_t>(merged->tasks_size());
  for (const Task& own : candidate.tasks()) {
    Task& task = *merged->add_tasks();
    task = own;
    task.set_index(first + own.index());
    (*task.mutable_params())["start"].set_i(start);
    for (proto::InputRef& input : *task.mutable_inputs()) {
      if (input.has_task()) input.set_task(first + input.task());
    }
  }
}

// Of its tasks how many run side by side in the rounds to come: as many as there are workers counts as that.
double WidthOf(const proto::Step& plan) {
  constexpr double kAll = 1e6;
  double widest = 0;
  for (const proto::Phase& phase : plan.later())
    widest = std::max(widest, phase.width() > 0 ? phase.width() : kAll);
  return widest;
}

std::int64_t TasksOf(const State& merged, int start) {
  return merged.scalars().at("tasks_of_start/" + std::to_string(start)).i();
}

}  // namespace

Step FanOut(std::vector<Step> candidates) {
  Step merged;
  State& state = *merged.plan.mutable_state();
  std::set<std::string> known;             // candidates share blobs
  double rounds = 0, cost = 0, width = 0;  // of what follows this round
  for (int start = 0; start < static_cast<int>(candidates.size()); ++start) {
    Step& own = candidates[static_cast<std::size_t>(start)];
    CAIRN_DEMAND(own.plan.result().empty(), "a candidate that has its result has nothing to wait for");
    const std::string prefix = Prefix(start);
    for (const auto& [name, value] : own.plan.state().scalars())
      (*state.mutable_scalars())[prefix + name] = value;
    for (const auto& [name, hash] : own.plan.state().blobs()) (*state.mutable_blobs())[prefix + name] = hash;
    (*state.mutable_scalars())["tasks_of_start/" + std::to_string(start)].set_i(own.plan.tasks_size());
    AddTasks(own.plan, start, &merged.plan);
    for (BlobPtr& blob : own.blobs) {
      if (known.insert(blob->ContentHash().Binary()).second) merged.blobs.push_back(std::move(blob));
    }
    rounds = std::max(rounds, RoundsLater(own.plan));
    cost += CostLater(own.plan);
    width += WidthOf(own.plan);
  }
  (*state.mutable_scalars())["starts"].set_i(static_cast<std::int64_t>(candidates.size()));
  ExpectRounds(rounds, cost, width, &merged.plan);
  return merged;
}

int StartsIn(const State& state) {
  const auto starts = state.scalars().find("starts");
  if (starts == state.scalars().end()) return 0;
  RequireWithin("the number of starts", starts->second.i(), 0, kMostTasks);
  return static_cast<int>(starts->second.i());
}

OneStart::OneStart(const State& merged, int start, Partials& partials, const Inputs& inputs)
    : prefix_(Prefix(start)), partials_(partials), inputs_(inputs) {
  TakeOwn(merged.scalars(), prefix_, state_.mutable_scalars());
  TakeOwn(merged.blobs(), prefix_, state_.mutable_blobs());
  for (int of = 0; of <= start; ++of) {
    first_ += tasks_;
    const std::int64_t tasks = TasksOf(merged, of);
    RequireWithin("the tasks of a start", tasks, 0, static_cast<std::int64_t>(partials.size() - first_));
    tasks_ = static_cast<std::size_t>(tasks);
  }
}

bool OneStart::Has(const std::string& name) const { return inputs_.Has(prefix_ + name) || inputs_.Has(name); }

BlobPtr OneStart::Get(const std::string& name) const {
  return inputs_.Get(inputs_.Has(prefix_ + name) ? prefix_ + name : name);
}

}  // namespace cairn
