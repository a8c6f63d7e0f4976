// What a coordinator may know of a step: its form, not its meaning.
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <string>

#include "coordinator/core/round.h"
#include "schema/blob_part.h"
#include "schema/step_limits.h"
#include "schema/text.h"

namespace cairn::coordinator {
namespace {

bool IsHash(const std::string& binary) { return binary.size() == sizeof(Hash::bytes); }

constexpr int kMostPhases = 100;
// Of a round; the largest that a pipeline has planned was of some thousands.
constexpr int kMostTasks = 200'000;
constexpr std::size_t kMostInputs = 500'000;  // each takes the coordinator a kilobyte
constexpr std::size_t kMostParameters = 500'000;

bool IsAmount(double value) { return value >= 0 && value <= kMostAmount; }

std::string CheckTask(const proto::Task& task, std::uint32_t place) {
  if (task.kind().size() > kMostNameBytes) return "task " + std::to_string(place) + ": its kind is no name";
  const std::string name = "task " + std::to_string(place) + " (" + task.kind() + ")";
  if (task.index() != place) return name + " says that its index is " + std::to_string(task.index());
  for (const proto::InputRef& input : task.inputs()) {
    if (input.has_task() && input.task() >= place)
      return name + " reads the partial of a task that is not earlier";
    if (!input.has_task() && !IsHash(input.blob()))
      return name + ": its input '" + input.name() + "' has no hash";
    if (!input.has_part()) continue;
    const std::string wrong = input.has_task() || input.row_count() != 0 || input.first_row() != 0
                                  ? "a part is of a blob, and has its rows itself"
                                  : WhatIsWrong(input.part());
    if (!wrong.empty()) return name + ", its input '" + input.name() + "': " + wrong;
  }
  return "";
}

}  // namespace

std::string CheckStep(const proto::Step& step) {
  std::size_t inputs = 0, parameters = 0;
  for (const proto::Task& task : step.tasks()) {
    inputs += static_cast<std::size_t>(task.inputs_size());
    parameters += task.params().size();
  }
  if (step.tasks_size() > kMostTasks) return "a round of more than " + std::to_string(kMostTasks) + " tasks";
  if (inputs > kMostInputs)
    return "a round whose tasks have more than " + std::to_string(kMostInputs) + " inputs";
  if (parameters > kMostParameters)
    return "a round whose tasks have more than " + std::to_string(kMostParameters) + " parameters";
  if (step.state().scalars().size() > kMostFigures || step.state().blobs().size() > kMostFigures)
    return "a state of more than " + std::to_string(kMostFigures) + " figures or blobs";
  for (int i = 0; i < step.tasks_size(); ++i) {
    const std::string wrong = CheckTask(step.tasks(i), static_cast<std::uint32_t>(i));
    if (!wrong.empty()) return wrong;
  }
  for (const auto& [name, hash] : step.state().blobs())
    if (!IsHash(hash)) return "the state's blob '" + name + "' has no hash";
  if (!step.state().so_far().empty() && !IsHash(step.state().so_far()))
    return "what there is to see of the state has no hash";
  if (!IsAmount(step.advance_cost())) return "what its ADVANCE costs is no number";
  if (step.later_size() > kMostPhases) return "it expects too many phases";
  for (const proto::Phase& phase : step.later())
    if (!IsAmount(phase.rounds()) || !IsAmount(phase.cost()) || !IsAmount(phase.width()) ||
        !IsAmount(phase.least()) || !IsAmount(phase.most()))
      return "what it expects to follow is no number";
  if (!step.result().empty() && !IsHash(step.result())) return "the result has no hash";
  return "";
}

HashSet BlobsOfStep(const proto::Step& step) {
  HashSet hashes;
  const auto add = [&](const std::string& binary) { hashes.insert(Hash::FromBinary(binary).value()); };
  for (const auto& [name, hash] : step.state().blobs()) add(hash);
  for (const proto::Task& task : step.tasks())
    for (const proto::InputRef& input : task.inputs())
      if (!input.has_task()) add(input.blob());
  if (!step.state().so_far().empty()) add(step.state().so_far());
  if (!step.result().empty()) add(step.result());
  return hashes;
}

Hash HashOfMessage(const google::protobuf::Message& message) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream coded(&stream);
    coded.SetSerializationDeterministic(true);  // maps in the order of their keys
    message.SerializeToCodedStream(&coded);
  }
  Hasher hasher;
  hasher.Add(std::string_view(bytes));
  return hasher.Finish();
}

}  // namespace cairn::coordinator
