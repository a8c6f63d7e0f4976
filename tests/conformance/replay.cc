#include "tests/conformance/replay.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <gtest/gtest.h>

namespace cairn::conformance {
namespace {

std::string Canonical(const proto::Step& step) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream coded(&stream);
    coded.SetSerializationDeterministic(true);
    step.SerializeToCodedStream(&coded);
  }
  return bytes;
}

// A round's tasks in the order that `policy` picks. Each is computed by a pipeline made anew.
std::vector<BlobPtr> RunRound(const Case& c, const Moment& moment, const Policy& policy) {
  NoProgress progress;
  std::vector<BlobPtr> partials(static_cast<std::size_t>(moment.plan.tasks_size()));
  const auto ready = [&](const Task& task) {
    for (const proto::InputRef& ref : task.inputs()) {
      if (ref.has_task() && partials.at(ref.task()) == nullptr) return false;
    }
    return partials.at(task.index()) == nullptr;
  };
  for (std::size_t done = 0; done < partials.size(); ++done) {
    std::vector<const Task*> choice;
    for (const Task& task : moment.plan.tasks()) {
      if (ready(task)) choice.push_back(&task);
    }
    const Task& task = *choice.at(policy.pick ? policy.pick(choice.size()) : 0);
    for (int i = 0; i < policy.times; ++i) {
      MapInputs inputs;
      for (const proto::InputRef& ref : task.inputs()) {
        inputs.Put(ref.name(), CopyElsewhere(InputOf(ref, moment.store, partials)));
      }
      const auto pipeline = Make(c.stage, c.seed);
      const auto partial = std::make_shared<const Blob>(pipeline->Run(task, inputs, progress));
      if (i == 0) partials.at(task.index()) = partial;
      EXPECT_EQ(partial->ContentHash(), partials.at(task.index())->ContentHash())
          << "task " << task.kind() << " " << task.index() << " gives other bytes the second time";
    }
  }
  return partials;
}

// Everything as if it had been written out and read back.
Moment MomentOf(const Step& step, BlobsByHash store) {
  Moment moment;
  EXPECT_TRUE(moment.plan.ParseFromString(step.plan.SerializeAsString()));
  moment.store = std::move(store);
  for (const BlobPtr& blob : step.blobs) moment.store[blob->ContentHash().Binary()] = CopyElsewhere(blob);
  return moment;
}

Trace Continue(const Case& c, const InputMap& inputs, Moment moment, const Policy& policy) {
  Trace trace;
  while (true) {
    trace.plans.push_back(Canonical(moment.plan));
    trace.moments.push_back(moment);
    if (!moment.plan.result().empty()) {
      trace.result = moment.store.at(moment.plan.result());
      return trace;
    }
    const std::vector<BlobPtr> done = RunRound(c, moment, policy);
    std::vector<Hash>& hashes = trace.partials.emplace_back();
    for (const BlobPtr& partial : done) hashes.push_back(partial->ContentHash());
    VectorPartials partials(done);
    const MapInputs round_inputs = InputsOfRound(moment.plan.state(), moment.store, inputs);
    const auto pipeline = Make(c.stage, c.seed);
    moment = MomentOf(pipeline->Advance(moment.plan.state(), partials, round_inputs), moment.store);
  }
}

}  // namespace

Trace Replay(const Case& c, const InputMap& inputs, const Policy& policy) {
  BlobsByHash store;
  for (const auto& [name, blob] : inputs) store[blob->ContentHash().Binary()] = blob;
  return Continue(c, inputs, MomentOf(Make(c.stage, c.seed)->Start(MapInputs(inputs)), std::move(store)),
                  policy);
}

Trace ReplayFrom(const Case& c, const InputMap& inputs, const Moment& moment, const Policy& policy) {
  return Continue(c, inputs, moment, policy);
}

BlobPtr CopyElsewhere(const BlobPtr& blob) {
  Blob copy;
  for (const auto& [name, array] : blob->fields()) {
    copy.Put(name, Array::FromBytes(array.type(), array.item_bytes(), array.shape(), array.bytes()).value());
  }
  return std::make_shared<const Blob>(std::move(copy));
}

InputMap CopyElsewhere(const InputMap& inputs) {
  InputMap copies;
  for (const auto& [name, blob] : inputs) copies[name] = CopyElsewhere(blob);
  return copies;
}

}  // namespace cairn::conformance
