#include "worker/executor.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <chrono>
#include <new>
#include <stdexcept>
#include <utility>

#include "schema/blob_part.h"
#include "schema/demands_throw.h"
#include "schema/kinds/kind.h"
#include "schema/numerics.h"
#include "schema/text.h"

namespace cairn::worker {
namespace {

class TaskProgress : public Progress {
 public:
  explicit TaskProgress(AssignedTask& task) : task_(task) {}
  void Tick() override {
    task_.ticks.fetch_add(1, std::memory_order_relaxed);
    if (task_.cancelled.load(std::memory_order_relaxed)) throw Cancelled{};
  }

 private:
  AssignedTask& task_;
};

// Of START and ADVANCE: the state's blobs, and the stage's inputs, which come behind those of the same name
// and are fetched when they are asked for.
class PlanInputs : public Inputs {
 public:
  PlanInputs(TaskQueue& queue, AssignedTask& task) : queue_(queue), task_(task) {
    for (const auto& [name, hash] : task.assign.inputs()) {
      hashes_[name] = Hash::FromBinary(hash).value();
      if (!task.assign.state().blobs().contains(name)) unchecked_.insert(name);
    }
    for (const auto& [name, hash] : task.assign.state().blobs())
      hashes_[name] = Hash::FromBinary(hash).value();
  }
  bool Has(const std::string& name) const override { return hashes_.contains(name); }
  BlobPtr Get(const std::string& name) const override { return Await(name, {HashOf(name)}); }
  BlobPtr GetHead(const std::string& name, const std::string& but) const override {
    const Hash blob = HashOf(name);
    const proto::BlobPart part = HeadPart(but);
    return Await(name, {NameOfPart(blob, part), true, PartOf{blob, part}});
  }
  Hash HashOf(const std::string& name) const override {
    const auto it = hashes_.find(name);
    if (it == hashes_.end()) throw InputError("there is no input '" + name + "'");
    return it->second;
  }

 private:
  // Whatever it takes in memory came from elsewhere, and stays until the task ends.
  BlobPtr Await(const std::string& name, Want want) const {
    const TaskMemory::Pause pause;
    BlobPtr blob = queue_.AwaitInput(task_, std::move(want));
    if (unchecked_.erase(name) > 0) CheckInput(*blob, name);
    return blob;
  }

  TaskQueue& queue_;
  AssignedTask& task_;
  std::map<std::string, Hash> hashes_;
  // People give what a stage begins with, and a pipeline may rely on the form of what is there.
  mutable std::set<std::string> unchecked_;
};

// Of RUN: they were here before it began.
class RunInputs : public Inputs {
 public:
  explicit RunInputs(const AssignedTask& task) {
    for (const proto::InputRef& ref : task.assign.task().inputs()) {
      const Hash blob = Hash::FromBinary(ref.blob()).value();
      blobs_[ref.name()] =
          ref.has_part() ? task.blobs.at(NameOfPart(blob, ref.part())) : Rows(task.blobs.at(blob), ref);
    }
  }
  bool Has(const std::string& name) const override { return blobs_.contains(name); }
  BlobPtr Get(const std::string& name) const override {
    const auto it = blobs_.find(name);
    if (it == blobs_.end()) throw InputError("there is no input '" + name + "'");
    return it->second;
  }

 private:
  static BlobPtr Rows(const BlobPtr& blob, const proto::InputRef& ref) {
    if (ref.row_count() == 0) return blob;
    Blob rows;
    for (const auto& [name, array] : blob->fields()) {
      const std::int64_t have = array.shape().empty() ? 0 : array.shape()[0];
      if (ref.first_row() < 0 || ref.row_count() < 0 || ref.first_row() > have - ref.row_count()) {
        throw std::runtime_error("input '" + ref.name() + "': the plan asks for rows that '" + name +
                                 "' lacks");
      }
      rows.Put(name, array.Rows(ref.first_row(), ref.row_count()));
    }
    return std::make_shared<const Blob>(std::move(rows));
  }
  std::map<std::string, BlobPtr> blobs_;
};

class FetchedPartials : public Partials {
 public:
  FetchedPartials(TaskQueue& queue, AssignedTask& task) : queue_(queue), task_(task) {}
  std::size_t size() const override { return task_.partials.size(); }
  // Made elsewhere, and the task's to read: neither its coming nor its going counts as the task's memory.
  BlobPtr Get(std::size_t index) override {
    const TaskMemory::Pause pause;
    BlobPtr partial = queue_.AwaitPartial(task_, index);
    const Blob* const blob = partial.get();
    return {blob, [partial = std::move(partial)](const Blob*) mutable {
              const TaskMemory::Pause while_it_goes;
              partial.reset();
            }};
  }

