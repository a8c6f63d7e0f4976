#include "pipelines/common/task_builder.h"

#include <algorithm>

#include "pipelines/common/handed_over.h"

namespace cairn {

TaskBuilder::TaskBuilder(std::string_view kind, double cost, proto::Step* plan)
    : plan_(plan), task_(plan->add_tasks()) {
  // What is counted in a State may be hostile.
  RequireWithin("the number of tasks", std::int64_t{plan->tasks_size()}, 1, kMostTasks);
  task_->set_index(static_cast<std::uint32_t>(plan->tasks_size() - 1));
  task_->set_kind(std::string(kind));
  task_->set_cost(static_cast<std::uint64_t>(std::min(std::max(1.0, cost), 1e18)));
}

TaskBuilder& TaskBuilder::Read(const std::string& as, const std::string& blob, BlobRows rows) {
  return ReadHash(as, plan_->state().blobs().at(blob), rows);
}

TaskBuilder& TaskBuilder::ReadHash(const std::string& as, const std::string& hash, BlobRows rows) {
  proto::InputRef& input = *task_->add_inputs();
  input.set_name(as);
  input.set_blob(hash);
  if (rows.count == 0) return *this;
  input.set_first_row(rows.first);
  input.set_row_count(rows.count);
  return *this;
}

TaskBuilder& TaskBuilder::ReadPart(const std::string& as, const std::string& hash,
                                   const proto::BlobPart& part) {
  ReadHash(as, hash);
  *task_->mutable_inputs(task_->inputs_size() - 1)->mutable_part() = part;
  return *this;
}

TaskBuilder& TaskBuilder::ReadPartial(const std::string& as, std::int64_t task) {
  proto::InputRef& input = *task_->add_inputs();
  input.set_name(as);
  input.set_task(static_cast<std::uint32_t>(task));
  return *this;
}

}  // namespace cairn
