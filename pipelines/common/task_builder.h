// Tasks of a round.
#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "schema/job.pb.h"

namespace cairn {

// Rows [first, first + count) of each of a blob's fields; count 0: all rows.
struct BlobRows {
  std::int64_t first = 0, count = 0;
};

// Of a round: a coordinator takes no more.
inline constexpr std::int64_t kMostTasks = 200'000;

// Adds a task to a plan, whose State holds already what the task reads.
class TaskBuilder {
 public:
  // `cost`: microseconds of a core that it is expected to take; at least one is counted.
  // Throws InputError where the plan has more tasks than a round may.
  TaskBuilder(std::string_view kind, double cost, proto::Step* plan);

  // A parameter: an integer, a number, a truth value or a text.
  template <class T>
  TaskBuilder& Set(const std::string& name, const T& value) {
    proto::Value& param = (*task_->mutable_params())[name];
    if constexpr (std::same_as<T, bool>)
      param.set_b(value);
    else if constexpr (std::is_integral_v<T>)
      param.set_i(static_cast<std::int64_t>(value));
    else if constexpr (std::is_floating_point_v<T>)
      param.set_d(value);
    else
      param.set_s(value);
    return *this;
  }

  // An input named `as`: the State's blob of this name, or `blob`.
  // Throws std::out_of_range where the State has none.
  TaskBuilder& Read(const std::string& as) { return Read(as, as); }
  TaskBuilder& Read(const std::string& as, const std::string& blob, BlobRows rows = {});
  // A blob by its content hash.
  TaskBuilder& ReadHash(const std::string& as, const std::string& hash, BlobRows rows = {});
  // No more of it than that: a large blob need not go anywhere as a whole.
  TaskBuilder& ReadPart(const std::string& as, const std::string& hash, const proto::BlobPart& part);
  // The partial of an earlier task of the round.
  TaskBuilder& ReadPartial(const std::string& as, std::int64_t task);

  std::int64_t index() const { return task_->index(); }

 private:
  proto::Step* plan_;
  proto::Task* task_;
};

}  // namespace cairn