 private:
  TaskQueue& queue_;
  AssignedTask& task_;
};

// The coordinator would take it for damage.
void RequireElements(const Blob& made) {
  for (const auto& [name, array] : made.fields())
    CAIRN_DEMAND(!array.is_form_alone(), "an answer has '" + name + "' without its elements");
}

wire::Message DoneWithStep(const wire::TaskKey& key, Step step) {
  wire::Message message;
  wire::Done& done = *message.envelope.mutable_done();
  *done.mutable_key() = key;
  *done.mutable_step() = std::move(step.plan);
  for (const BlobPtr& blob : step.blobs) RequireElements(*blob);
  for (BlobPtr& blob : step.blobs) message.blobs.push_back(wire::NameBlob(std::move(blob)));
  return message;
}

wire::Message DoneWithPartial(const wire::TaskKey& key, Blob partial) {
  RequireElements(partial);
  wire::Message message;
  message.blobs.push_back(wire::NameBlob(std::make_shared<const Blob>(std::move(partial))));
  wire::Done& done = *message.envelope.mutable_done();
  *done.mutable_key() = key;
  done.set_partial(message.blobs[0].hash.Binary());
  return message;
}

wire::Message Failure(const wire::Assign& assign, bool input_error, const std::string& why) {
  wire::Message message;
  wire::Failed& failed = *message.envelope.mutable_failed();
  *failed.mutable_key() = assign.key();
  failed.set_input_error(input_error);
  failed.set_message(Escaped(why));  // protobuf sends no other bytes; the coordinator says of which task
  return message;
}

// Equal for equal stages: protobuf's maps have no order of their own.
std::string Canonical(const proto::Stage& stage, std::uint64_t seed) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream coded(&stream);
    coded.SetSerializationDeterministic(true);
    coded.WriteVarint64(seed);
    stage.SerializeToCodedStream(&coded);
  }
  return bytes;
}

}  // namespace

const Pipeline& Executor::PipelineOf(const wire::Assign& assign) {
  std::string wanted = Canonical(assign.stage(), assign.seed());
  if (!pipeline_ || wanted != made_for_) {
    pipeline_ = factory_(assign.stage(), assign.seed());
    made_for_ = std::move(wanted);
  }
  return *pipeline_;
}

wire::Message Executor::Compute(AssignedTask& task) {
  const wire::Assign& assign = task.assign;
  const Pipeline& pipeline = PipelineOf(assign);
  switch (assign.key().kind()) {
    case wire::TaskKey::START:
      return DoneWithStep(assign.key(), pipeline.Start(PlanInputs(queue_, task)));
    case wire::TaskKey::ADVANCE: {
      FetchedPartials partials(queue_, task);
      return DoneWithStep(assign.key(), pipeline.Advance(assign.state(), partials, PlanInputs(queue_, task)));
    }
    default: {
      TaskProgress progress(task);
      return DoneWithPartial(assign.key(), pipeline.Run(assign.task(), RunInputs(task), progress));
    }
  }
}

wire::Message Executor::Answer(AssignedTask& task, TaskMemory& memory) {
  const auto begin = std::chrono::steady_clock::now();
  const TaskMemory::Hold hold(memory);
  wire::Message answer = Compute(task);
  answer.envelope.mutable_done()->set_seconds(
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  return answer;
}

wire::Message Executor::AnswerOrFailure(AssignedTask& task) {
  const std::string failure = queue_.FailureOf(task);
  if (!failure.empty()) return Failure(task.assign, false, failure);
  TaskMemory memory(task.assign.memory_mb(), memory_mb_);
  const DemandsThrow demands_throw;
  wire::Message answer;
  try {
    answer = Answer(task, memory);
  } catch (const Cancelled&) {
    // Dropped by the task queue where the task was cancelled; else the pipeline has thrown what it should
    // not.
    answer = Failure(task.assign, false, "it gave up though nobody had cancelled it");
  } catch (const InputError& error) {
    answer = Failure(task.assign, true, error.what());
  } catch (const std::bad_alloc&) {
    answer = Failure(task.assign, false, "out of memory");
  } catch (const std::exception& error) {
    answer = Failure(task.assign, false, error.what());
  } catch (...) {
    answer = Failure(task.assign, false, "an exception of an unknown type");
  }
  // Whatever it made of that: no bit of a result may depend on a limit.
  if (const std::string why = memory.WhyRefused(); !why.empty()) return Failure(task.assign, false, why);
  return answer;
}

void Executor::Loop() {
  FixNumericsOfThread();
  while (const TaskPtr task = queue_.Next()) queue_.Finish(*task, AnswerOrFailure(*task));
}

}  // namespace cairn::worker
